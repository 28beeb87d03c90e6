"""Machine tools from models and from plain axis data."""

import numpy as np
import pytest
from arms import machine, machine_of, nose_on_table, random_joints

from gcodesim.kinematics import Axis, Cartesian, Status, kinematics_of
from gcodesim.kinematics.cartesian import chain_of_axes

XYZ = [Axis(letter=c, lower=-0.5, upper=0.5, speed=0.5, acceleration=2.0) for c in "XYZ"]


def test_plain_axes_make_the_same_machine_as_the_model():
    axes = [*XYZ, Axis(letter="A", point=(0.0, 0.020, -0.060)), Axis(letter="C", point=(0.0, 0.0, 0.0))]
    mill, own = machine("mill_xyzac_trunnion"), machine_of(axes)
    q = random_joints(mill.joints, 20, seed=11)
    assert own.joints.names == mill.joints.names == ("X", "Y", "Z", "A", "C")
    assert nose_on_table(own, q) == pytest.approx(nose_on_table(mill, q), abs=1e-12)


def test_trunnion_agrees_with_its_published_formula():
    """X, Y, Z = T(d) Rx(a) T(−d) Rz(c) p for a nose at p of the table, d the offset of the tilt axis."""
    mill = machine("mill_xyzac_trunnion")
    rng = np.random.default_rng(12)
    for _ in range(20):
        p, a, c = rng.uniform(-0.1, 0.1, 3), rng.uniform(-1, 1), rng.uniform(-9, 9)
        d = np.array([0.0, 0.020, -0.060])
        turned = np.array([p[0] * np.cos(c) - p[1] * np.sin(c), p[0] * np.sin(c) + p[1] * np.cos(c), p[2]]) - d
        x, y, z = (
            turned[0],
            turned[1] * np.cos(a) - turned[2] * np.sin(a),
            turned[1] * np.sin(a) + turned[2] * np.cos(a),
        )
        q = np.array([*(np.array([x, y, z]) + d), a, c])
        assert nose_on_table(mill, q)[0, :3, 3] == pytest.approx(p, abs=1e-12)


def test_spindle_points_down_at_machine_zero():
    X = machine_of(XYZ).forward([0.0, 0.0, 0.0])[0]
    assert pytest.approx(np.diag([1.0, -1.0, -1.0, 1.0]), abs=1e-15) == X


def test_inverse_gives_axis_values_and_limits():
    gantry = machine("gantry_xyz")
    q = np.array([[0.6, 0.4, -0.15], [1.3, 0.4, -0.15]])
    found, status = gantry.inverse(gantry.forward(q), np.zeros(3))
    assert found == pytest.approx(q, abs=1e-12)
    assert list(status) == [Status.OK, Status.LIMIT]
    reason = gantry.reason(gantry.forward(q)[1], q[0], Status.LIMIT)
    assert (reason.what, reason.value, reason.limit, reason.unit) == ("X", pytest.approx(1.3), pytest.approx(1.2), "m")


def test_head_that_cannot_turn_is_out_of_reach():
    gantry = machine("gantry_xyz")
    X = gantry.forward([0.6, 0.4, -0.15])
    X[0, :3, :3] = np.eye(3)
    found, status = gantry.inverse(X, np.array([0.1, 0.2, -0.1]))
    assert status[0] == Status.REACH and found[0] == pytest.approx([0.1, 0.2, -0.1])
    assert gantry.reason(X[0], found[0], Status.REACH).value == pytest.approx(np.pi)
    assert len(gantry.branches(X[0])) == 0


def test_rotary_head_is_solved_numerically():
    axes = [*XYZ, *(Axis(letter=c, side="tool", point=(0, 0, 0.1), lower=-1.5, upper=1.5) for c in "CB")]
    head = machine_of(axes)
    q = np.array([[0.05, -0.03, 0.12, 0.3, 0.2], [0.06, -0.03, 0.12, 0.31, 0.22]])
    found, status = head.inverse(head.forward(q), q[0] * 0.9)
    assert found == pytest.approx(q, abs=1e-9) and list(status) == [Status.OK, Status.OK]


def test_axes_keep_the_order_of_the_chain():
    lathe = machine_of([Axis(letter="Z"), Axis(letter="X")])
    assert lathe.joints.names == ("Z", "X")


def test_table_axes_turn_the_table_and_not_the_spindle():
    own = machine_of([*XYZ, Axis(letter="C", point=(0.1, 0.0, 0.0))])
    X = own.table([0.0, 0.0, 0.0, np.pi / 2])[0]
    assert X[:3, :3] @ [1, 0, 0] == pytest.approx([0, 1, 0])
    assert pytest.approx([0.1, 0, 0, 1]) == X @ [0.1, 0, 0, 1]
    assert own.forward([0, 0, 0, 1.0]) == pytest.approx(own.forward([0, 0, 0, 0]))


def test_limits_of_plain_axes():
    joints = machine_of([Axis(letter="X", lower=-1, upper=2, speed=0.5, effort=900)]).joints
    assert (joints.lower[0], joints.upper[0], joints.effort[0]) == (-1, 2, 900)
    assert joints.acceleration[0] == pytest.approx(2.0) and joints.assumed_acceleration[0]


@pytest.mark.parametrize("letters", ["XX", "U"])
def test_unknown_or_repeated_letters_are_our_fault(letters):
    with pytest.raises(ValueError, match="at most once"):
        chain_of_axes([Axis(letter=c) for c in letters])


def test_machine_is_recognised_from_its_joint_names():
    assert isinstance(kinematics_of(chain_of_axes(XYZ)), Cartesian)
