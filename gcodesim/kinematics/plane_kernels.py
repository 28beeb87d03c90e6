"""Compiled steps that closed forms share: the arm seen in its own plane frame P, Z along axis 1, Y along axis 2.

In the plane a turn about Y multiplies the complex number z + i x by exp(i angle).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.arithmetic.atan_kernels import acos, atan2
from gcodesim.arithmetic.sin_kernels import cos, cos_sin, sin
from gcodesim.compiled import kernel
from gcodesim.frames import Array

REACH_SLACK = 1e-9  # [m] beyond the reach that still count as stretched out: rounding, not distance
NEAR = 1e-6  # [rad] of wrist and elbow, [m] of the shoulder from singular: joint speeds are unbounded in practice
LOCK = 1e-10  # [rad], [m] from singular: the free joint keeps its last value, the pose errs by no more than this
EXISTS, SHOULDER, ELBOW, WRIST = 1, 2, 4, 8  # flags of a branch: it exists, and which part of it is singular


class PlaneArm(NamedTuple):
    """Geometry of an arm in the plane of axes 2 and 3; lengths [m], angles [rad].

    p_BP (3,) is the origin of P, p_FC (3,) the centre, where the last axes meet; `x2` is x of joint 2 in P and
    `lateral` the offset of the centre along Y. Vectors z, x lead from joint 2 to 3 (`upper`), from joint 3 to the
    next point of the plane (`fore`) and, where there is a third link in it, from joint 4 to the centre (`last`); the
    lengths are those of the two long links. `sign3`, `sign4` are +1 where the axis points along axis 2, `zero6` is
    the angle of axis 6 at zero, and `straight` the turn of joint 3 from zero to straight.
    R_PB, R_EP, R_FE (3, 3); E belongs to the axes of the wrist, see `solve` of the family.
    """

    p_BP: Array
    p_FC: Array
    x2: float
    lateral: float
    upper_z: float
    upper_x: float
    fore_z: float
    fore_x: float
    last_z: float
    last_x: float
    sign3: float
    sign4: float
    zero6: float
    upper_length: float
    fore_length: float
    straight: float
    R_PB: Array
    R_EP: Array
    R_FE: Array


@kernel
def centre_in_plane(X: Array, p_BP: Array, p_FC: Array, R_PB: Array) -> tuple[float, float, float]:
    """The centre in P of the flange pose X (4, 4), joint 1 at zero."""
    cx = X[0, 0] * p_FC[0] + X[0, 1] * p_FC[1] + X[0, 2] * p_FC[2] + X[0, 3] - p_BP[0]
    cy = X[1, 0] * p_FC[0] + X[1, 1] * p_FC[1] + X[1, 2] * p_FC[2] + X[1, 3] - p_BP[1]
    cz = X[2, 0] * p_FC[0] + X[2, 1] * p_FC[1] + X[2, 2] * p_FC[2] + X[2, 3] - p_BP[2]
    return (
        R_PB[0, 0] * cx + R_PB[0, 1] * cy + R_PB[0, 2] * cz,
        R_PB[1, 0] * cx + R_PB[1, 1] * cy + R_PB[1, 2] * cz,
        R_PB[2, 0] * cx + R_PB[2, 1] * cy + R_PB[2, 2] * cz,
    )


class Rotation(NamedTuple):
    """A rotation matrix, element by element: so it stays in registers."""

    xx: float
    xy: float
    xz: float
    yx: float
    yy: float
    yz: float
    zx: float
    zy: float
    zz: float


@kernel(inlined=True)
def row_times(x: float, y: float, z: float, R: Array) -> tuple[float, float, float]:
    """A row vector times a matrix, (3, 3) or larger."""
    return (
        x * R[0, 0] + y * R[1, 0] + z * R[2, 0],
        x * R[0, 1] + y * R[1, 1] + z * R[2, 1],
        x * R[0, 2] + y * R[1, 2] + z * R[2, 2],
    )


@kernel(inlined=True)
def wrist_rotation(X: Array, arm: PlaneArm) -> Rotation:
    """The rotation in P from the axes of the wrist at zero to those of the flange pose X (4, 4)."""
    A, C = arm.R_PB, arm.R_FE
    xx, xy, xz = row_times(A[0, 0], A[0, 1], A[0, 2], X)
    yx, yy, yz = row_times(A[1, 0], A[1, 1], A[1, 2], X)
    zx, zy, zz = row_times(A[2, 0], A[2, 1], A[2, 2], X)
    x0, x1, x2 = row_times(xx, xy, xz, C)
    y0, y1, y2 = row_times(yx, yy, yz, C)
    z0, z1, z2 = row_times(zx, zy, zz, C)
    return Rotation(x0, x1, x2, y0, y1, y2, z0, z1, z2)


@kernel
def bend_of_elbow(dz: float, dx: float, length_a: float, length_b: float) -> float:
    """Angle between the two long links whose ends are d apart; −1 when they do not reach."""
    square = dx * dx + dz * dz
    distance = math.sqrt(square)
    if distance > length_a + length_b + REACH_SLACK or distance < abs(length_a - length_b) - REACH_SLACK:
        return -1.0
    cosine = (square - length_a * length_a - length_b * length_b) / (2.0 * length_a * length_b)
    return acos(min(1.0, max(-1.0, cosine)))


@kernel(inlined=True)
def shoulder_turn(dz: float, dx: float, turn3: float, arm: PlaneArm) -> tuple[float, float, float, float]:
    """Joint 2 from the triangle as complex numbers: d = exp(i q2) (a + exp(i turn3) b).

    Returns exp(i q2) times a length, and exp(i turn3), each as real and imaginary part.
    """
    c, s = cos_sin(turn3)
    ez, ex = arm.upper_z + c * arm.fore_z - s * arm.fore_x, arm.upper_x + c * arm.fore_x + s * arm.fore_z
    return dz * ez + dx * ex, dx * ez - dz * ex, c, s


@kernel
def heading(
    wx: float, wy: float, radius: float, reach: float, lateral: float, previous: float
) -> tuple[float, float, float]:
    """Joint 1 that brings the centre (wx, wy) of P to (reach, lateral): angle, cosine, sine.

    On axis 1 itself any heading does, and `previous` is kept.
    """
    if radius < LOCK:
        return previous, cos(previous), sin(previous)
    real, imaginary = wx * reach + wy * lateral, wy * reach - wx * lateral
    length = math.sqrt(real * real + imaginary * imaginary)
    return atan2(imaginary, real), real / length, imaginary / length


@kernel(inlined=True)
def shoulders_apart(lateral: float, forward: float) -> float:
    """The turn [rad] of joint 1 between both shoulders."""
    return abs(math.pi - 2.0 * atan2(abs(lateral), forward)) if lateral != 0.0 else math.pi


@kernel
def elbow_is_straight(bend: float) -> bool:
    """Whether the arm is stretched out or folded, where joint speeds are unbounded."""
    return bend < NEAR or math.pi - bend < NEAR


@kernel
def flags_of(forward: float, bend: float) -> int:
    """The flags of a branch that its shoulder and elbow decide: `forward` is the centre's distance from axis 1."""
    flags = EXISTS
    if forward < NEAR:
        flags |= SHOULDER
    if elbow_is_straight(bend):
        flags |= ELBOW
    return flags
