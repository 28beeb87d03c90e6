"""Removed and deposited volumes of whole runs against exact geometry."""

from __future__ import annotations

import json
from math import hypot, pi, radians, tan
from pathlib import Path

import pytest

from tests.physics.runs import Ran, run_texts

DATA = Path(__file__).parents[1] / "data" / "physics"
CASES = {case["id"]: case for case in json.loads((DATA / "programs.json").read_text())["cases"]}
ROOT = Path(__file__).parents[2]


def run_case(case: dict, cells: float, rate: int = 250) -> Ran:
    """A case of `programs.json` on a gantry, with `cells` cells across the tool."""
    inputs = case["inputs"]
    stock, diameter = inputs["stock"], inputs["tool"]["diameter_mm"]
    cell = f"""
gcodesim: 1
machine: gantry_xyz
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: {stock["min_mm"]}, max: {stock["max_mm"]}, in: G54, material: al6082_t6, resolution: {diameter / cells}}}
tools:
  1: {{type: {inputs["tool"]["type"]}_end_mill, diameter: {diameter}, length: 60}}
simulation: {{rate: {rate} Hz}}
"""
    return run_texts(inputs["gcode"], cell)


@pytest.mark.parametrize("name", sorted(CASES))
def test_removed_volume_of_a_program(name: str) -> None:
    """V-PRG: within the tolerance of the case and within the printed bound, better on a finer grid."""
    case = CASES[name]
    want = case["expected"]["removed_mm3"]
    errors = []
    for cells in (20, 40):
        ran = run_case(case, cells)
        stock = ran.stock
        removed = stock.removed * 1e9
        errors.append(abs(removed - want["value"]))
        assert errors[-1] <= want["rel"] * want["value"]
        assert errors[-1] <= stock.error_bound * 1e9
        assert stock.removed == pytest.approx(stock.initial - stock.remaining, rel=1e-9)
        assert not ran.bad
    assert errors[1] < errors[0] or errors[1] < 1e-6 * want["value"]


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_rate_of_steps_moves_no_volume(name: str) -> None:
    slow, fast = (run_case(CASES[name], 20, rate).stock.removed for rate in (250, 1000))
    assert slow == pytest.approx(fast, rel=1e-3)


@pytest.mark.parametrize(("diameter", "angle", "depth"), [(6.8, 118, 12), (3.3, 140, 8), (8.5, 90, 10)])
def test_removed_volume_of_a_drilled_hole(diameter: float, angle: float, depth: float) -> None:
    """A cycle goes down in steps of a simulation and comes back up: still the volume of cylinder and cone."""
    cell = f"""
gcodesim: 1
machine: gantry_xyz
stock: {{box: [30, 20, 15], zero: top-front-left, material: al6082_t6, resolution: {diameter / 20}}}
tools:
  1: {{type: drill, diameter: {diameter}, point_angle: {angle}, length: 60}}
"""
    ran = run_texts(f"G21 G90\nT1 M6\nS2000 M3\nG0 X14 Y9 Z5\nG83 Z-{depth} R2 Q3 F200\nG80\nG0 Z10\nM5\nM2\n", cell)
    r = diameter / 2
    point = r / tan(radians(angle / 2))
    assert ran.stock.removed * 1e9 == pytest.approx(pi * r**2 * (depth - 2 / 3 * point), rel=2e-3)
    assert not ran.bad


WALL_CELL = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [-10, -10, -5], max: [70, 50, 0], in: G54, resolution: 0.5}
tools:
  1: {type: extruder, bead_width: 6, bead_height: 3, length: 100}
m_codes:
  M10: {tool: activate}
  M11: {tool: deactivate}
"""
ON, OFF = "G21 G90 G17 G94 G61\nT1 M6\nG43 H1\nG0 X0 Y0 Z10\nG0 Z3\nM10\n", "M11\nG0 Z30\nM2\n"
AREA = (6.0 - 3.0) * 3.0 + pi * 3.0**2 / 4.0

WALLS = {
    "straight": ("G1 X60 F3000\n", 60.0),
    "right angles": ("G1 X60 F3000\nG1 Y40\nG1 X20\n", 60.0 + 40.0 + 40.0),
    "sharp and blunt": ("G1 X50 F3000\nG1 X25 Y40\nG1 X0 Y45\n", 50.0 + hypot(25, 40) + hypot(25, 5)),
    "arcs": ("G1 X40 F3000\nG3 X40 Y40 J20\nG1 X10\n", 40.0 + 20.0 * pi + 30.0),
    "two layers": ("G1 X60 F3000\nG1 Y40\nG0 Z6\nG1 Y0\nG1 X0\n", 200.0),
}


@pytest.mark.parametrize("name", WALLS)
def test_deposited_volume_of_a_wall(name: str) -> None:
    """A bead of 6 x 3 mm is (6 - 3) 3 + pi 3²/4 mm² along its path, round corners or sharp."""
    program, way = WALLS[name]
    ran = run_texts(ON + program + OFF, WALL_CELL)
    assert ran.stock.deposited * 1e9 == pytest.approx(way * AREA, rel=0.005)
    assert ran.stock.removed == 0.0
    assert ran.stock.remaining == pytest.approx(ran.stock.initial + ran.stock.deposited, rel=1e-9)


def test_deposited_volume_of_the_wall_that_ships() -> None:
    """Two layers of `programs/wall.nc` in its cell, on the KR 10: closed loops with corners of 20 mm radius."""
    program = (ROOT / "programs" / "wall.nc").read_text().split("(layer 3)")[0]
    ran = run_texts(program + OFF, (ROOT / "cells" / "wall.yaml").read_text())
    way = 2.0 * (2.0 * 120.0 + 2.0 * 50.0 + 2.0 * pi * 20.0)
    assert ran.stock.deposited * 1e9 == pytest.approx(way * AREA, rel=0.005)
