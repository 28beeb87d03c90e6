#!/usr/bin/env python3
"""Copy the conformance corpus into tests/data.

    scripts/refresh_conformance.py FOLDER

FOLDER holds `valid/`, `invalid/`, `subs/`, `tools.tbl` and `compare.py`, as
the corpus is handed out. What is here already is replaced.
"""

import shutil
import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "conformance" / "rs274"
PARTS = ("valid", "invalid", "subs", "tools.tbl", "compare.py")


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    source = Path(sys.argv[1])
    for part in PARTS:
        origin, target = source / part, TARGET / part
        if origin.is_dir():
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(origin, target)
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(origin, target)
    print(f"{len(list(TARGET.glob('*/*.ngc')))} programs in {TARGET}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
