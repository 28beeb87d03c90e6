"""Realistic programs in the styles of several posts: no finding above a note. A false alarm is worse than a miss."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell import LoadedCell, load_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.simulation import Options, prepare, run

DATA = Path(__file__).parents[1] / "data" / "programs"
PROGRAMS = sorted(path for path in (DATA / "clean").iterdir() if path.suffix in (".nc", ".ngc"))
OWN_CELLS = {"four_axis_indexing": "cell_with_a.yaml"}


@pytest.fixture(scope="module")
def cells() -> dict[str, LoadedCell]:
    return {name: load_cell(DATA / name) for name in ("cell.yaml", *OWN_CELLS.values())}


def test_there_are_many() -> None:
    assert len(PROGRAMS) >= 15


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_a_run_finds_nothing(path: Path, cells: dict[str, LoadedCell]) -> None:
    job = prepare(SourceText.read(path), cells[OWN_CELLS.get(path.stem, "cell.yaml")], Options(world="kinematic"))
    results, execution = run(job)

    above = [f for f in results.findings if f.level > Severity.NOTE]
    assert not above, "\n".join(as_text(f, job.sources) for f in above)
    assert results.status == "ok" and execution is not None
    assert results.times.feed > 0.0
    if results.stocks:
        assert results.stocks["stock"].removed > 0.0


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_lint_alone_finds_nothing(path: Path) -> None:
    source = SourceText.read(path)
    reading = interpret(source, Settings(tool_table=assumed_tools(source)))
    assert len(list(reading)) > 10

    above = [f for f in reading.findings if f.level > Severity.NOTE]
    assert not above, "\n".join(as_text(f, reading.sources) for f in above)
