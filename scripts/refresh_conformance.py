#!/usr/bin/env python3
"""Copy the conformance corpora into tests/data.

    scripts/refresh_conformance.py FOLDER

FOLDER holds `rs274/` and `fanuc/`, as the corpora are handed out: `valid/`,
`invalid/`, `tools.tbl`, and for RS274 `subs/`, `compare.py` and `oracle.py`. What is here
already is replaced.
"""

import shutil
import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "conformance"
PARTS = {
    "rs274": ("valid", "invalid", "subs", "tools.tbl", "compare.py", "oracle.py"),
    "fanuc": ("valid", "invalid", "tools.tbl"),
}


def main() -> int:
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for origin, target in [(Path(sys.argv[1], d, p), TARGET / d / p) for d, parts in PARTS.items() for p in parts]:
        if origin.is_dir():
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(origin, target)
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(origin, target)
    print(f"{len(list(TARGET.glob('*/*/*.ngc')))} programs in {TARGET}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
