"""Closed forms: every branch is a solution, every solution a branch; paths stay on theirs, reasons have numbers."""

import math

import numpy as np
import pytest
from arms import chain, machine, random_joints, wrapped

from gcodesim.kinematics import MODELS, ParallelAxes, SerialArm, SphericalWrist, Status, load_urdf
from gcodesim.units import DEG

ARMS = sorted(name for name in MODELS if MODELS[name].kind == "arm")


def swing(name, count=400, size=0.4):
    """A smooth joint path (count, 6) from home."""
    s = np.linspace(0.0, 1.0, count)[:, None]
    return np.array(MODELS[name].home) + size * np.sin(s * np.array([2, 4, 6, 8, 10, 12.0]))


@pytest.mark.parametrize("name", ARMS)
def test_arm_is_recognised(name):
    assert isinstance(machine(name), ParallelAxes if name == "ur10e" else SphericalWrist)


@pytest.mark.parametrize("name", ARMS)
def test_all_branches_reach_the_pose_and_the_joints_are_among_them(name):
    k = machine(name)
    for q in random_joints(k.joints, 150, seed=5):
        X = k.forward(q)[0]
        branches = k.branches(X)
        assert k.forward(branches) == pytest.approx(np.broadcast_to(X, (len(branches), 4, 4)), abs=1e-9)
        assert np.abs(wrapped(branches - q)).max(axis=1).min() < 1e-8


@pytest.mark.parametrize("name", ARMS)
def test_eight_branches_differ(name):
    k = machine(name)
    branches = k.branches(k.forward(np.array(MODELS[name].home) + 0.1)[0])
    assert len(branches) == 8
    apart = [np.abs(wrapped(a - b)).max() for i, a in enumerate(branches) for b in branches[:i]]
    assert min(apart) > 0.01


@pytest.mark.parametrize("name", ARMS)
def test_path_gives_back_its_joints(name):
    k, q = machine(name), swing(name)
    found, status = k.inverse(k.forward(q), q[0])
    assert found == pytest.approx(q, abs=1e-9)
    assert set(status) <= {Status.OK, Status.SINGULAR}


@pytest.mark.parametrize("name", ARMS)
def test_every_row_alone_gives_the_same_joints(name):
    """Chunks of a path are solved like the whole."""
    k, q = machine(name), swing(name, 50)
    X = k.forward(q)
    whole, _ = k.inverse(X, q[0])
    first, _ = k.inverse(X[:20], q[0])
    second, _ = k.inverse(X[20:], first[-1], on_path=True)
    assert np.array_equal(np.vstack([first, second]), whole)


@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "staubli_tx2_90", "ur10e"])
def test_numeric_twin_agrees(name):
    k, q = machine(name), swing(name, 100)
    X = k.forward(q)
    found, status = SerialArm(chain=chain(name)).inverse(X, q[0])
    assert found == pytest.approx(k.inverse(X, q[0])[0], abs=1e-8)
    assert not np.isin(status, [Status.REACH, Status.LIMIT]).any()


def test_joint_six_winds_up_to_its_limit_and_no_further():
    """Two turns of the flange about its own axis from zero: up to 350 deg the joint may follow; it never unwinds."""
    k, home = machine("kuka_kr10_r1100_2"), np.array(MODELS["kuka_kr10_r1100_2"].home)
    q = np.tile(home, (721, 1))
    q[:, 5] = np.arange(721) * DEG
    found, status = k.inverse(k.forward(q), home)
    assert found == pytest.approx(q, abs=1e-9)
    assert np.array_equal(status == Status.LIMIT, np.arange(721) > 350)
    reason = k.reason(k.forward(q)[351], found[350], Status.LIMIT)
    assert reason.joint == 5 and reason.value == pytest.approx(351 * DEG) and reason.limit == pytest.approx(350 * DEG)


def test_a_new_path_begins_within_limits():
    """351 deg of joint 6 as the first pose of a path: some other solution within limits."""
    k, q = machine("kuka_kr10_r1100_2"), np.array(MODELS["kuka_kr10_r1100_2"].home)
    q[5] = 351 * DEG
    X = k.forward(q)
    found, status = k.inverse(X, q)
    assert status[0] == Status.OK and k.forward(found) == pytest.approx(X, abs=1e-9)
    assert np.all((found >= k.joints.lower) & (found <= k.joints.upper))
    assert k.inverse(X, q, on_path=True)[1][0] == Status.LIMIT


def test_a_jump_to_another_branch_is_a_flip():
    """From 150 to 178 deg of joint 1 in one step: beyond its limit, and reached only with the arm bent backwards."""
    k, q = machine("kuka_kr10_r1100_2"), np.array(MODELS["kuka_kr10_r1100_2"].home)
    path = np.array([q, q])
    path[:, 0] = np.array([150, 178]) * DEG
    X = k.forward(path)
    found, status = k.inverse(X, path[0])
    assert list(status) == [Status.OK, Status.FLIP]
    assert np.all((found[1] >= k.joints.lower) & (found[1] <= k.joints.upper))
    assert k.forward(found) == pytest.approx(X, abs=1e-9)
    reason = k.reason(X[1], found[0], Status.FLIP)
    assert reason.value == pytest.approx(np.abs(found[1] - found[0]).max())
    assert reason.what == f"jump of {k.joints.names[reason.joint]}"


def test_far_pose_is_out_of_reach_with_both_distances():
    """The KR 10's upper arm is 560 mm, its forearm 515 mm with 25 mm offset: 1.0756 m from joint 2."""
    k, home = machine("kuka_kr10_r1100_2"), np.array(MODELS["kuka_kr10_r1100_2"].home)
    X = k.forward(home)
    X[0, :3, 3] = [1.2, 0.0, 0.2]
    q, status = k.inverse(X, home)
    assert status[0] == Status.REACH and q[0] == pytest.approx(home)
    reason = k.reason(X[0], home, Status.REACH)
    assert reason.what == "wrist centre distance from joint 2"
    assert reason.limit == pytest.approx(0.56 + math.hypot(0.515, 0.025))
    assert reason.value == pytest.approx(math.hypot(1.2 - 0.025, 0.2 + 0.09 - 0.4))


def test_pose_too_near_to_the_first_axis_of_an_offset_arm():
    k, home = machine("staubli_tx2_90"), np.array(MODELS["staubli_tx2_90"].home)
    X = k.forward(home)
    X[0, :3, 3] = [0.02, 0.0, 0.3]
    assert k.inverse(X, home)[1][0] == Status.REACH
    reason = k.reason(X[0], home, Status.REACH)
    assert (reason.what, reason.value, reason.limit) == (
        "wrist centre distance from axis 1",
        pytest.approx(0.02),
        pytest.approx(0.05),
    )


def test_reach_of_a_parallel_axes_arm():
    k, home = machine("ur10e"), np.array(MODELS["ur10e"].home)
    X = k.forward(home)
    X[0, 0, 3] -= 1.0
    assert k.inverse(X, home)[1][0] == Status.REACH
    reason = k.reason(X[0], home, Status.REACH)
    assert reason.limit == pytest.approx(0.6127 + 0.57155)
    assert reason.value > reason.limit


def test_joint_limit_is_told_with_joint_and_angle():
    """Joint 1 of the KR 10 turned on beyond 170 deg: a control would stop there, whatever other branches could do."""
    k, home = machine("kuka_kr10_r1100_2"), np.array(MODELS["kuka_kr10_r1100_2"].home)
    q = np.tile(home, (40, 1))
    q[:, 0] = np.linspace(160, 179.5, 40) * DEG
    X = k.forward(q)
    found, status = k.inverse(X, q[0])
    outside = q[:, 0] > 170 * DEG + 1e-9
    assert np.all(status[outside] == Status.LIMIT) and np.all(status[~outside] == Status.OK)
    assert found == pytest.approx(q, abs=1e-9)
    reason = k.reason(X[-1], found[-2], Status.LIMIT)
    assert (reason.what, reason.joint) == ("joint_1", 0)
    assert (reason.value, reason.limit) == (pytest.approx(179.5 * DEG), pytest.approx(170 * DEG))


@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "ur10e"])
def test_wrist_singularity_keeps_the_free_joint_and_is_told(name):
    k, q = machine(name), np.array(MODELS[name].home) + 0.1
    q[4] = 0.0  # axes 4 and 6 (UR: 2 and 6) in line
    X = k.forward(q)
    found, status = k.inverse(X, q)
    assert status[0] == Status.SINGULAR
    assert found[0] == pytest.approx(q, abs=1e-9)
    reason = k.reason(X[0], q, Status.SINGULAR)
    assert reason.joint == 4 and reason.value < 1e-6 and "axes" in reason.what


@pytest.mark.parametrize("name", ["kuka_kr10_r1100_2", "ur10e"])
@pytest.mark.parametrize("bend", [1e-4, 1e-6, 1e-8, 1e-9, 1e-11, 0.0])
def test_pose_stays_exact_however_near_the_wrist_is_to_singular(name, bend):
    k, q = machine(name), np.array(MODELS[name].home) + 0.1
    q[4] = bend
    X = k.forward(q)
    assert k.forward(k.inverse(X, q)[0]) == pytest.approx(X, abs=1e-9)


def test_an_arm_turned_in_its_description_is_still_recognised(tmp_path):
    """Frames of a description may stand anyhow; only the axes count."""
    text = MODELS["kuka_kr10_r1100_2"].path.read_text()
    turned = text.replace('<origin xyz="0 0 0.4"/>', '<origin xyz="0.1 0.2 0.4" rpy="0.3 0.2 0.1"/>')
    turned = turned.replace('<origin xyz="0.515 0 0"/>', '<origin xyz="0.515 0 0" rpy="0 0.4 0"/>')
    assert turned.count("rpy") == text.count("rpy") + 2
    path = tmp_path / "turned.urdf"
    path.write_text(turned)
    k = SphericalWrist.of(load_urdf(path)[0])
    for q in random_joints(k.joints, 20, seed=6):
        X = k.forward(q)[0]
        assert np.abs(wrapped(k.branches(X) - q)).max(axis=1).min() < 1e-8


def test_an_arm_without_spherical_wrist_is_not_taken_for_one(tmp_path):
    text = MODELS["kuka_kr10_r1100_2"].path.read_text()
    path = tmp_path / "offset.urdf"
    path.write_text(
        text.replace('<origin xyz="0 0 0"/><axis xyz="-1 0 0"/>', '<origin xyz="0 0 0.05"/><axis xyz="-1 0 0"/>')
    )
    assert SphericalWrist.of(load_urdf(path)[0]) is None


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("step", [0.02, 0.3, 1.0])
def test_the_nearest_of_all_branches_is_taken_on_any_path(name, step):
    """Twin: all branches, each joint at its turn nearest to the row before, the least square distance within limits."""
    k = machine(name)
    rng = np.random.default_rng(18)
    compared = 0
    for q in random_joints(k.joints, 60, seed=19, margin=0.1):
        other = q + rng.uniform(-step, step, 6)
        X = np.concatenate([k.forward(q), k.forward(other)])
        found, status = k.inverse(X, q, on_path=True)
        if status[1] not in (Status.OK, Status.SINGULAR):
            continue
        branches = k.branches(X[1])
        turned = branches + 2 * np.pi * np.rint((q - branches) / (2 * np.pi))
        inside = np.all((turned >= k.joints.lower) & (turned <= k.joints.upper), axis=1)
        distances = np.sum((turned[inside] - q) ** 2, axis=1)
        assert np.sum((found[1] - q) ** 2) <= distances.min() + 1e-8
        compared += 1
    assert compared > 10
