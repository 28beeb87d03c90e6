"""Filament that a program pushes while the head has no nozzle."""

from pathlib import Path

import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import check, prepare

STOCK = "stock: {box: [100, 60, 5], zero: top-front-left, resolution: 2}\n"
CELL = "gcodesim: 1\nmachine: gantry_xyz\ndialect: marlin\n" + STOCK
NOZZLE = "type: extruder, bead_width: 0.5, bead_height: 0.2"
MILL = "type: flat_end_mill, diameter: 3 mm, flutes: 2, length: 50 mm"
PRINT = "G28\nG1 Z2 F600\nG1 X20 E1\nG1 X40 E0.5\nG1 X80 E2.5\n"


def findings_of(cell: str, program: str = PRINT) -> dict[str, list[str]]:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))

    results = check(prepare(SourceText("program.gcode", program.encode()), loaded))
    found: dict[str, list[str]] = {}
    for each in results.findings:
        found.setdefault(each.code, []).append(f"{each.span.line}: {each.message} | {each.hint}")
    return found


@pytest.mark.parametrize(
    ("tools", "says", "hint"),
    [
        ("", "there is no tool in the head", "type: extruder"),
        (f"tools:\n  1: {{{MILL}}}\n", "T1 is no extruder", "type: extruder"),
        (f"tools:\n  1: {{{MILL}}}\n  2: {{{NOZZLE}}}\n", "T1 is no extruder", "the cell has T2"),
    ],
)
def test_e_words_without_an_extruder_are_told(tools, says, hint):
    found = findings_of(CELL + tools)
    (text,) = found["GS548"]
    assert text.startswith("3: 3.0 mm of filament go nowhere") and says in text and hint in text
    assert "GS506" not in found


def test_an_extruder_takes_them():
    assert "GS548" not in findings_of(CELL + f"tools:\n  0: {{{NOZZLE}}}\n")
    assert "GS548" not in findings_of(CELL, "G28\nG1 Z2 F600\nG1 X20\n")
    assert "GS506" in findings_of(CELL, "G28\nG1 Z2 F600\nG1 X20\n")
