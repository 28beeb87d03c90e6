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


@kernel
def rotate_three(A: Array, B: Array, C: Array, room: Array, out: Array) -> None:
    """out = A B C, all (3, 3) or larger."""
    for r in range(3):
        for k in range(3):
            room[r, k] = A[r, 0] * B[0, k] + A[r, 1] * B[1, k] + A[r, 2] * B[2, k]
    for r in range(3):
        for k in range(3):
            out[r, k] = room[r, 0] * C[0, k] + room[r, 1] * C[1, k] + room[r, 2] * C[2, k]


@kernel
def turn_back(R: Array, c: float, s: float, out: Array) -> None:
    """out = Rz(angle)ᵀ R, (3, 3), of the angle's cosine and sine."""
    for k in range(3):
        out[0, k] = c * R[0, k] + s * R[1, k]
        out[1, k] = c * R[1, k] - s * R[0, k]
        out[2, k] = R[2, k]


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
