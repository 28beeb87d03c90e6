"""Moves in joint space: closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.kinematics import Axis, chain_of_axes, kinematics_of
from gcodesim.planning import joint_moves

JOINTS = kinematics_of(
    chain_of_axes(
        [Axis(letter="X", speed=1.0, acceleration=2.0), Axis(letter="Y", speed=0.5, acceleration=4.0), Axis(letter="Z")]
    )
).joints


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
    assert joint_moves.duration(np.array(step), JOINTS) == pytest.approx(expected)


@pytest.mark.parametrize("step", [(1.0, -0.3, 0.0), (0.01, 0.02, 0.0)])
def test_all_joints_keep_their_limits_and_arrive(step: tuple[float, ...]) -> None:
    way = np.array(step)
    total = joint_moves.duration(way, JOINTS)
    t = np.linspace(-0.1, total + 0.1, 4001)

    q = joint_moves.share_at(t, *joint_moves.law(way, JOINTS))[:, None] * way

    dt = t[1] - t[0]
    speed = np.diff(q, axis=0) / dt
    acceleration = np.diff(speed, axis=0) / dt
    assert np.allclose(q[0], 0.0) and np.allclose(q[-1], way)
    assert np.all(np.abs(speed).max(axis=0)[:2] <= JOINTS.speed[:2] * 1.0001)
    assert np.all(np.abs(acceleration).max(axis=0)[:2] <= JOINTS.acceleration[:2] * 1.0001)
