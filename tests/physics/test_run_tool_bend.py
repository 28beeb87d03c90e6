"""Tools that bend, on an arm whose gears swing under the cut (bullet) and on one whose gears give way at once."""

from __future__ import annotations

import pytest

from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
robots:
  arm:
    model: kuka_kr10_r1100_2
    home: [0, -90, 90, 0, 90, 0]
    payload: {{mass: 3 kg, xyz: [0, 0, 60]}}
frames:
  table: {{in: world, xyz: [550, 100, 300]}}
work_offsets: {{G54: {{in: table}}}}
orientation: {{tool_axis: -Z of G54, spin: free}}
stock: {{min: [0, 0, -8], max: [24, 20, 0], in: table, material: al6082_t6, resolution: 0.25}}
tools:
  1: {{type: flat_end_mill, diameter: 6, flutes: 3, length: 50{of}}}
  2: {{type: drill, diameter: 6, flutes: 2, length: 80{of}}}
"""
PROGRAM = """G21 G90 G17 G94 G61
T1 M6
G43 H1
S6000 M3
G0 X-5 Y5 Z5
G0 Z-2
G1 X29 F600
G0 Z20
T2 M6
G43 H2
S4200 M3
G98 G83 X14 Y14 Z-12 R1 Q4 F420
G80
M5
M2
"""


def _ran(world: str, of: str = ", substrate: carbide") -> Ran:
    return run_texts(PROGRAM, CELL.format(of=of), world=world)


@pytest.fixture(scope="module")
def swinging() -> Ran:
    return _ran("bullet")


def test_a_mill_that_bends_on_gears_that_swing_has_the_force_of_one_on_gears_that_give_way(swinging: Ran) -> None:
    """The bend takes part in the balance of gears and cut."""
    at_once, here = _ran("kinematic").results.tools[0], swinging.results.tools[0]

    assert here["max_force_N"] == pytest.approx(at_once["max_force_N"], rel=0.03)
    assert here["max_tool_bend_mm"] == pytest.approx(at_once["max_tool_bend_mm"], rel=0.05)
    assert here["max_peak_force_N"] < 1.2 * at_once["max_peak_force_N"]


def test_a_drill_is_held_by_its_hole(swinging: Ran) -> None:
    """Its lips push it aside, and the margins hold it; it reamed its hole, with thrusts of 30 kN in single steps."""
    straight, here = _ran("bullet", of="").results.tools[1], swinging.results.tools[1]

    for name in ("removed_mm3", "max_peak_force_N", "max_torque_Nm"):
        assert here[name] == pytest.approx(straight[name], rel=0.01), name
    assert here.get("max_tool_bend_mm", 0.0) == 0.0
