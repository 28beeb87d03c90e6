"""One word has one meaning: what a class is called in one package is no other class elsewhere."""

import ast
from collections import defaultdict
from pathlib import Path

import gcodesim

TOP = Path(gcodesim.__file__).parent
FOREIGN = "pybullet_industrial"
"""This package has the names of another project, for its scripts."""


def test_no_two_public_classes_share_a_name() -> None:
    homes = defaultdict(list)
    for path in sorted(path for path in TOP.rglob("*.py") if FOREIGN not in path.parts):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(path.relative_to(TOP).as_posix())

    assert len(homes) > 300
    assert {name: places for name, places in homes.items() if len(places) > 1} == {}
