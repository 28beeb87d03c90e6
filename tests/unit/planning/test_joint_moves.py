"""Moves in joint space: closed forms, limits, and what motors allow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gcodesim.kinematics import Axis, chain_of_axes, kinematics_of, load_urdf, model_path
from gcodesim.kinematics.chain import Inertial
from gcodesim.planning.joint_moves import JointMove
from gcodesim.planning.loads import Loads

JOINTS = kinematics_of(
    chain_of_axes(
        [Axis(letter="X", speed=1.0, acceleration=2.0), Axis(letter="Y", speed=0.5, acceleration=4.0), Axis(letter="Z")]
    )
).joints
SOFT = replace(JOINTS, jerk=np.array([10.0, 40.0, np.inf]))


def move(*step: float, soft: bool = False) -> JointMove:
    return JointMove.between(np.zeros(3), np.array(step), SOFT if soft else JOINTS)


@pytest.mark.parametrize(
    ("step", "expected"),
    [
        ((1.0, 0.0, 0.0), 1.0 / 1.0 + 1.0 / 2.0),  # trapezoid
        ((0.1, 0.0, 0.0), 2.0 * np.sqrt(0.1 / 2.0)),  # triangle
        ((0.1, 1.0, 0.0), 1.0 / 0.5 + 0.5 / 4.0),  # the slower joint decides
        ((0.0, 0.0, 0.0), 0.0),
    ],
)
def test_duration(step: tuple[float, ...], expected: float) -> None:
    assert move(*step).duration == pytest.approx(expected)


@pytest.mark.parametrize(
    ("step", "expected"),
    [
        (2.0, 2.0 / 1.0 + 1.0 / 2.0 + 2.0 / 10.0),  # all seven phases: D/v + v/a + a/j
        (0.3, 0.2 + np.sqrt(0.2**2 + 4.0 * 0.3 / 2.0)),  # full acceleration, speed not reached
        (0.001, 4.0 * np.cbrt(0.001 / 20.0)),  # jerk alone: four equal phases
    ],
)
def test_duration_under_jerk(step: float, expected: float) -> None:
    """Closed forms of Biagiotti, Melchiorri 2008, section 3.4."""
    assert move(step, 0.0, 0.0, soft=True).duration == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("soft", [False, True])
@pytest.mark.parametrize("step", [(1.0, -0.3, 0.0), (0.01, 0.02, 0.0), (0.3, 0.0, 0.0), (2.5, 0.1, 0.0)])
def test_all_joints_keep_their_limits_and_arrive(step: tuple[float, ...], soft: bool) -> None:
    own = move(*step, soft=soft)
    t = np.linspace(-0.1, own.duration + 0.1, 4001)

    q = own.at(t)

    dt = t[1] - t[0]
    speed = np.diff(q, axis=0) / dt
    acceleration = np.diff(speed, axis=0) / dt
    assert np.allclose(q[0], 0.0) and np.allclose(q[-1], step)
    assert np.all(np.abs(speed).max(axis=0)[:2] <= JOINTS.speed[:2] * 1.0001)
    assert np.all(np.abs(acceleration).max(axis=0)[:2] <= JOINTS.acceleration[:2] * 1.0001)
    if soft:
        jerk = np.diff(acceleration, axis=0) / dt
        assert np.all(np.abs(jerk).max(axis=0)[:2] <= SOFT.jerk[:2] * 1.01)


@pytest.mark.parametrize("soft", [False, True])
def test_the_law_is_the_derivative_of_the_way(soft: bool) -> None:
    own = move(1.3, 0.2, 0.0, soft=soft)
    t = np.linspace(0.0, own.duration, 20001)

    share, rate, change = own.law_at(t)

    assert np.allclose(share, own.share_at(t), atol=1e-12)
    assert np.allclose(np.gradient(share, t)[2:-2], rate[2:-2], atol=1e-3)
    steps = np.abs(np.diff(change)) > 1e-2  # a trapezoid's acceleration steps
    apart = np.abs(np.gradient(rate, t)[:-1] - change[:-1])[~steps & ~np.roll(steps, 1)]
    assert apart.max() < 1e-2


def arm_with(payload: float, model: str = "kuka_kr10_r1100_2") -> Loads:
    chain, _ = load_urdf(model_path(model))
    assert chain is not None
    held = Inertial(mass=payload, com=np.array([0.0, 0.0, 0.15]), inertia=np.zeros((3, 3)))
    return Loads(chain=chain, tools={1: held})


@pytest.mark.parametrize("payload", [0.0, 25.0])
def test_motors_are_asked_for_no_more_than_they_can_give(payload: float) -> None:
    loads = arm_with(payload)
    start, end = np.radians([0.0, -60.0, 90.0, 0.0, 40.0, 0.0]), np.radians([90.0, -90.0, 120.0, 20.0, 0.0, 60.0])
    plain = JointMove.between(start, end, loads.chain.driven_joints)

    own, why = plain.within(loads, 1)

    t = np.linspace(0.0, own.duration, 2001)
    _, rate, change = own.law_at(t)
    way, tool = end - start, np.ones(len(t), dtype=np.int64)
    share = np.abs(*loads.efforts(tool, own.at(t), (rate[:, None] * way, change[:, None] * way))) / loads.limit
    borne = np.abs(*loads.efforts(tool, own.at(t), (0.0, 0.0))) / loads.limit < 0.97  # at rest
    if payload == 0.0:
        assert own is plain and why is None
    else:
        assert why is not None and why.effort[0] > 1.0 * loads.limit[why.joint[0]] * 0.98
        assert own.duration > 1.02 * plain.duration
        assert borne[:, why.joint[0]].all() and 0.9 < share[borne].max() <= 1.0
    assert np.allclose(own.at(np.array([0.0, own.duration])), [start, end])


def test_motors_bear_the_ends_of_the_ramps() -> None:
    """There speed and acceleration are greatest together, between the places that stand evenly."""
    loads, pick = arm_with(25.0), np.random.default_rng(3)
    joints, slowed = loads.chain.driven_joints, 0
    for _ in range(200):
        start, end = (pick.uniform(np.maximum(joints.lower, -2.0), np.minimum(joints.upper, 2.0)) for _ in range(2))
        own, why = JointMove.between(start, end, joints).within(loads, 1)
        if why is None:
            continue
        way, j = end - start, int(why.joint[0])
        ramp = own.duration - 1.0 / own.peak
        inside = ramp * (1.0 - 1e-6)
        t = np.array([0.0, inside, own.duration - inside, own.duration])
        share, rate, change = own.law_at(t)
        q, tool = start + share[:, None] * way, np.ones(len(t), dtype=np.int64)
        asked = np.abs(*loads.efforts(tool, q, (rate[:, None] * way, change[:, None] * way))) / loads.limit
        borne = np.abs(*loads.efforts(tool, q, (0.0, 0.0)))[:, j] / loads.limit[j] < 0.97  # at rest
        assert asked[borne, j].max(initial=0.0) < 0.98 + 1e-4
        slowed += 1
    assert slowed > 20


@pytest.mark.parametrize("soft", [False, True])
def test_an_arm_that_hardly_bears_its_load_is_not_asked_for_more_anywhere(soft: bool) -> None:
    """Between 64 places weight took what motion was given at them: up to 8 % above the limit of a Stäubli TX2-90."""
    loads, pick = arm_with(16.0, "staubli_tx2_90"), np.random.default_rng(7)
    joints, slowed = loads.chain.driven_joints, 0
    if soft:
        joints = replace(joints, jerk=np.full(6, 50.0))
    for _ in range(40):
        start, end = (pick.uniform(np.maximum(joints.lower, -3.1), np.minimum(joints.upper, 3.1)) for _ in range(2))
        own, why = JointMove.between(start, end, joints).within(loads, 1)
        way, t = end - start, np.linspace(0.0, own.duration, 3001)
        share, rate, change = own.law_at(t)
        q, tool = start + share[:, None] * way, np.ones(len(t), dtype=np.int64)
        asked = np.abs(*loads.efforts(tool, q, (rate[:, None] * way, change[:, None] * way))) / loads.limit
        borne = np.abs(*loads.efforts(tool, q, (0.0, 0.0))) / loads.limit < 0.97
        assert asked[borne].max() < 0.99
        slowed += why is not None
    assert slowed > 20
