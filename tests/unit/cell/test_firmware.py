"""Limits of a printer's planner in the cell."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell.loader import LoadedCell, read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import prepare

CELL = """machine:
  axes:
    X: {travel: [0, 250], speed: 1000 mm/s, acceleration: 50 m/s^2}
    Y: {travel: [0, 250], speed: 1000 mm/s, acceleration: 50 m/s^2}
    Z: {travel: [0, 250], speed: 1000 mm/s, acceleration: 50 m/s^2}
tools:
  0: {type: extruder, bead_width: 0.4, bead_height: 0.2}
"""
PRINT = "G21\nG90\nM83\nG1 X20 Y20 Z0.2 F30000\nG1 X40 E1\nG1 Y40 E1\nG1 E-2 F3000\nG1 X20 E1 F30000\nG0 X0\n"


def loaded(dialect: str, firmware: str = "") -> LoadedCell:
    own = f"firmware: {{{firmware}}}\n" if firmware else ""
    return read_cell(SourceText("p.yaml", f"dialect: {dialect}\n{own}{CELL}".encode()), Path("p.yaml"))


def seconds(cell: LoadedCell, words: str = "", program: str = PRINT) -> float:
    job = prepare(SourceText("p.gcode", (words + program).encode()), cell)
    assert job.plan is not None, list(job.findings)
    return job.plan.trajectory.duration


@pytest.mark.parametrize(
    ("dialect", "firmware", "words"),
    [
        ("klipper", "corner_speed: 12 mm/s", "SET_VELOCITY_LIMIT SQUARE_CORNER_VELOCITY=12\n"),
        ("marlin", "jerk: [20, 18, 1, 7 mm/s]", "M205 X20 Y18 Z1 E7\n"),
        ("marlin", "junction_deviation: 0.05", "M205 J0.05\n"),
        ("marlin", "printing: 500 mm/s^2, travel: 700 mm/s^2, retracting: 900 mm/s^2", "M204 P500 R900 T700\n"),
        ("marlin", "speed: [100, 90, 7, 20 mm/s]", "M203 X100 Y90 Z7 E20\n"),
        ("marlin", "acceleration: [900, 800, 70, 2000 mm/s^2]", "M201 X900 Y800 Z70 E2000\n"),
    ],
)
def test_they_hold_as_if_the_program_had_set_them(dialect: str, firmware: str, words: str) -> None:
    usual, said = seconds(loaded(dialect)), seconds(loaded(dialect, firmware))

    assert said == pytest.approx(seconds(loaded(dialect), words), rel=1e-9)
    assert said != pytest.approx(usual, rel=1e-3)


def test_the_program_has_the_last_word() -> None:
    assert seconds(loaded("marlin", "printing: 500 mm/s^2"), "M204 P3000 R3000 T3000\n") == seconds(loaded("marlin"))


def test_comments_of_a_slicer_do_not_outweigh_the_printer() -> None:
    slicer = PRINT + "; machine_max_acceleration_extruding = 100\n"
    own = loaded("marlin", "printing: 500 mm/s^2")

    assert seconds(own, program=slicer) == seconds(own)


def test_what_does_not_fit() -> None:
    two = loaded("marlin", "junction_deviation: 0.05, corner_speed: 5 mm/s")
    short = loaded("marlin", "jerk: [20, 20 mm/s]")
    for cell in (two, short):
        assert cell.cell is None
        assert [finding.span.line for finding in cell.findings] == [2]
