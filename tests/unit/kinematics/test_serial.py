"""Numeric inverse kinematics: arms without closed form, of more and of fewer than six joints."""

import numpy as np
import pytest
from arms import chain, machine, random_joints, wrapped

from gcodesim.frames import rotation_about
from gcodesim.kinematics import MODELS, SerialArm, Status, kinematics_of, load_urdf
from gcodesim.kinematics.newton_kernels import pose_error, solve_square
from gcodesim.kinematics.serial import spread

LIMIT = '<limit lower="-2.8" upper="2.8" velocity="1" effort="1"/>'


def arm_of(tmp_path, rows):
    """An arm from rows of kind, offset, axis."""
    parts = ['<link name="l0"/>']
    for i, (kind, offset, axis) in enumerate(rows, start=1):
        parts.append(
            f'<link name="l{i}"/><joint name="j{i}" type="{kind}"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="{offset}"/><axis xyz="{axis}"/>{LIMIT}</joint>'
        )
    end = f'<link name="tool0"/><joint name="e" type="fixed"><parent link="l{len(rows)}"/><child link="tool0"/>'
    path = tmp_path / "arm.urdf"
    path.write_text("<robot name='r'>" + "".join(parts) + end + '<origin xyz="0.1 0 0.05"/></joint></robot>')
    return kinematics_of(load_urdf(path)[0])


OFFSET_WRIST = [
    ("revolute", "0 0 0.4", "0 0 1"),
    ("revolute", "0.05 0 0", "0 1 0"),
    ("revolute", "0 0 0.5", "0 1 0"),
    ("revolute", "0.2 0 0.05", "1 0 0"),
    ("revolute", "0.25 0 0.03", "0 1 0"),
    ("revolute", "0.06 0.04 0", "1 0 0"),
]
SEVEN = [*OFFSET_WRIST[:2], ("revolute", "0 0 0.25", "0 0 1"), *OFFSET_WRIST[2:]]
SCARA = [
    ("revolute", "0 0 0.4", "0 0 1"),
    ("revolute", "0.3 0 0", "0 0 1"),
    ("prismatic", "0.3 0 0", "0 0 1"),
    ("revolute", "0 0 0", "0 0 1"),
]


@pytest.mark.parametrize("rows", [OFFSET_WRIST, SEVEN, SCARA], ids=["offset wrist", "seven joints", "scara"])
def test_path_of_an_arm_without_closed_form(tmp_path, rows):
    k = arm_of(tmp_path, rows)
    assert type(k) is SerialArm
    s = np.linspace(0, 1, 300)[:, None]
    q = 0.3 + 0.4 * np.sin(s * np.arange(2, 2 + len(rows)))
    X = k.forward(q)
    found, status = k.inverse(X, q[0])
    assert np.all(status == Status.OK)
    assert k.forward(found) == pytest.approx(X, abs=1e-9)
    if len(rows) <= 6:
        assert found == pytest.approx(q, abs=1e-7)
    assert np.abs(np.diff(found, axis=0)).max() < 0.05


def test_search_finds_most_branches_that_the_closed_form_knows():
    k, numeric = machine("ur10e"), SerialArm(chain=chain("ur10e"))
    for q in random_joints(k.joints, 5, seed=7):
        X = k.forward(q)[0]
        exact, found = k.branches(X), numeric.branches(X)
        assert len(found) >= len(exact) - 1
        for row in found:
            assert np.abs(wrapped(exact - row)).max(axis=1).min() < 1e-6


def test_far_away_seed_still_finds_the_pose():
    numeric = SerialArm(chain=chain("kuka_kr10_r1100_2"))
    for q in random_joints(numeric.joints, 20, seed=8, margin=0.1):
        X = numeric.forward(q)
        found, status = numeric.inverse(X, np.array(MODELS["kuka_kr10_r1100_2"].home))
        assert status[0] == Status.OK
        assert numeric.forward(found) == pytest.approx(X, abs=1e-9)
        assert np.all(found <= numeric.joints.upper + 1e-9) and np.all(found >= numeric.joints.lower - 1e-9)


def test_out_of_reach_keeps_the_joints_and_comes_back():
    name = "kuka_kr10_r1100_2"
    numeric, home = SerialArm(chain=chain(name)), np.array(MODELS[name].home)
    X = np.tile(numeric.forward(home), (200, 1, 1))
    X[:, 0, 3] += 0.8 * np.sin(np.linspace(0, np.pi, 200))
    found, status = numeric.inverse(X, home)
    exact = machine(name).inverse(X, home)[1]
    assert np.array_equal(status == Status.REACH, exact == Status.REACH)
    assert 0 < np.count_nonzero(exact == Status.REACH) < 200
    last = np.flatnonzero(exact == Status.REACH)[0] - 1
    assert found[last + 1] == pytest.approx(found[last])
    reason = numeric.reason(X[100], home, Status.REACH)
    assert reason.what == "flange distance from joint_1" and reason.value == pytest.approx(
        np.linalg.norm(X[100, :3, 3] - [0, 0, 0.4])
    )


def test_limit_is_told_by_the_numeric_way_too():
    name = "kuka_kr10_r1100_2"
    numeric, home = SerialArm(chain=chain(name)), np.array(MODELS[name].home)
    q = np.tile(home, (40, 1))
    q[:, 0] = np.radians(np.linspace(160, 179.5, 40))
    found, status = numeric.inverse(numeric.forward(q), q[0])
    assert np.array_equal(status == Status.LIMIT, q[:, 0] > np.radians(170) + 1e-9)
    assert found == pytest.approx(q, abs=1e-8)


def test_pose_error_is_the_rotation_vector():
    rng = np.random.default_rng(9)
    for angle in (0.0, 1e-12, 1e-6, 0.5, 3.0, np.pi - 1e-7):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        X, target, e = np.eye(4), np.eye(4), np.empty(6)
        X[:3, :3] = rotation_about(np.array([0.6, 0.0, 0.8]), 1.0)
        target[:3, :3] = rotation_about(axis, angle) @ X[:3, :3]
        target[:3, 3] = [1, 2, 3]
        pose_error(X, target, e)
        assert e == pytest.approx([1, 2, 3, *(angle * axis)], abs=1e-7 if angle > 3.1 else 1e-12)


def test_square_systems_are_solved():
    rng = np.random.default_rng(10)
    A = rng.normal(size=(6, 6))
    A = A @ A.T + np.eye(6)
    x = rng.normal(size=6)
    y = x.copy()
    pivot = solve_square(A.copy(), y)
    assert A @ y == pytest.approx(x)
    assert 0.0 < pivot <= 1.0


def test_starts_are_spread_over_the_box():
    points = spread(np.array([0.0, -1.0]), np.array([1.0, 3.0]), 64)
    assert points.min(axis=0) == pytest.approx([0, -1], abs=0.1)
    assert points.max(axis=0) == pytest.approx([1, 3], abs=0.1)
    assert points.mean(axis=0) == pytest.approx([0.5, 1.0], abs=0.1)


def test_a_path_that_leads_on_exactly_still_says_where_the_arm_is_singular():
    """Joints run evenly through a straight wrist: each row is where the two before it lead."""
    arm = SerialArm(chain=load_urdf(MODELS["kuka_kr10_r1100_2"].path)[0])
    q = np.array([0.2, -1.2, 1.3, 0.3, 0.0, 0.1]) + np.linspace(-8, 8, 17)[:, None] * [1e-3, 2e-3, -1e-3, 0, 4e-3, 0]
    found, status = arm.inverse(arm.forward(q), q[0])
    assert found[:8] == pytest.approx(q[:8], abs=1e-9)
    assert status[8] == Status.SINGULAR and set(status[:8]) == {Status.OK}


def test_a_path_that_turns_back_and_one_that_stands_are_followed():
    arm = SerialArm(chain=load_urdf(MODELS["ur10e"].path)[0])
    s = np.concatenate([np.linspace(0.0, 0.5, 6), np.linspace(0.4, 0.0, 5), np.zeros(4)])
    q = np.array(MODELS["ur10e"].home) + s[:, None] * np.array([0.5, 0.4, -0.5, 0.3, 0.5, 0.6])
    found, status = arm.inverse(arm.forward(q), q[0])
    assert (status == Status.OK).all()
    assert found == pytest.approx(q, abs=1e-8)
    assert (found[-1] == found[-2]).all()
