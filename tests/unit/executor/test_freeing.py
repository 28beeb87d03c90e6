"""What a cut frees falls with the very line that frees it: later cuts there find nothing."""

from __future__ import annotations

import pytest

from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
machine: gantry_xyz
stock: {{box: [60, 40, 6], zero: top-front-left, material: al6082_t6, resolution: 0.5}}
tools: {{1: {tool}}}
{more}
"""
MILL = "{type: flat_end_mill, diameter: 3, length: 40}"
JET = "{type: jet, diameter: 1, removal_rate: 100 mm^3/s, length: 100}"
ROUND = """G21 G90 G61
T1 M6
G43 H1
{on}
G0 X20 Y10 Z{z}
G1 X40 F600
Y30
X20
Y{end}
Y10
G0 Z20
X30 Y20
G1 Z-3 F200
X33
G0 Z20
{off}
M2
"""


def ran(tool: str, *, end: float, z: float = -6.5, on: str = "S8000 M3", off: str = "M5", more: str = "") -> Ran:
    return run_texts(ROUND.format(on=on, off=off, z=z, end=end), CELL.format(tool=tool, more=more))


def taken_in(run: Ran, line: int) -> float:
    """Volume [mm³] that a line took."""
    path = run.job.plan.path  # type: ignore[union-attr]
    rows = [row for row in range(len(path)) if path.span(row).line == line]
    return float(run.execution.rows["removed"][rows].sum()) * 1e9


@pytest.mark.parametrize("more", ["", "simulation: {rate: 100 Hz}", "simulation: {world: bullet}"])
def test_a_later_cut_finds_nothing_where_a_piece_has_fallen(more: str) -> None:
    """The square falls in line 9, 2 mm before its end; lines 13 and 14 cut air."""
    run = ran(MILL, end=11, more=more)
    (told,) = (finding for finding in run.results.findings if finding.code == "GS440")
    (fallen,) = run.stock.as_json()["fallen"]

    assert told.span.line == fallen["line"] == 9
    assert fallen["volume_mm3"] == pytest.approx(17 * 17 * 6, rel=0.03)
    assert taken_in(run, 13) == taken_in(run, 14) == 0.0
    assert run.stock.remaining == pytest.approx(run.stock.initial - run.stock.removed, rel=1e-9)


def test_a_tab_holds_until_it_is_cut() -> None:
    """Line 9 leaves 2 mm, which line 10 cuts."""
    run = ran(MILL, end=15)

    assert [finding.span.line for finding in run.results.findings if finding.code == "GS440"] == [10]


def test_a_skin_holds() -> None:
    """0.1 mm below the square: nothing falls, and what is cut there later is cut."""
    run = ran(MILL, end=10, z=-5.9)

    assert "fallen" not in run.stock.as_json()
    assert taken_in(run, 13) > 10.0


def test_a_jet_cuts_free_as_it_is_meant_to() -> None:
    """That is a note."""
    switch = "m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}"
    run = ran(JET, end=11, z=0, on="M10", off="M11", more=switch)
    told = [finding for finding in run.results.findings if finding.code == "GS440"]

    assert [(finding.span.line, finding.severity.name) for finding in told] == [(10, "NOTE")]
    assert taken_in(run, 13) == 0.0
