#!/usr/bin/env python3
"""Copy the cases of moving bodies into tests/data.

    scripts/refresh_collisions.py FOLDER

FOLDER holds `cases.json`, as the cases are handed out. What is here already is replaced.
"""

import json
import shutil
import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "collisions" / "cases.json"


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    TARGET.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(Path(sys.argv[1], "cases.json"), TARGET)
    print(f"{len(json.loads(TARGET.read_text())['cases'])} cases in {TARGET}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
