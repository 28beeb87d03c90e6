"""Words that switch a tool on while the spindle has another one, or none."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.simulation import check, prepare

CELL = """gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {xyz: [400, 300, -300]}}
m_codes: {M10: {tool: activate}, M11: {tool: deactivate}, M62 P1: {gripper: close}, M63 P1: {gripper: open}}
tools:
  1: {type: extruder, bead_width: 6, bead_height: 3, length: 100}
  2: {type: finger_gripper, stroke: 60, force: 40 N, length: 120}
parts: {box: {box: [40, 40, 40], zero: bottom-center, in: G54, xyz: [0, 0, -40], mass: 1 kg}}
"""


def told(program: str, cell: str = CELL) -> list[tuple[str, int, int]]:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    results = check(prepare(SourceText("p.nc", program.encode()), loaded, Options(world="kinematic")))
    return [(f.code, f.span.line, f.count) for f in results.findings if f.code in ("GS507", "GS561")]


@pytest.mark.parametrize(
    ("program", "found"),
    [
        ("G21 G90\nM10\nG1 X10 F6000\nM11\nM2\n", [("GS507", 2, 1)]),
        ("G21 G90\nT1 M6 G43\nM10\nG1 X10 F6000\nM11\nM2\n", []),
        ("G21 G90\nT2 M6 G43\nM10\nM11\nM10\nM11\nG0 X10\nM2\n", [("GS507", 3, 2)]),
        ("G21 G90\nM11\nM63 P1\nG0 X10\nM2\n", []),
    ],
)
def test_what_switches_nothing_on_is_told_once_for_each_tool(program: str, found: list[tuple[str, int, int]]) -> None:
    assert told(program) == found


def test_a_tool_that_is_loaded_at_the_start_hears() -> None:
    cell = CELL.replace("tools:", "loaded_tool: 1\ntools:")

    assert told("G21 G90\nG43 H1\nM10\nG1 X10 F6000\nM11\nM2\n", cell) == []


def test_any_tool_hears_the_signal_of_its_load() -> None:
    signals = "signals: {load: {word: M67 E0, per: 1 %}}\n"
    loaded = CELL.replace("length: 120", "length: 120, load: {force: [0, 0, 20 N]}") + signals
    program = "G21 G90\nT2 M6 G43\nM67 E0 Q50\nG1 X10 F6000\nM2\n"

    assert told(program, loaded) == []
    assert told(program.replace("T2", "T1"), loaded) == [("GS507", 3, 1)]


def test_a_grip_is_blamed_on_its_own_word() -> None:
    """M11 stands behind M62, before the move with which the gripper closes."""
    assert told("G21 G90\nT2 M6 G43\nG0 X200\nM62 P1\nM11\nG0 Z50\nM2\n") == [("GS561", 4, 1)]


BY_OUTPUT = """gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {xyz: [400, 300, -300]}}
signals: {beam: {word: M62 P0}, power: {word: M67 E0, per: 1 W}}
stock: {box: [60, 40, 5], in: G54, material: al6082_t6, resolution: 1}
tools:
  1: {type: laser, power: 100 W, diameter: 2, specific_energy: 2 J/mm^3, length: 60}
  2: {type: flat_end_mill, diameter: 8, flutes: 2, length: 60}
"""


@pytest.mark.parametrize(
    ("program", "found"),
    [
        ("G21 G90\nM62 P0\nT1 M6 G43\nG0 X1 Y1 Z0\nM63 P0\nM2\n", [("GS507", 2, 1)]),
        ("G21 G90\nM64 P0\nG4 P1\nM65 P0\nM64 P0\nG4 P1\nM65 P0\nM2\n", [("GS507", 2, 2)]),
        ("G21 G90\nT2 M6 G43\nM62 P0\nG1 X1 F600\nM63 P0\nM2\n", [("GS507", 3, 1)]),
        ("G21 G90\nM67 E0 Q50\nM62 P3\nM63 P0\nT1 M6 G43\nG0 X1 Y1 Z0\nM62 P0\nG1 X9 F600\nM63 P0\nM2\n", []),
    ],
)
def test_an_output_that_switches_nothing_on_is_told(program: str, found: list[tuple[str, int, int]]) -> None:
    """As it is on before its tool is there, it would be on as soon as that is; values may be set before."""
    assert told(program, BY_OUTPUT) == found
    assert told(program.replace("M62 P0", "M10").replace("M63 P0", "M11"), BY_OUTPUT.replace("M62 P0", "M10/M11")) == (
        found if "M64" not in program else []
    )


def test_a_spindle_that_turns_a_mill_switches_no_laser() -> None:
    cell = BY_OUTPUT.replace("beam: {word: M62 P0}", "beam: {word: M3}")
    assert told("G21 G90\nT2 M6 G43\nS900 M3\nG1 X1 F600\nM5\nM2\n", cell) == []
