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


def test_a_grip_is_blamed_on_its_own_word() -> None:
    """M11 stands behind M62, before the move with which the gripper closes."""
    assert told("G21 G90\nT2 M6 G43\nG0 X200\nM62 P1\nM11\nG0 Z50\nM2\n") == [("GS561", 4, 1)]
