#!/usr/bin/env python3
"""Copy the cases of several programs at once, and the program that compares with them, into tests/data.

    scripts/refresh_channels.py FOLDER

FOLDER holds `cases.json` and `compare.py`, as the cases are handed out. What is here already is replaced.
"""

import json
import shutil
import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "channels"


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    TARGET.mkdir(parents=True, exist_ok=True)
    for name in ("cases.json", "compare.py"):
        shutil.copyfile(Path(sys.argv[1], name), TARGET / name)
    print(f"{len(json.loads((TARGET / 'cases.json').read_text())['cases'])} cases in {TARGET}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
