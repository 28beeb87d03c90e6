"""Take a picture of a report: `python scripts/page_picture.py report.html docs/report.png --time 120`.

Needs chromium, which `make browser` installs.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import chromium


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("page", type=Path, metavar="HTML", help="what `gcodesim report` wrote")
    parser.add_argument("picture", type=Path, metavar="PNG", help="the file to write")
    parser.add_argument("--time", type=float, default=0.0, metavar="S", help="the moment to show")
    parser.add_argument("--view", default="start", help="part, cell, top, front or side")
    parser.add_argument("--size", default="1280,860", metavar="W,H", help="of the window, in pixels")
    arguments = parser.parse_args()
    if chromium.PROGRAM is None:
        print("chromium is not installed: `make browser`", file=sys.stderr)
        return 2
    address = f"{arguments.page.resolve().as_uri()}#t={arguments.time:g}&view={arguments.view}"
    with tempfile.TemporaryDirectory() as profile:
        own = (f"--user-data-dir={profile}", f"--window-size={arguments.size}", f"--screenshot={arguments.picture}")
        subprocess.run([chromium.PROGRAM, *chromium.ALONE, *own, address], check=True, capture_output=True, timeout=240)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
