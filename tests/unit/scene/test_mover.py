"""What a run asks about the machine or robot that its program moves."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.frames import Pose
from gcodesim.kinematics import MODELS, Axis, Cartesian, kinematics_of, load_urdf
from gcodesim.kinematics.cartesian import chain_of_axes
from gcodesim.scene import WORK, Mover


def mill(*axes: Axis) -> Mover:
    return Mover(
        name="machine",
        kinematics=Cartesian(chain=chain_of_axes(axes)),
        X_WB=Pose.identity(),
        home=np.zeros(len(axes)),
        joints_are_axes=True,
    )


@pytest.mark.parametrize(
    ("axis", "moves", "shifts"),
    [
        (Axis(letter="X"), False, False),
        (Axis(letter="X", side="table"), True, True),
        (Axis(letter="C", point=(0.0, 0.0, 0.0)), True, False),
        (Axis(letter="C"), False, False),  # nobody knows where it turns
    ],
)
def test_which_axes_carry_the_work(axis: Axis, moves: bool, shifts: bool) -> None:
    mover = mill(axis, Axis(letter="Z"))

    assert mover.moves(WORK) == moves
    assert mover.shifts_work == shifts


def test_an_arm_carries_no_work() -> None:
    chain, _ = load_urdf(MODELS["ur10e"].path)
    assert chain is not None
    arm = Mover(name="arm", kinematics=kinematics_of(chain), X_WB=Pose.identity(), home=np.zeros(6))

    assert not arm.moves(WORK)
    assert not arm.shifts_work
    assert arm.moves("flange")
