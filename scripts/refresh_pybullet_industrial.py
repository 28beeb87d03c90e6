#!/usr/bin/env python3
"""Write down the public names of an installed `pybullet_industrial`, and the paths that it makes.

    scripts/refresh_pybullet_industrial.py [FOLDER]

FOLDER is where it was installed to, if not in this environment. Writes `tests/data/pybullet_industrial/original.json`:
each name with its arguments, and paths of seeded arguments, which are facts about the original.
"""

import importlib
import inspect
import json
import sys
from pathlib import Path

TARGET = Path(__file__).parent.parent / "tests" / "data" / "pybullet_industrial" / "original.json"
sys.path.insert(0, str(TARGET.parents[3]))
CONSTANTS = ("JOINT_KEY", "BASE_LINK", "MAX_DISTANCE_INTERNAL")


def names_of(package) -> dict[str, list[str]]:
    """Public names with the names of their arguments; methods as `Class.method`, a class with those of `__init__`."""
    found = {name: [] for name in CONSTANTS if hasattr(package, name)}
    home = package.__name__
    modules = [module for key, module in sorted(sys.modules.items()) if key.startswith(home + ".")]
    for module in modules:
        for name, thing in vars(module).items():
            if name.startswith("_") or getattr(thing, "__module__", "") != module.__name__:
                continue
            if inspect.isfunction(thing):
                found[name] = list(inspect.signature(thing).parameters)
            elif inspect.isclass(thing):
                found[name] = list(inspect.signature(thing.__init__).parameters)
                for method, own in vars(thing).items():
                    own = own.__func__ if isinstance(own, staticmethod) else own
                    if not method.startswith("_") and inspect.isfunction(own):
                        found[f"{name}.{method}"] = list(inspect.signature(own).parameters)
    return dict(sorted(found.items()))


def main() -> int:
    if len(sys.argv) > 1:
        sys.path.insert(0, sys.argv[1])
    from tests.unit.pybullet_industrial.paths import CASES, as_lists
    from tests.unit.pybullet_industrial.scenes import SCENES

    package = importlib.import_module("pybullet_industrial")
    paths = {name: as_lists(make(package)) for name, make in CASES.items()}
    scenes = {name: [float(value) for value in run(package)] for name, run in SCENES.items()}
    record = {"names": names_of(package), "paths": paths, "scenes": scenes}
    TARGET.write_text(json.dumps(record, indent=None) + "\n", encoding="utf-8")
    print(f"{len(names_of(package))} names, {len(paths)} paths in {TARGET}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
