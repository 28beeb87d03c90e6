"""What a gripper holds weighs on the motors of an arm: no effort beyond its limit with the part, in time and place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.kinematics.chain import Inertial
from gcodesim.kinematics.dynamics import merge
from gcodesim.planning import Plan
from gcodesim.planning.shop_posing import loads_of
from gcodesim.shop import Shop
from gcodesim.simulation import Options, prepare

CELL = """gcodesim: 1
frames: {{table: {{in: world, xyz: [620, 0, 200]}}}}
robots: {{arm: {{model: kuka_kr10_r1100_2, acceleration: [3000, 3000, 3000, 3000, 3000, 3000 deg/s^2]}}}}
work_offsets: {{G54: {{in: table}}}}
orientation: {{tool_axis: -Z of G54, spin: 0}}
m_codes: {{M62 P1: {{gripper: close}}, M63 P1: {{gripper: open}}}}
loaded_tool: 1
tools:
  1: {{type: finger_gripper, stroke: 60, force: 4000 N, friction: 0.5, length: 120, mass: 1 kg}}
parts:
  block: {{box: [40, 40, 80], zero: bottom-center, mass: {mass} kg, in: table, xyz: [0, -300, 0]}}
  other: {{box: [40, 40, 80], zero: bottom-center, mass: 90 kg, in: table, xyz: [0, 0, 0]}}
"""
CARRY = """G21 G90 G17 G94 G64 P1
G0 X0 Y-300 Z150
G1 Z60 F6000
M62 P1
G4 P0.1
G1 Z150 F60000
G1 Y300
G1 Z60
M63 P1
G4 P0.1
G0 Z150
G0 Y-300
M2
"""
SWING = (6, 7)  # the line in which the part is lifted, and that in which it is carried
CYCLE = 1e-3


def planned(mass: float, program: str = CARRY) -> tuple[Plan, Shop]:
    loaded = read_cell(SourceText("cell.yaml", CELL.format(mass=mass).encode()), Path("cell.yaml"))
    assert not loaded.findings, [f.message for f in loaded.findings]
    job = prepare(SourceText("carry.nc", program.encode()), loaded, Options(world="kinematic"))
    assert job.plan is not None and job.shop is not None
    return job.plan, job.shop


def time_of(plan: Plan, line: int) -> float:
    rows = [row for row in range(len(plan.path)) if plan.path.span(row).line == line]
    t = plan.trajectory
    return float(sum(t.row_end[row] - t.row_start[row] for row in rows))


def share_of_efforts(plan: Plan, shop: Shop, mass: float, line: int) -> float:
    """The greatest share of an effort limit in a line, with the part 20 mm and its middle 40 mm below the tip."""
    rows = [row for row in range(len(plan.path)) if plan.path.span(row).line == line]
    begin, end = plan.trajectory.row_start[rows[0]], plan.trajectory.row_end[rows[-1]]
    q = plan.joints(plan.trajectory.sample(np.arange(begin, end, CYCLE)))
    loads = loads_of(shop)
    own = loads.tools[1]
    assert own is not None
    # gripped 60 mm above its foot: its middle is 20 mm below the tip, which is 120 mm from the flange
    x, z = mass * (0.04**2 + 0.08**2) / 12.0, mass * 2 * 0.04**2 / 12.0
    block = Inertial(mass=mass, com=np.array([0.0, 0.0, 0.14]), inertia=np.diag([x, x, z]))
    laden = replace(loads, tools={1: merge([(own, np.eye(4)), (block, np.eye(4))])})
    speed, acceleration = (q[2:] - q[:-2]) / (2.0 * CYCLE), np.diff(q, n=2, axis=0) / CYCLE**2
    here = np.ascontiguousarray(q[1:-1])
    (efforts,) = laden.efforts(np.ones(len(here), dtype=np.int64), here, (speed, acceleration))
    return float((np.abs(efforts) / loads.limit).max())


@pytest.mark.parametrize("line", SWING)
def test_motors_can_bear_a_part_that_is_carried(line: int) -> None:
    light, _ = planned(0.01)
    plan, shop = planned(11.0)

    assert share_of_efforts(light, shop, 11.0, line) > 1.0
    assert 0.8 < share_of_efforts(plan, shop, 11.0, line) <= 1.0
    assert time_of(plan, line) > time_of(light, line)


def test_only_while_it_is_carried() -> None:
    light, _ = planned(0.01)
    heavy, _ = planned(11.0)

    for line in (2, 3, 11, 12):
        assert time_of(heavy, line) == pytest.approx(time_of(light, line), rel=1e-9)


def test_a_gripper_that_closes_on_nothing_carries_nothing() -> None:
    program = CARRY.replace("Y-300", "Y-200")
    light, _ = planned(0.01, program=program)
    heavy, _ = planned(11.0, program=program)

    assert heavy.trajectory.duration == light.trajectory.duration


def test_a_part_is_where_it_was_put_down() -> None:
    again = CARRY.replace("M2\n", "G0 Y300\nG1 Z60 F6000\nM62 P1\nG4 P0.1\nG1 Z150 F60000\nG1 Y-300\nM2\n")
    light, _ = planned(0.01, program=again)
    heavy, _ = planned(11.0, program=again)

    assert time_of(heavy, 18) > time_of(light, 18)
