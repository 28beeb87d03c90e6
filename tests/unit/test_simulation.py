"""What `prepare` and `check` say before anything moves."""

from __future__ import annotations

from pathlib import Path

import pytest

import gcodesim
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import check, layout_findings, prepare, run
from tests.log_columns import read_columns

PROGRAM = "G21 G90\nT1 M6\nS9000 M3\nG0 X0 Y5 Z5\nG1 Z-1 F200\nG1 X60 F600\nG0 Z5\nM5\nM2\n"
CELL = """
gcodesim: 1
machine: gantry_xyz
stock: {box: [60, 30, 10], zero: top-front-left, resolution: 1}
tools: {1: {type: flat_end_mill, diameter: 3}}
"""


def test_what_needs_no_material_is_found_by_check_too() -> None:
    program = PROGRAM.replace("S9000", "S30000").replace("M5\n", "M8\n")
    cell = CELL + "limits: {spindle_speed: 24000 rpm}\n"
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    results = check(prepare(SourceText("program.nc", program.encode()), loaded))
    found = {finding.code: (finding.span.line, finding.value) for finding in results.findings}
    assert found["GS513"][0] == 4 and found["GS513"][1] == pytest.approx(30000)
    assert found["GS503"][0] == 9 and found["GS505"][0] == 9


def test_a_tilted_system_on_a_lathe_stops_before_the_program() -> None:
    lathe = "gcodesim: 1\nmachine: lathe_xz\ntools: {1: {type: drill, diameter: 3}}\n"
    cell = lathe + "work_offsets: {G54: {rpy: [90, 0, 0]}}\n"
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    assert loaded.cell is not None
    assert [finding.code for finding in layout_findings(loaded.cell)] == ["GS726"]
    results, execution = run(prepare(SourceText("program.nc", PROGRAM.encode()), loaded))
    assert execution is None and results.status == "failed"
    assert [finding.code for finding in results.findings] == ["GS726"]


BY_HAND = "G21 G90\nS9000 M3\nG0 X0 Y5 Z5\nG1 Z-1 F200\nG1 X60 F600\nG0 Z5\nM5\nM2\n"


def findings_of(program: str, cell: str) -> list[tuple[str, int]]:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    results = check(prepare(SourceText("program.nc", program.encode()), loaded))
    return [(finding.code, finding.span.line) for finding in results.findings]


def test_a_program_that_feeds_with_an_empty_spindle_is_told() -> None:
    assert ("GS506", 4) in findings_of(BY_HAND, CELL)
    assert "GS506" not in {code for code, _ in findings_of(BY_HAND, CELL + "loaded_tool: 1\n")}
    assert "GS506" not in {code for code, _ in findings_of(PROGRAM, CELL)}
    without_stock = CELL.replace("stock: {box: [60, 30, 10], zero: top-front-left, resolution: 1}\n", "")
    assert "GS506" not in {code for code, _ in findings_of(BY_HAND, without_stock)}


def test_a_loaded_tool_cuts() -> None:
    loaded = read_cell(SourceText("cell.yaml", (CELL + "loaded_tool: 1\n").encode()), Path("cell.yaml"))
    results, _ = run(prepare(SourceText("program.nc", BY_HAND.encode()), loaded))
    # a slot 1 mm deep along the whole stock, with the half disc where the tool went in
    assert results.stocks["stock"].removed == pytest.approx(1e-3 * 3e-3 * 60e-3, rel=0.05)


def test_a_loaded_tool_that_is_nowhere_is_a_fault_of_the_cell() -> None:
    loaded = read_cell(SourceText("cell.yaml", (CELL + "loaded_tool: 4\n").encode()), Path("cell.yaml"))
    found = [finding for finding in loaded.findings if finding.code == "GS712"]
    assert len(found) == 1 and "T4" in found[0].message and "T1" in found[0].hint and found[0].span.line == 6


ADDITIONAL = """O1
G21 G90 G54.1 P2
T1 M6
G43 H1 G0 X0. Y5. Z5. S9000 M3
G1 Z-1. F200.
X60. F600.
G54 P300
G0 Z5.
M5
M30
"""


def test_a_program_runs_in_an_additional_system_of_fanuc(tmp_path: Path) -> None:
    cell = CELL.replace("zero: top-front-left", "zero: top-front-left, in: G54.1 P2")
    cell += "simulation: {world: kinematic}\n"
    cell += "dialect: fanuc\nwork_offsets: {G54.1 P2: {xyz: [300, 200, -200]}, G54.1 P300: {xyz: [300, 200, -199]}}\n"
    (tmp_path / "cell.yaml").write_text(cell)
    (tmp_path / "part.nc").write_text(ADDITIONAL)
    results = gcodesim.simulate(tmp_path / "part.nc", tmp_path / "cell.yaml", tmp_path / "out")

    assert results.status == "ok"
    blocks = read_columns(tmp_path / "out" / "run.mcap", "/program", ["wcs"])
    assert set(blocks["wcs"].tolist()) == {"G54.1 P2", "G54.1 P300"}


def test_travel_is_told_in_the_name_of_an_additional_system() -> None:
    program = ADDITIONAL.replace("X60.", "X960.")
    cell = CELL + "dialect: fanuc\nwork_offsets: {G54.1 P2: {xyz: [300, 200, -200]}}\n"
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    results = check(prepare(SourceText("program.nc", program.encode()), loaded))

    hints = [finding.hint for finding in results.findings if finding.code == "GS201"]
    assert any(hint.startswith("G54.1 P2 shifted by") for hint in hints)


def test_a_turned_system_is_refused_for_fanuc_which_would_leave_the_turn_out() -> None:
    cell = CELL + "dialect: fanuc\nwork_offsets: {G54: {xyz: [300, 200, -200], rpy: [0, 0, 30]}}\n"
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    results = check(prepare(SourceText("program.nc", ADDITIONAL.replace("G54.1 P2", "G54").encode()), loaded))

    assert "GS726" in {finding.code for finding in results.findings}
