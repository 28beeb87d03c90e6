"""GS198: a length that is never taken is a note until that tool cuts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

PROGRAM = "G21 G90 G17 G94\nG49\nT1 M6\nS8000 M3\nG0 X10 Y10\nG0 Z{high}\nG1 Z{low} F400\nG1 X30\nG0 Z{high}\nM5\nM2\n"
CELL = """gcodesim: 1
machine: gantry_xyz
stock: {{box: [100, 60, 80], zero: bottom-front-left, resolution: 1, in: world, xyz: [500, 300, -400]}}
work_offsets: {{G54: {{in: world, xyz: [500, 300, {z}]}}}}
tools:
  1: {{type: flat_end_mill, diameter: 6 mm, length: 40, flute_length: 40}}
simulation: {{world: kinematic}}
"""


def _found(folder: Path) -> list[tuple[str, str]]:
    findings = json.loads((folder / "out" / "results.json").read_text())["findings"]
    return [(finding["severity"], finding["message"]) for finding in findings if finding["code"] == "GS198"]


def test_a_cut_without_length_is_an_error(cli, write, tmp_path: Path) -> None:
    """The cell places G54 at the top of the stock, so every cut is 40 mm too deep."""
    write("part.nc", PROGRAM.format(high=45, low=38))
    assert cli("check", "part.nc", "--cell", "cell.yaml").status == 0  # nothing is cut there
    done = cli("run", "part.nc", "--cell", "cell.yaml")
    assert done.status == 1
    ((severity, message),) = _found(tmp_path)
    assert severity == "error" and message.endswith("; it cuts from line 7 on, at the wrong depth")


def test_without_a_cut_it_stays_a_note(cli, write, tmp_path: Path) -> None:
    write("part.nc", PROGRAM.format(high=60, low=50))
    assert cli("run", "part.nc", "--cell", "cell.yaml").status == 0
    assert [severity for severity, _ in _found(tmp_path)] == ["note"]


@pytest.mark.parametrize(("z", "severity"), [(-320, "error"), (-280, "note")])
def test_a_length_that_stands_in_the_work_offset_is_taken(cli, write, tmp_path: Path, z: int, severity: str) -> None:
    """Z touched off with the tool in the spindle: the zero is the tool's length above the top of the stock."""
    write("cell.yaml", CELL.format(z=z))
    write("part.nc", PROGRAM.format(high=60, low=38 if z == -320 else -2))
    cli("run", "part.nc", "--cell", "cell.yaml")
    assert [found for found, _ in _found(tmp_path)] == [severity]
