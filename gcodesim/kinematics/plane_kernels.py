"""Compiled steps that closed forms share: the arm seen in its own plane frame P, Z along axis 1, Y along axis 2.

`arm` is packed as follows: origin of P in B (0..2), the centre — where the last
axes meet — in F (3..5), x of joint 2 in P (6), lateral offset of the centre (7),
vectors z, x from joint 2 to 3 (8, 9) and from joint 3 on (10, 11), sign of axis
3 along axis 2 (12), angle of axis 6 at zero (13), and where needed the vector
z, x from joint 4 to the centre (14, 15) and the sign of axis 4 (16); then the
lengths of the two long links (17, 18) and the turn of joint 3 from zero to
straight (19). In the plane a turn about Y multiplies the complex number z + i x by exp(i angle).
"""

from __future__ import annotations

import math

from gcodesim.compiled import kernel
from gcodesim.frames import Array

REACH_SLACK = 1e-9  # [m] beyond the reach that still count as stretched out: rounding, not distance
NEAR = 1e-6  # [rad] of wrist and elbow, [m] of the shoulder from singular: joint speeds are unbounded in practice
LOCK = 1e-10  # [rad], [m] from singular: the free joint keeps its last value, the pose errs by no more than this
EXISTS, SHOULDER, ELBOW, WRIST = 1, 2, 4, 8  # flags of a branch: it exists, and which part of it is singular


@kernel
def centre_in_plane(X: Array, arm: Array, R_PB: Array) -> tuple[float, float, float]:
    """The centre in P of the flange pose X (4, 4), joint 1 at zero."""
    cx = X[0, 0] * arm[3] + X[0, 1] * arm[4] + X[0, 2] * arm[5] + X[0, 3] - arm[0]
    cy = X[1, 0] * arm[3] + X[1, 1] * arm[4] + X[1, 2] * arm[5] + X[1, 3] - arm[1]
    cz = X[2, 0] * arm[3] + X[2, 1] * arm[4] + X[2, 2] * arm[5] + X[2, 3] - arm[2]
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
    return math.acos(min(1.0, max(-1.0, cosine)))


@kernel
def shoulder_turn(dz: float, dx: float, turn3: float, arm: Array) -> tuple[float, float, float, float]:
    """Joint 2 from the triangle as complex numbers: d = exp(i q2) (a + exp(i turn3) b).

    Returns exp(i q2) times a length, and exp(i turn3), each as real and imaginary part.
    """
    c, s = math.cos(turn3), math.sin(turn3)
    ez, ex = arm[8] + c * arm[10] - s * arm[11], arm[9] + c * arm[11] + s * arm[10]
    return dz * ez + dx * ex, dx * ez - dz * ex, c, s


@kernel
def heading(
    wx: float, wy: float, radius: float, reach: float, lateral: float, previous: float
) -> tuple[float, float, float]:
    """Joint 1 that brings the centre (wx, wy) of P to (reach, lateral): angle, cosine, sine.

    On axis 1 itself any heading does, and `previous` is kept.
    """
    if radius < LOCK:
        return previous, math.cos(previous), math.sin(previous)
    real, imaginary = wx * reach + wy * lateral, wy * reach - wx * lateral
    length = math.sqrt(real * real + imaginary * imaginary)
    return math.atan2(imaginary, real), real / length, imaginary / length


@kernel
def elbow_is_straight(bend: float) -> bool:
    """Whether the arm is stretched out or folded, where joint speeds are unbounded."""
    return bend < NEAR or math.pi - bend < NEAR
