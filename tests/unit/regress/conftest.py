"""Programs as steps, and a folder of test cases whose results are accepted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.regress.accept import propose, take
from gcodesim.regress.case import collect
from gcodesim.regress.motion import MotionStep, steps_of
from gcodesim.regress.outcome import Judging
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools

DATA = Path(__file__).parents[2] / "data" / "regress"
NAMES = ("pocket", "slot_arm")
MORE_NAMES = ("holes", *NAMES)


@pytest.fixture
def steps() -> Callable[[str], list[MotionStep]]:
    """The steps of a program, read without a cell."""

    def steps(text: str) -> list[MotionStep]:
        source = SourceText("part.nc", text.encode())
        return steps_of(interpret(source, Settings(tool_table=assumed_tools(source))))

    return steps


@pytest.fixture(scope="session")
def accepted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three clean programs with test files and accepted results; copy it before changing anything."""
    folder = tmp_path_factory.mktemp("accepted")
    for name in MORE_NAMES:
        for suffix in (".nc", ".yaml"):
            (folder / f"{name}{suffix}").write_bytes((DATA / f"{name}{suffix}").read_bytes())
        (folder / f"{name}.test.yaml").write_text(f"cell: {name}.yaml\n")
    for case in collect([folder], folder).cases:
        take(propose(case, Judging(root=folder)))
    return folder


@pytest.fixture
def suite(accepted: Path, tmp_path: Path) -> Path:
    """Two cases of `accepted`, a copy of one's own."""
    return copied(accepted, tmp_path, NAMES)


@pytest.fixture
def larger_suite(accepted: Path, tmp_path: Path) -> Path:
    """All of `accepted`, a copy of one's own."""
    return copied(accepted, tmp_path, MORE_NAMES)


def copied(source: Path, to: Path, names: tuple[str, ...]) -> Path:
    for path in sorted(source.iterdir()):
        if path.name.partition(".")[0] in names:
            (to / path.name).write_bytes(path.read_bytes())
    return to
