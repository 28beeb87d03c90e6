"""Orientations as the controls of robots write them."""

from __future__ import annotations

from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import atan2, hypot
from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array, canonical_quaternion, quaternion_from_rotation
from gcodesim.units import DEG

_NOISE: Final = 1e-10  # of a component
_UPRIGHT: Final = 1e-12  # of the cosine of the middle angle, below which the outer two are one turn


def rpy_of(R: Array) -> tuple[float, float, float]:
    """Turns about the fixed X, Y, Z [deg] of a rotation (3, 3): W, P, R of Fanuc, and C, B, A of KUKA.

    Where Y stands at ±90°, X is 0.
    """
    R = _clean(R)
    level = float(hypot(R[0, 0], R[1, 0]))
    pitch = atan2(-float(R[2, 0]), level)
    if level < _UPRIGHT:
        return 0.0, pitch / DEG, atan2(-float(R[0, 1]), float(R[1, 1])) / DEG
    return (
        atan2(float(R[2, 1]), float(R[2, 2])) / DEG,
        pitch / DEG,
        atan2(float(R[1, 0]), float(R[0, 0])) / DEG,
    )


def rotation_vector(R: Array) -> tuple[float, float, float]:
    """The axis of a rotation (3, 3) times its angle [rad], which is at most half a turn: rx, ry, rz of UR."""
    q = quaternion(R)
    length = norm(q[:3])
    if length < 1e-15:
        return 0.0, 0.0, 0.0
    share = 2.0 * atan2(length, float(q[3])) / length
    return float(q[0]) * share, float(q[1]) * share, float(q[2]) * share


def half_turn() -> Array:
    """The rotation (3, 3) by half a turn about Z."""
    return np.diag([-1.0, -1.0, 1.0])


def quaternion(R: Array) -> Array:
    """The canonical quaternion (4,), x y z w, of a rotation (3, 3); rounding does not decide its sign."""
    q = quaternion_from_rotation(R)
    q[np.abs(q) < _NOISE] = 0.0
    return canonical_quaternion(q)


def _clean(R: Array) -> Array:
    """The same with zeros where only rounding is left, so that an angle of half a turn is always +180°."""
    return np.where(np.abs(R) < _NOISE, 0.0, R)
