"""The grid of a stock for which the cell names none."""

import pytest

from gcodesim.shop.blanks import default_resolution, narrowest_slope
from gcodesim.tools import TOOLS
from gcodesim.units import MM
from tests.physics.runs import run_texts

INCH = 25.4 * MM
LARGE = (600 * MM, 200 * MM, 50 * MM)


class Cell:
    """What is asked of a cell: its tools."""

    def __init__(self, *tools):
        self.tools = dict(enumerate(tools))


def mill(kind, diameter, **sizes):
    return TOOLS[kind](diameter=diameter, **sizes)


@pytest.mark.parametrize(
    ("tools", "size", "wanted"),
    [
        ([], LARGE, 0.5 * MM),
        ([mill("flat_end_mill", 6 * MM)], LARGE, 0.25 * MM),
        ([mill("flat_end_mill", 0.5 * MM)], LARGE, 0.173 * MM),  # 4 million columns
        ([mill("flat_end_mill", 24 * MM)], LARGE, 1.0 * MM),
        ([mill("flat_end_mill", 6 * INCH)], LARGE, 2.0 * MM),
        ([mill("flat_end_mill", 6 * INCH)], (100 * MM, 72 * MM, 50 * MM), 1.2 * MM),  # 60 across the stock
        ([mill("flat_end_mill", 6 * INCH)], (100 * MM, 10 * MM, 50 * MM), 0.5 * MM),  # as before
        ([mill("flat_end_mill", 6 * INCH), mill("drill", 6 * MM)], LARGE, 0.25 * MM),
        ([mill("bull_nose_end_mill", 60 * MM, corner_radius=2 * MM)], LARGE, 1.0 * MM),  # two across the corner
        ([mill("bull_nose_end_mill", 60 * MM, corner_radius=0.4 * MM)], LARGE, 0.5 * MM),
        ([mill("ball_end_mill", 24 * MM)], LARGE, 1.0 * MM),
    ],
)
def test_as_fine_as_the_tools_can_tell_apart(tools, size, wanted):
    assert default_resolution(Cell(*tools), size) == pytest.approx(wanted, rel=2e-3)


def test_the_narrowest_slope_of_an_edge():
    assert narrowest_slope(mill("flat_end_mill", 8 * MM)) == 0.0
    assert narrowest_slope(mill("bull_nose_end_mill", 8 * MM, corner_radius=1.5 * MM)) == pytest.approx(1.5 * MM)
    assert narrowest_slope(mill("chamfer_mill", 8 * MM, angle=1.5, tip_diameter=2 * MM)) == pytest.approx(3 * MM)
    assert narrowest_slope(TOOLS["probe"](diameter=4 * MM)) == 0.0


def test_facing_by_a_large_mill_takes_its_volume_on_the_coarse_grid():
    """Three rows of a face mill of 6 inches, 1.5 mm deep, and a step that it leaves at one side."""
    cell = (
        "gcodesim: 1\nmachine: {axes: {X: {travel: [0, 2000 mm], speed: 30 m/min}, "
        "Y: {travel: [0, 1000 mm], speed: 30 m/min}, Z: {travel: [-500, 0 mm], speed: 20 m/min}}}\n"
        "work_offsets: {G54: {xyz: [400, 200, -300]}}\n"
        "stock: {box: [600, 300, 40], zero: bottom-front-left, xyz: [0, 0, -40], in: G54}\n"
        "tools: {1: {type: face_mill, diameter: 6 in, lead_angle: 0 deg}}\n"
    )
    rows = "".join(f"G0 X-100 Y{y} Z5\nG1 Z-1.5 F3000\nX700\nG0 Z5\n" for y in (40, 150, 203.7))
    ran = run_texts(f"G21 G90 G61\nT1 M6\nG43 H1\nS800 M3\n{rows}M5\nM2\n", cell)

    assert ran.stock.resolution == pytest.approx(2.0 * MM)
    assert ran.stock.removed == pytest.approx(600 * MM * (203.7 * MM + 3 * INCH) * 1.5 * MM, rel=1e-6)
