"""What kind of machine moves is asked where it is described, in the kinematics and in planning, and nowhere else."""

from __future__ import annotations

import re
from pathlib import Path

import gcodesim

ROOT = Path(gcodesim.__file__).parent
MAY_ASK = "shop"  # where a cell becomes a scene
QUESTION = re.compile(
    r"isinstance\([^)]*\b(Cartesian|MachineTool|SerialArm|SphericalWrist|ParallelAxes|Robot)\b|\bis_(arm|machine|robot)\b"
)


def test_nobody_asks_what_kind_of_machine_it_is() -> None:
    asked = []
    for file in sorted(ROOT.rglob("*.py")):
        place = file.relative_to(ROOT)
        if place.parts[0] in ("kinematics", "planning", MAY_ASK):
            continue
        lines = file.read_text().splitlines()
        asked += [f"{place}:{i}: {line.strip()}" for i, line in enumerate(lines, start=1) if QUESTION.search(line)]

    assert asked == []
