"""Removed and deposited volumes of whole runs against exact geometry."""

from __future__ import annotations

import json
from math import hypot, pi, radians, tan
from pathlib import Path

import numpy as np
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
    """V-PRG: within the tolerance of the case and within the printed bound, better on a finer grid or next to exact:
    a closed wall leaves some tenths of a cell's area open, with either sign.
    """
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
    assert errors[1] < errors[0] or errors[1] < 5e-5 * want["value"]


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


@pytest.mark.parametrize(
    ("word", "on", "off"), [("M3/M5", "M3 S100", "M5"), ("M62 P1", "M62 P1", "M63 P1"), ("M8/M9", "M8", "M9")]
)
def test_other_words_switch_the_bead_alike(word: str, on: str, off: str) -> None:
    codes = "m_codes:\n  M10: {tool: activate}\n  M11: {tool: deactivate}\n"
    cell = WALL_CELL.replace(codes, f"signals: {{active: {{word: {word}}}}}\n")
    program = (ON + WALLS["right angles"][0] + OFF).replace("M10", on).replace("M11", off)
    ran = run_texts(program, cell)

    assert ran.stock.deposited * 1e9 == pytest.approx(WALLS["right angles"][1] * AREA, rel=0.005)
    assert not ran.results.not_simulated


def test_deposited_volume_of_the_wall_that_ships() -> None:
    """Two layers of `programs/wall.nc` in its cell, on the KR 10: closed loops with corners of 20 mm radius."""
    program = (ROOT / "programs" / "wall.nc").read_text().split("(layer 3)")[0]
    ran = run_texts(program + OFF, (ROOT / "cells" / "wall.yaml").read_text())
    way = 2.0 * (2.0 * 120.0 + 2.0 * 50.0 + 2.0 * pi * 20.0)
    assert ran.stock.deposited * 1e9 == pytest.approx(way * AREA, rel=0.005)


RELIEF_CELL = """
gcodesim: 1
frames:
  table: {in: world, xyz: [520, -40, 250]}
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}
work_offsets: {G54: {in: table, xyz: [0, 0, 15]}}
orientation: {tool_axis: -Z of G54, spin: free}
stock: {box: [50, 40, 15], in: table, zero: bottom-front-left, material: al6082_t6, resolution: 0.5}
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 3, length: 60}
  2: {type: ball_end_mill, diameter: 6, flutes: 2, length: 60}
magazine: {in: world, xyz: [200, 500, 300], pitch: 80, change_time: 1 s}
"""


def relief() -> str:
    """A pocket in three depths, its wall once more at full depth, then a ball along waves over its floor."""
    ring = "X38 F1500\nY28\nX12\nY12\n"
    rough = "".join(f"G0 X12 Y12 Z2\nG1 Z-{depth} F400\n{ring}X32 Y20\nX18\n" for depth in (2, 4, 6))
    waves = "".join(f"X{x} Z{-6.2 - 0.8 * (x % 6 > 0):.1f}\n" for x in range(12, 39, 3))
    rows = "".join(f"G0 X12 Y{y} Z2\nG1 Z-6.2 F400\nF1800\n{waves}" for y in range(13, 28, 2))
    last = "G0 X11.8 Y11.8 Z2\nG1 Z-6 F400\nX38.2 F1500\nY28.2\nX11.8\nY11.8\n"
    first, second = "G21 G90 G17 G94 G64 P0.01\nT1 M6\nG43 H1\nS8000 M3\n", "G0 Z20\nT2 M6\nG43 H2\nS9000 M3\n"
    return f"{first}{rough}{last}{second}{rows}G0 Z20\nM2\n"


def assert_only_removes(ran: Ran) -> None:
    """No sample of the log gives material back, and the samples add up to what the stock has lost."""
    removed, rate = ran.column("/process", "removed_m3", "removal_m3_s").T
    assert rate.min() >= -5e-14  # rounding: 1e-15 m³ in a sample of 20 ms
    assert (np.diff(removed) >= -1e-15).all()
    assert removed[-1] == pytest.approx(ran.stock.initial - ran.stock.remaining, rel=1e-9)


def test_a_relief_on_an_arm_removes_in_every_sample(tmp_path: Path) -> None:
    """Passes at several depths, each bent a little otherwise: walls differ by micrometres."""
    ran = run_texts(relief(), RELIEF_CELL, tmp_path)
    assert_only_removes(ran)


@pytest.mark.slow
def test_the_bracket_on_an_arm_removes_in_every_sample(tmp_path: Path) -> None:
    program, cell = (ROOT / "programs" / "bracket.nc").read_text(), (ROOT / "cells" / "bracket_kr10.yaml").read_text()
    assert_only_removes(run_texts(program, cell, tmp_path))
