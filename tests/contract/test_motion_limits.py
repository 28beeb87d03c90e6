"""No emitted trajectory exceeds a limit: the samples themselves, over machines and programs drawn at random.

Differences of joints a control cycle apart are means of speed and of acceleration over that time, so none of them may
be above its limit; a step of direction that is passed at speed is one of acceleration within a cycle.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.motion.blend_kernels import CYCLE
from gcodesim.planning import Plan
from gcodesim.planning.shop_posing import loads_of
from gcodesim.shop import Shop
from gcodesim.simulation import prepare
from tests.contract.drawn_motion import KINDS, Drawn, with_jerk
from tests.slow import some_slow

BEYOND = ("GS201", "GS202", "GS203", "GS205", "GS216", "GS232")  # findings of a path that cannot be had
ROUNDING = 1e-3  # joints are solved to 1e-9 m, which makes 1e-3 m/s² in a difference of two differences
BORNE = 0.97  # of an effort limit; an arm that can hardly bear its load at rest is not helped by going slower
FEW, MANY = 3, 60


def plans_of(drawn: Drawn) -> list[tuple[Plan, Shop]]:
    """The plans of all channels and legs, with their shops; none where a machine cannot run all of its program."""
    loaded = read_cell(SourceText("cell.yaml", drawn.cell.encode()), Path("cell.yaml"))
    assert not [f.message for f in loaded.findings if f.level.word == "error"]
    others = {name: SourceText(f"{name}.nc", text.encode()) for name, text in drawn.others.items()}
    job = prepare(SourceText("program.nc", drawn.program.encode()), loaded, Options(world="kinematic", channels=others))
    if job.legs is not None:
        while job.legs.onward() is not None:
            pass
    plans = [(each.plan, each.shop) for each in job.all if each.plan is not None and each.shop is not None]
    assert len(plans) == 1 + len(others), [f.message for f in job.findings]
    return [] if any(f.code in BEYOND for each in job.all for f in each.findings) else plans


def shares(plan: Plan) -> tuple[float, float]:
    """The greatest share of a joint's speed and acceleration limit in the samples; positions are within limits."""
    trajectory, joints = plan.trajectory, plan.kinematics.joints
    q = plan.joints(trajectory.sample(np.arange(-2 * CYCLE, trajectory.duration + 3 * CYCLE, CYCLE)))
    assert (q >= joints.lower - 1e-9).all() and (q <= joints.upper + 1e-9).all()
    speed = np.diff(q, axis=0) / CYCLE
    acceleration = np.diff(speed, axis=0) / CYCLE
    return float((np.abs(speed) / joints.speed).max()), float((np.abs(acceleration) / joints.acceleration).max())


def share_of_efforts(plan: Plan, shop: Shop) -> float:
    """The greatest share of a motor's effort limit, where it could bear the arm at rest."""
    trajectory, loads = plan.trajectory, loads_of(shop)
    samples = trajectory.sample(np.arange(-2 * CYCLE, trajectory.duration + 3 * CYCLE, CYCLE))
    q = plan.joints(samples)
    tool = np.array([state.tool for state in plan.path.states])[plan.path.state[samples.row]][1:-1]
    here = np.ascontiguousarray(q[1:-1])
    speed, acceleration = (q[2:] - q[:-2]) / (2.0 * CYCLE), np.diff(q, n=2, axis=0) / CYCLE**2
    feeds = np.isfinite(plan.path.feed[samples.row])
    feeding = feeds[:-2] & feeds[1:-1] & feeds[2:]  # else the acceleration is in part that of a move that does no work
    reserve = loads.reserve(tool, here, speed, feeding)
    efforts = (np.abs(*loads.efforts(tool, here, (speed, acceleration))) + reserve) / loads.limit
    borne = (np.abs(*loads.efforts(tool, here, (0.0, 0.0))) + reserve) / loads.limit < BORNE
    return float(np.where(borne, efforts, 0.0).max())


def check(kind: str, seeds: range) -> None:
    used, run = 0.0, 0
    for seed in seeds:
        for plan, shop in plans_of(KINDS[kind](Random(f"{kind} {seed}"))):
            speed, acceleration = shares(plan)
            assert speed <= 1.0 + 1e-6, seed
            assert acceleration <= 1.0 + ROUNDING, seed
            if kind.startswith("arm"):
                assert share_of_efforts(plan, shop) <= 1.0, seed
            used, run = max(used, acceleration), run + 1
    assert run >= len(seeds) // 3
    assert used > 0.8  # and limits are made use of


def check_jerk(kind: str, seeds: range) -> None:
    used = 0.0
    for seed in seeds:
        for plan, _ in plans_of(with_jerk(KINDS[kind](Random(f"{kind} {seed}")), Random(seed))):
            speed, acceleration = shares(plan)
            assert speed <= 1.0 + 1e-6 and acceleration <= 1.0 + ROUNDING, seed
            trajectory, joints = plan.trajectory, plan.kinematics.joints
            q = plan.joints(trajectory.sample(np.arange(-3 * CYCLE, trajectory.duration + 4 * CYCLE, CYCLE)))
            jerk = float((np.abs(np.diff(q, n=3, axis=0)) / CYCLE**3 / joints.jerk).max())
            # times are rounded by a few places, of which a third difference takes eight; arms are solved to 1e-9 m
            times = float((64.0 * np.spacing(trajectory.duration) * joints.speed / CYCLE**3 / joints.jerk).max())
            assert jerk <= 1.0 + (10.0 * ROUNDING if kind.startswith("arm") else 1e-6 + times), seed
            used = max(used, jerk)
    assert used > 0.5


@pytest.mark.parametrize(("kind", "seed"), [("arm by vectors", 3004), ("arm", 3143)])
def test_a_rate_that_changes_within_a_step_is_looked_at_more_closely(kind: str, seed: int) -> None:
    """Beside a singularity joint 4 was at 1.004 of its speed; joint 1 of the other arm at 1.00002."""
    ((plan, _),) = plans_of(KINDS[kind](Random(f"{kind} {seed}")))
    assert shares(plan)[0] <= 1.0 + 1e-6


HOOD = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2}}
frames: {bench: {in: world, xyz: [600, 0, 150]}}
work_offsets: {G54: {in: bench}}
orientation: {tool_axis: normal of hood, within: 150 mm}
tools: {8: {type: spray_gun, cone: 30 deg, efficiency: 0.65, solids: 0.45, distance: 100, length: 100}}
parts: {hood: {cylinder: [240, 240], in: bench, xyz: [-120, 0, 0], rpy: [0, 90, 0], mass: 2 kg}}
"""


def test_an_arm_that_stands_on_a_surface_of_facets_keeps_its_accelerations() -> None:
    """Between two knots of its direction they swing to and fro; joint 2 was at 1.07 of its limit."""
    arc = "G21 G90 G19 G94 G64 P0.1\nT8 M6\nG43 H8\nG0 X-25 Y155.563 Z155.563\nG3 Y-155.563 Z155.563 R220 F12000\nM2\n"
    ((plan, _),) = plans_of(Drawn(HOOD, arc))
    speed, acceleration = shares(plan)
    assert speed <= 1.0 + 1e-6 and 0.9 < acceleration <= 1.0 + ROUNDING


RAIL = """gcodesim: 1
robots: {arm: {model: abb_irb6700_200_260, payload: 6 kg}}
work_offsets: {G54: {in: world, xyz: [900 mm, 620 mm, 400 mm]}}
externals:
  rail: {carries: arm, free: true, axes: {U: {travel: [0, 2 m], speed: 0.57 m/s, acceleration: 3.7 m/s^2, home: 0.9 m}}}
tools: {1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}}
"""


def test_a_rail_that_stays_near_the_end_of_its_travel_does_not_leave_it() -> None:
    """Splines through places at the end of its travel went up to 6 µm beyond it."""
    program = (
        "G21 G90 G61\nT1 M6\nG1 X2 Y1 Z1 F1572\nG0 X10 Y4 Z5\nG0 X20 Y70 Z10\nG1 X48 Y80 Z11 F3000\nG1 X70 Y80 Z5\nM2\n"
    )
    ((plan, _),) = plans_of(Drawn(RAIL, program))
    shares(plan)
    rail = plan.joints(plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, CYCLE)))[:, 0]
    assert rail.min() < 1e-3  # [m]


@pytest.mark.parametrize("kind", some_slow(KINDS, "arm on a rail"))
def test_no_jerk_is_beyond_its_limit(kind: str) -> None:
    check_jerk(kind, range(2))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_no_jerk_of_many_is_beyond_its_limit(kind: str) -> None:
    check_jerk(kind, range(2, MANY // 2))


@pytest.mark.parametrize("kind", some_slow(KINDS, "arm on a rail"))
def test_no_sample_is_beyond_a_limit(kind: str) -> None:
    check(kind, range(FEW))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_no_sample_of_many_is_beyond_a_limit(kind: str) -> None:
    check(kind, range(FEW, MANY))
