"""Realistic programs in the styles of several posts: no finding above a note. A false alarm is worse than a miss."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from gcodesim.cell import LoadedCell, load_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.diagnostics.show import as_text
from gcodesim.rs274 import Settings, interpret
from gcodesim.rs274.assumed import assumed_tools
from gcodesim.rs274.dialects import DIALECTS
from gcodesim.simulation import Options, prepare, run

DATA = Path(__file__).parents[1] / "data" / "programs"
PROGRAMS = sorted(path for path in (DATA / "clean").iterdir() if path.suffix in (".nc", ".ngc"))
POSTS = sorted((DATA / "posts").glob("*.nc"))  # `<dialect>_<style>.nc`
OWN_CELLS = {"four_axis_indexing": "cell_with_a.yaml"}


@pytest.fixture(scope="module")
def cells() -> dict[str, LoadedCell]:
    return {name: load_cell(DATA / name) for name in ("cell.yaml", *OWN_CELLS.values())}


def test_there_are_many() -> None:
    assert len(PROGRAMS) >= 15
    assert len(POSTS) >= 35
    assert {dialect_of(path) for path in POSTS} == set(DIALECTS)


def dialect_of(path: Path) -> str:
    return max((name for name in DIALECTS if path.stem.startswith(f"{name}_")), key=len)


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


@pytest.mark.parametrize("path", POSTS, ids=lambda path: path.stem)
def test_programs_of_posts_are_clean(path: Path) -> None:
    """Headers, tool changes, homing, restart points and endings as CAM systems write them for each control."""
    source = SourceText.read(path)
    reading = interpret(source, Settings(dialect=dialect_of(path), tool_table=assumed_tools(source)))
    assert len(list(reading)) > 10

    above = [f for f in reading.findings if f.level > Severity.NOTE and f.code != "GS916"]
    assert ("GS916" in {f.code for f in reading.findings}) == ("lathe" in path.stem.removeprefix("fanuc_lathe"))
    assert not above, "\n".join(as_text(f, reading.sources) for f in above)


@pytest.mark.parametrize("path", POSTS, ids=lambda path: path.stem)
def test_no_tool_is_without_its_length(path: Path) -> None:
    """The same with tools of different lengths: the warnings about lengths have something to compare."""
    source = SourceText.read(path)
    tools = assumed_tools(source)
    lengths = {
        number: replace(entry, offset=(0.0, 0.0, 0.05 + 0.01 * number, *entry.offset[3:]))
        for number, entry in tools.entries.items()
    }
    reading = interpret(source, Settings(dialect=dialect_of(path), tool_table=replace(tools, entries=lengths)))
    assert len(list(reading)) > 10

    assert [f.code for f in reading.findings if f.level > Severity.NOTE and f.code != "GS916"] == []
