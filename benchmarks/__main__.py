"""`python -m benchmarks`: everything, one after the other; or those that are named."""

from __future__ import annotations

import importlib
import sys

NAMES = (
    "start",
    "reading",
    "interpreter",
    "editor",
    "inverse_kinematics",
    "time_law",
    "planning",
    "removal",
    "surface",
    "fine",
    "collisions",
    "channels",
    "camotics",
    "log",
    "printing",
    "coating",
    "reference",
    "suite",
    "scale",
    "neighbour",
)


def main() -> int:
    chosen = sys.argv[1:] or list(NAMES)
    unknown = [name for name in chosen if name not in NAMES]
    if unknown:
        print(f"no benchmark called {', '.join(unknown)}; there are {', '.join(NAMES)}", file=sys.stderr)
        return 2
    sys.argv[1:] = []
    for name in chosen:
        print(f"\n{name}", flush=True)
        importlib.import_module(f"benchmarks.{name}").main()
    return 0


if __name__ == "__main__":
    sys.exit(main())
