#!/usr/bin/env python3
"""Copy programs of slicers with what they say about them into tests/data.

    scripts/refresh_printing.py FOLDER

FOLDER holds NAME.gcode and NAME.json, as the programs are handed out. What is here already is replaced.
"""

import shutil
import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "printing"
NAMES = ("puck_arcs", "two_tools")  # small ones, with arcs and with two nozzles


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    TARGET.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        for suffix in (".gcode", ".json"):
            shutil.copyfile(Path(sys.argv[1], name + suffix), TARGET / (name + suffix))
    print(f"{len(NAMES)} programs in {TARGET}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
