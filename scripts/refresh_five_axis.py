#!/usr/bin/env python3
"""Copy the joints of the five-axis corpus into tests/data.

    scripts/refresh_five_axis.py FOLDER

FOLDER holds `NAME.csv`: tip and tool axis of each block in the part, and the joints of three machines by the
formulas of LinuxCNC's kinematics (trtfuncs.c, maxkins.c, 5axiskins.c). Of long files every seventh row is kept.
`NAME.g68.nc` is a program with tilted planes; it is copied as it is.
"""

import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "five_axis"
MANY, KEEP = 500, 7


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    TARGET.mkdir(parents=True, exist_ok=True)
    for origin in sorted(Path(sys.argv[1]).glob("*.csv")):
        head, *rows = origin.read_text().splitlines()
        chosen = rows[:: KEEP if len(rows) > MANY else 1]
        (TARGET / origin.name).write_text("\n".join([head, *chosen]) + "\n")
    for origin in sorted(Path(sys.argv[1]).glob("*.g68.nc")):
        (TARGET / origin.name).write_text(origin.read_text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
