"""Moves in joint space: all joints start and stop together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.frames import Array

if TYPE_CHECKING:
    from gcodesim.kinematics.chain import Joints

STILL: Final = 1e-12  # [rad, m] of a joint that does not move
SHORTEST: Final = 1e-9  # [s] of a move on which nothing moves: a nanosecond


def law(step: Array, joints: Joints) -> tuple[float, float]:
    """Speed [1/s] and acceleration [1/s²] that the slowest joint allows for the share of a move by `step` (j,)."""
    way = np.abs(step)
    moving = way > STILL
    if not moving.any():
        return 1.0, 1.0
    speed = np.minimum(joints.speed, 1e6)[moving] / way[moving]
    acceleration = np.minimum(joints.acceleration, 1e6)[moving] / way[moving]
    return float(speed.min()), float(acceleration.min())


def duration(step: Array, joints: Joints) -> float:
    """Time [s] of a move by `step` (j,) from rest to rest; 0 when nothing moves."""
    if not np.any(np.abs(step) > STILL):
        return 0.0
    speed, acceleration = law(step, joints)
    if speed * speed >= acceleration:
        return float(2.0 / np.sqrt(acceleration))
    return 1.0 / speed + speed / acceleration


def share_at(t: Array, speed: float, acceleration: float) -> Array:
    """Share 0…1 of a move that is done at times `t` (n,) [s]: a trapezoid of speed."""
    ramp = min(speed / acceleration, 1.0 / np.sqrt(acceleration))
    top = acceleration * ramp
    total = 1.0 / top + ramp
    t = np.clip(t, 0.0, total)
    left = total - t
    up, down = 0.5 * acceleration * (t * t), 1.0 - 0.5 * acceleration * (left * left)
    share: Array = np.where(t < ramp, up, np.where(left < ramp, down, top * (t - 0.5 * ramp)))
    return share
