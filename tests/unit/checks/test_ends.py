"""What is still on when a program ends."""

from __future__ import annotations

from pathlib import Path

import pytest

from gcodesim.cell import read_cell
from gcodesim.checks.ends import end_findings
from gcodesim.diagnostics import SourceText, Span
from gcodesim.simulation import check, prepare
from gcodesim.units import RPM


def test_what_is_on_at_the_end() -> None:
    last = Span("part.nc", 9, 1)

    assert end_findings(last) == []
    findings = end_findings(last, spindle=-12000 * RPM, process="extruder", flood=True, mist=True)

    assert [f.code for f in findings] == ["GS503", "GS504", "GS505"]
    assert "M4" in findings[0].message and "12000 rpm" in findings[0].message
    assert "extruder" in findings[1].message
    assert "flood and mist" in findings[2].message
    assert all(f.span is last for f in findings)
    (kept,) = end_findings(last, spindle=3.0, cutting=True)
    assert "(M3, 180 m/min)" in kept.message and (kept.value, kept.unit) == (180.0, "m/min")


def _ended(words: str, active: str) -> list[str]:
    """The codes for a program in a cell whose process tool a word switches."""
    cell = (
        "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\ntools:\n"
        "  1: {type: extruder, bead_width: 2, bead_height: 1}\n"
        f"signals: {{active: {active}}}\n"
    )
    program = SourceText("p.nc", f"G21 G90\nT1 M6\nG43 H1\nG0 Z-100\n{words}\nM2\n".encode())
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    assert loaded.cell is not None, loaded.findings
    return [f.code for f in check(prepare(program, loaded)).findings if f.code == "GS504"]


@pytest.mark.parametrize(
    ("active", "on", "off"),
    [
        ("{word: M62 P3}", "M62 P3\nG1 X10 F600", "M63 P3\nG1 X0"),
        ("{word: M64 P3}", "M64 P3", "M65 P3"),
        ("{word: M67 E1}", "M68 E1 Q2", "M68 E1 Q0"),
        ("{word: M110/M111}", "M110", "M111"),
    ],
)
def test_a_process_that_any_word_of_the_cell_switched_on_is_told(active: str, on: str, off: str) -> None:
    assert _ended(on, active) == ["GS504"]
    assert _ended(f"{on}\n{off}", active) == []
