"""Make the pictures of the README anew: `python scripts/make_pictures.py [NAME …] [--viewer]`.

Each picture carries the hash of the part that its run leaves (PNG text `Part`), so a test tells when one is stale.
`report.png` needs chromium (`make browser`), `replay.png` the viewer of `view_log.py`; it is made with `--viewer` only.
"""

from __future__ import annotations

import argparse
import hashlib
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path
from typing import NamedTuple

TOP = Path(__file__).resolve().parent.parent
STAMP = b"Part"
_HEAD = 8  # bytes of a PNG before its first chunk


class Picture(NamedTuple):
    """A picture of `docs`: the run that it shows, and the script that draws it from the folder of that run."""

    program: str
    cell: str
    world: str
    script: tuple[str, ...]


PICTURES = {
    "bracket.png": Picture("bracket.nc", "bracket.yaml", "bullet", ("picture.py", "{out}/stock.stl", "{png}")),
    "report.png": Picture(
        "bracket.nc",
        "bracket_kr10.yaml",
        "kinematic",
        ("page_picture.py", "{out}/report.html", "{png}", "--time", "175"),
    ),
    "replay.png": Picture(
        "bracket.nc", "bracket.yaml", "bullet", ("view_log.py", "{out}/run.mcap", "--picture", "{png}", "--at", "0.6")
    ),
}


def run(picture: Picture, out: Path) -> str:
    """Run the program of a picture into `out`; the hash of the part that it leaves."""
    gcodesim = (sys.executable, "-m", "gcodesim")
    program, cell = TOP / "programs" / picture.program, TOP / "cells" / picture.cell
    order = ("run", program, "--cell", cell, "--world", picture.world, "--out", out)
    subprocess.run([*gcodesim, *map(str, order)], check=True, cwd=TOP, capture_output=True)
    return hashlib.sha256((out / "stock.stl").read_bytes()).hexdigest()


def draw(picture: Picture, out: Path, png: Path) -> None:
    """Draw a picture from the folder of its run."""
    script, *words = (word.format(out=out, png=png) for word in picture.script)
    if "page_picture" in script:
        report = (sys.executable, "-m", "gcodesim", "report", str(out), "-o", str(out / "report.html"))
        subprocess.run(report, check=True, cwd=TOP, capture_output=True)
    subprocess.run([sys.executable, str(TOP / "scripts" / script), *words], check=True, cwd=TOP)


def stamped(png: bytes, part: str) -> bytes:
    """The picture with the hash of its part as text."""
    text = STAMP + b"\0" + part.encode()
    chunk = struct.pack(">I", len(text)) + b"tEXt" + text + struct.pack(">I", zlib.crc32(b"tEXt" + text))
    end = _HEAD + 8 + struct.unpack_from(">I", png, _HEAD)[0] + 4  # behind the first chunk, which says the size
    return png[:end] + chunk + png[end:]


def part_of(png: bytes) -> str | None:
    """The hash that a picture carries."""
    at = _HEAD
    while at < len(png):
        (size,) = struct.unpack_from(">I", png, at)
        kind, data = png[at + 4 : at + 8], png[at + 8 : at + 8 + size]
        if kind == b"tEXt" and data.startswith(STAMP + b"\0"):
            return data[len(STAMP) + 1 :].decode()
        at += size + 12
    return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(PICTURES)} (default: all)")
    parser.add_argument("--viewer", action="store_true", help="also the picture that needs the viewer")
    parser.add_argument("--into", type=Path, default=TOP / "docs", metavar="DIR", help="where to (default: docs)")
    arguments = parser.parse_args()
    for name in arguments.names or PICTURES:
        if "view_log.py" in PICTURES[name].script and not arguments.viewer:
            continue
        with tempfile.TemporaryDirectory() as folder:
            out, png = Path(folder) / "out", Path(folder) / name
            part = run(PICTURES[name], out)
            draw(PICTURES[name], out, png)
            (arguments.into / name).write_bytes(stamped(png.read_bytes(), part))
        print(arguments.into / name)


if __name__ == "__main__":
    main()
