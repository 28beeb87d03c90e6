"""Linear axes under the work, and rotary axes whose place nobody knows."""

from __future__ import annotations

import numpy as np
import pytest
from arms import machine_of, nose_on_table

from gcodesim.kinematics import Axis


@pytest.mark.parametrize("on_table", ["", "X", "Y", "Z", "XY", "XYZ"])
def test_the_work_sees_the_same_motion_whichever_side_moves(on_table):
    machine = machine_of([Axis(letter=c, side="table" if c in on_table else "tool") for c in "XYZ"])
    axes = np.array([[0.1, 0.2, -0.3], [-0.05, 0.02, 0.01]])
    q = axes[:, ["XYZ".index(name) for name in machine.joints.names]]
    assert nose_on_table(machine, q)[:, :3, 3] == pytest.approx(axes, abs=1e-15)
    carried = np.where([c in on_table for c in "XYZ"], -axes, 0.0)
    assert machine.table_travel(q) == pytest.approx(carried, abs=1e-15)


def test_a_rotary_axis_without_a_place_turns_nothing():
    machine = machine_of([*(Axis(letter=c) for c in "XYZ"), Axis(letter="A"), Axis(letter="C", side="tool")])
    q = np.array([[0.1, 0.2, -0.3, 1.0, 0.5]])
    assert machine.table(q)[0] == pytest.approx(np.eye(4))
    assert machine.forward(q)[0] == pytest.approx(machine.forward([[0.1, 0.2, -0.3, 0.0, 0.0]])[0])


def test_travel_of_a_table_leaves_its_turns_out():
    axes = [Axis(letter="X", side="table"), Axis(letter="Z"), Axis(letter="A", point=(0.0, 0.0, -0.1))]
    machine = machine_of(axes)
    assert machine.joints.names == ("Z", "X", "A")
    assert machine.table_travel(np.array([[0.3, 0.2, 1.0]]))[0] == pytest.approx([-0.2, 0.0, 0.0])
