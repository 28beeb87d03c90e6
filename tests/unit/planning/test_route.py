"""Paths that one spin and the configuration near home do not lead through: another way is found, or the reason."""

import numpy as np
import pytest

from gcodesim.canon import LinearFeed, Rapid
from gcodesim.diagnostics import Span
from gcodesim.kinematics import MODELS
from gcodesim.kinematics.branch_names import branches_named, names_of
from gcodesim.motion import build_tool_path
from gcodesim.planning import FixedAttitude, plan_path
from tests.configuration_cases import kinematics_for

DT = 2e-3


def around(name, turns, *, radius=0.6, start=0.0, spin=None, branches=None, feed=0.1, chords=90, tiny=0):
    """The plan of a way around the foot of an arm, `turns` times; the first chord in so many `tiny` ones."""
    robot, home = kinematics_for(name), np.array(MODELS[name].home)
    angle = np.linspace(0.0, 2.0 * np.pi * turns, int(chords * turns) + 1)
    angle = start + np.concatenate([np.linspace(0.0, angle[1], tiny, endpoint=False), angle[bool(tiny) :]])
    points = [(radius * np.cos(a), radius * np.sin(a), 0.2, 0.0, 0.0, 0.0) for a in angle]
    events = [Rapid(span=Span("t", 1, 1, 1, 2), block=1, end=points[0], word="G0", home="")]
    for number, end in enumerate(points[1:], start=2):
        span = Span("t", number, 1, number, 2)
        events.append(LinearFeed(span=span, block=number, end=end, feed=feed, word="G1"))
    posing = FixedAttitude(spin=spin, branches=branches)
    path = build_tool_path(events, posing.start(robot, home))
    return plan_path(path, robot, posing, home=home)


def sampled(plan):
    samples = plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, DT))
    q = plan.joints(samples)
    return samples, q, plan.kinematics.forward(q)


def codes(plan):
    return [f.code for f in plan.findings if f.code not in ("GS204", "GS206")]


@pytest.fixture(scope="module")
def twice():
    """The UR10e nearly twice around its foot, which needs all of joint 1 and a tool that does not turn with it."""
    return around("ur10e", 1.8)


def test_a_free_tool_turns_along_the_path(twice):
    assert codes(twice) == ["GS215"]
    samples, q, X = sampled(twice)
    joints = twice.kinematics.joints
    assert (q > joints.lower).all() and (q < joints.upper).all()
    cut = samples.piece >= 1
    assert np.abs(X[cut, :3, 3] - samples.position[cut, :3]).max() < 1e-8
    assert np.abs(X[cut, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-9
    spin = np.unwrap(np.arctan2(-X[cut, 1, 0], X[cut, 0, 0]))
    assert np.ptp(spin) > 1.0
    assert np.ptp(q[cut, 0]) == pytest.approx(1.8 * 2.0 * np.pi, abs=0.4)


def test_a_turning_tool_keeps_speed_and_acceleration_of_joints(twice):
    _, q, _ = sampled(twice)
    joints = twice.kinematics.joints
    speed, acceleration = np.abs(np.diff(q, axis=0)) / DT, np.abs(np.diff(q, 2, axis=0)) / DT**2
    assert (speed.max(axis=0) <= 1.001 * joints.speed).all()
    assert (acceleration.max(axis=0) <= 1.02 * joints.acceleration).all()


def test_windows_of_a_turning_tool_give_the_same_joints_as_the_whole(twice):
    samples, q, _ = sampled(twice)
    half = len(q) // 2
    rest = twice.trajectory.sample(np.arange(len(q))[half:] * DT)
    assert np.abs(twice.joints(rest) - q[half:]).max() < 1e-9
    assert len(samples) == len(q)


def test_a_few_places_of_a_turning_tool_give_the_same_joints_as_the_whole(twice):
    """Collision checks ask for joints where stretches are bent; what lies between is left out."""
    _, q, _ = sampled(twice)
    for every in (1000, 12_000, 15_000):
        few = twice.trajectory.sample(np.arange(0, len(q), every) * DT)
        assert np.abs(twice.joints(few) - q[::every]).max() < 1e-9


def test_the_same_path_gives_the_same_bits(twice):
    assert sampled(around("ur10e", 1.8))[1].tobytes() == sampled(twice)[1].tobytes()


def test_what_needs_no_search_is_not_searched():
    plan = around("kuka_kr10_r1100_2", 0.3, radius=0.5)
    assert codes(plan) == []
    assert plan.joint_path.flange.turning is None


@pytest.fixture(scope="module")
def too_far_around():
    """An arm that cannot turn as often as the path does."""
    return around("ur10e", 2.3, chords=30)


def test_where_nothing_leads_through_the_longest_part_and_the_reason_are_named_once(too_far_around):
    plan = too_far_around
    assert codes(plan) == ["GS216"]
    (found,) = [f for f in plan.findings if f.code == "GS216"]
    assert 0.8 < found.value < 0.95  # joint 1 has two turns, the path 2.3
    assert "of lines 1 to 70 can be run, from line 1 to " in found.message
    assert "no continuous way leads on (" in found.message


def test_a_part_is_a_share_of_the_way_not_of_its_nodes(too_far_around):
    """The same ring with many nodes in its first chord."""
    crowded = around("ur10e", 2.3, chords=30, tiny=150)
    shares = [next(f for f in plan.findings if f.code == "GS216").value for plan in (too_far_around, crowded)]
    assert shares[0] == pytest.approx(shares[1], abs=0.02)


def test_out_of_reach_is_the_reason_where_it_is():
    plan = around("kuka_kr10_r1100_2", 0.2, radius=1.6)
    assert codes(plan) == ["GS202"]
    assert "nothing of lines 1 to 19 can be run; " in next(iter(plan.findings)).hint


@pytest.mark.parametrize(
    ("name", "words"),
    [("ur10e", ("down",)), ("kuka_kr10_r1100_2", ("flip",)), ("abb_irb1200_5_90", ("front", "up", "flip"))],
)
def test_a_pinned_configuration_is_kept(name, words):
    robot = kinematics_for(name)
    plan = around(name, 0.2, radius=0.6, branches=branches_named(robot.arm, words))
    assert "GS216" not in codes(plan)
    q = plan.joint_path.q_nodes
    for row in q[:: max(len(q) // 8, 1)]:
        assert set(words) <= set(names_of(robot.arm, robot._branch_of(row)))


def test_a_pin_that_is_kept_already_changes_nothing():
    robot = kinematics_for("kuka_kr10_r1100_2")
    free = around("kuka_kr10_r1100_2", 0.2, radius=0.6)
    pinned = around("kuka_kr10_r1100_2", 0.2, radius=0.6, branches=branches_named(robot.arm, ("up", "noflip", "front")))
    assert codes(pinned) == []
    assert pinned.joint_path.q_nodes.tobytes() == free.joint_path.q_nodes.tobytes()


def test_a_given_spin_stays_while_turns_of_joints_are_searched():
    """From home joint 1 would pass its limit; a turn back it does not."""
    free = around("ur10e", 1.2, start=np.pi)
    pinned = around("ur10e", 1.2, start=np.pi, spin=0.3)
    for plan in (free, pinned):
        assert "GS203" not in codes(plan)
    _, _, X = sampled(pinned)
    assert np.ptp(X[len(X) // 4 :, 0, 0]) < 1e-9
