"""Arms of few joints whose tools may turn about themselves: origin and Z of the flange count, and nothing else."""

import dataclasses

import numpy as np
import pytest

from gcodesim.canon import LinearFeed, Rapid
from gcodesim.diagnostics import Span
from gcodesim.frames import Pose
from gcodesim.kinematics import Chain, Joint, Link, kinematics_of, load_urdf, model_path
from gcodesim.kinematics.pointing import PointingArm
from gcodesim.kinematics.protocol import Status
from gcodesim.motion import build_tool_path
from gcodesim.planning import FixedAttitude, plan_path
from gcodesim.planning.reach import why

DT = 2e-3


def kr10_without_its_last_joint():
    chain, _ = load_urdf(model_path("kuka_kr10_r1100_2"))
    last = chain.joints[chain.driven[-1]]
    joints = tuple(dataclasses.replace(j, kind="fixed") if j is last else j for j in chain.joints)
    return kinematics_of(dataclasses.replace(chain, joints=joints, driven=chain.driven[:-1]))


def arm_of_axes(*axes):
    """Joints about or along `axes`, each 0.3 m along X and Z of the one before, flange turned by a quarter about Y."""
    links = [Link(name="base"), *(Link(name=f"link_{k}") for k in range(len(axes))), Link(name="tool0")]
    joints = []
    for k, (kind, axis) in enumerate(axes):
        X = Pose(np.array([0.1 * k, 0.0, 0.3]), np.eye(3)).matrix
        travel = 1.0 if kind == "prismatic" else 3.0
        joints.append(
            Joint(
                name=f"joint_{k + 1}",
                kind=kind,
                parent=links[k].name,
                child=links[k + 1].name,
                X=X,
                axis=np.array(axis, dtype=float),
                lower=-travel,
                upper=travel,
                speed=2.0,
            )
        )
    R = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    end = Pose(np.array([0.0, 0.0, 0.2]), R).matrix
    joints.append(Joint(name="end", kind="fixed", parent=links[-2].name, child="tool0", X=end))
    chain = Chain(name="arm", links=tuple(links), joints=tuple(joints), driven=tuple(range(len(axes))), flange="tool0")
    return kinematics_of(chain)


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
ARMS = {
    "kr10": kr10_without_its_last_joint,
    "yaw and three pitches": lambda: arm_of_axes(("revolute", Z), ("revolute", Y), ("revolute", Y), ("revolute", Y)),
    "two pitches, roll, pitch": lambda: arm_of_axes(
        ("revolute", Z), ("revolute", Y), ("revolute", Y), ("revolute", X), ("revolute", Y)
    ),
    "lift and two yaws": lambda: arm_of_axes(("prismatic", Z), ("revolute", Z), ("revolute", Z), ("revolute", Y)),
}


@pytest.fixture(params=ARMS.values(), ids=ARMS.keys())
def arm(request):
    return request.param()


def drawn(arm, count, seed):
    joints = arm.joints
    low, high = np.maximum(joints.lower, -2.0), np.minimum(joints.upper, 2.0)
    return np.random.default_rng(seed).uniform(low, high, (count, len(joints)))


def about_z(angles):
    X = np.tile(np.eye(4), (len(angles), 1, 1))
    X[:, 0, 0] = X[:, 1, 1] = np.cos(angles)
    X[:, 1, 0] = np.sin(angles)
    X[:, 0, 1] = -X[:, 1, 0]
    return X


def test_origin_and_axis_are_reached_whatever_the_spin_is(arm):
    pointing = PointingArm.of(arm)
    random = np.random.default_rng(5)
    for q in drawn(arm, 40, 3):
        wanted = arm.forward(q[None]) @ about_z(random.uniform(-3.0, 3.0, 1))
        found, status = pointing.inverse(wanted, q + random.uniform(-0.05, 0.05, len(q)))
        assert status[0] in (Status.OK, Status.SINGULAR)
        reached = arm.forward(found)
        assert np.abs(reached[0, :3, 3] - wanted[0, :3, 3]).max() < 1e-8
        assert np.abs(reached[0, :3, 2] - wanted[0, :3, 2]).max() < 1e-8


def test_a_way_is_followed_without_a_jump(arm):
    pointing = PointingArm.of(arm)
    begin, end = drawn(arm, 2, 11)
    share = np.linspace(0.0, 1.0, 400)[:, None]
    q = begin + 0.3 * share * (end - begin)
    wanted = arm.forward(q) @ about_z(40.0 * share[:, 0] ** 2 * 0.1)
    found, status = pointing.inverse(wanted, begin)
    assert np.isin(status, (Status.OK, Status.SINGULAR)).all()
    assert np.abs(np.diff(found, axis=0)).max() < 0.1
    assert np.abs(arm.forward(found)[:, :3, 2:] - wanted[:, :3, 2:]).max() < 1e-8


def test_the_jacobian_is_the_derivative_but_for_the_turn_about_z(arm):
    pointing = PointingArm.of(arm)
    for q in drawn(arm, 5, 8):
        J, z = pointing.jacobian(q[None])[0], arm.forward(q[None])[0, :3, 2]
        assert np.abs(J[3:].T @ z).max() < 1e-12
        for j in range(len(q)):
            step = np.zeros(len(q))
            step[j] = 1e-6
            ahead, behind = arm.forward((q + step)[None])[0], arm.forward((q - step)[None])[0]
            assert np.abs((ahead - behind)[:3, 3] / 2e-6 - J[:3, j]).max() < 1e-6
            assert np.abs((ahead - behind)[:3, 2] / 2e-6 - np.cross(J[3:, j], z)).max() < 1e-6


def test_arms_that_turn_their_flange_themselves_are_left_as_they_are():
    chain, _ = load_urdf(model_path("kuka_kr10_r1100_2"))
    assert PointingArm.of(kinematics_of(chain)) is None
    assert PointingArm.of(arm_of_axes(("revolute", Z), ("revolute", Y), ("revolute", Y), ("revolute", X))) is not None
    assert PointingArm.of(arm_of_axes(("revolute", Z), ("revolute", Y), ("revolute", X))) is not None


def square(robot, home, spin=None):
    """The plan of a square of 0.1 m, 0.65 m before an arm."""
    posing = FixedAttitude(spin=spin)
    corners = [(0.6, -0.05), (0.7, -0.05), (0.7, 0.05), (0.6, 0.05), (0.6, -0.05)]
    points = [(x, y, 0.3, 0.0, 0.0, 0.0) for x, y in corners]
    events = [Rapid(span=Span("t", 1, 1, 1, 2), block=1, end=points[0], word="G0", home="")]
    for number, end in enumerate(points[1:], start=2):
        span = Span("t", number, 1, number, 2)
        events.append(LinearFeed(span=span, block=number, end=end, feed=0.1, word="G1"))
    path = build_tool_path(events, posing.start(robot, home))
    return plan_path(path, robot, posing, home=home)


def test_five_joints_run_a_program_whose_spin_is_free():
    robot, home = kr10_without_its_last_joint(), np.radians([0.0, -90.0, 90.0, 0.0, 90.0])
    plan = square(robot, home)
    assert not plan.findings
    samples = plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, DT))
    q = plan.joints(samples)
    cut, X = samples.piece >= 1, robot.forward(q)
    assert np.abs(X[cut, :3, 3] - samples.position[cut, :3]).max() < 1e-8
    assert np.abs(X[cut, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-8
    joints = robot.joints
    assert (q >= joints.lower).all() and (q <= joints.upper).all()
    assert (np.abs(np.diff(q, axis=0)).max(axis=0) / DT <= 1.001 * joints.speed).all()
    assert (np.abs(np.diff(q, 2, axis=0)).max(axis=0) / DT**2 <= 1.02 * joints.acceleration).all()
    assert plan.trajectory.duration < 10.0


def test_a_spin_that_is_asked_for_is_out_of_reach_of_five_joints():
    robot, home = kr10_without_its_last_joint(), np.radians([0.0, -90.0, 90.0, 0.0, 90.0])
    found = square(robot, home, spin=1.0).findings
    assert "GS202" in [f.code for f in found]


def test_what_cannot_turn_is_not_said_to_turn_too_little():
    lift = arm_of_axes(("prismatic", Z))
    X = lift.forward(np.zeros((1, 1)))[0]
    X[0, 3] += 0.1
    reason = PointingArm.of(lift).reason(X, np.zeros(1), Status.REACH)
    assert why(lift, dataclasses.replace(reason, what=None)).endswith("so at this place; none of them turns it")
