"""Closed-form inverse kinematics of six-axis arms whose axes 2, 3, 4 are parallel, compiled.

The point where axes 5 and 6 meet gives joint 1, the rotation that is left gives
the turn of links 2 to 4 together, joints 5 and 6, and a triangle joints 2 and 3
(Hawkins 2013 for the Universal Robots arms). The arm: `PlaneArm`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.path_kernels import is_next
from gcodesim.kinematics.plane_kernels import (
    LOCK,
    NEAR,
    REACH_SLACK,
    WRIST,
    PlaneArm,
    Rotation,
    bend_of_elbow,
    centre_in_plane,
    flags_of,
    heading,
    shoulder_turn,
    shoulders_apart,
    wrist_rotation,
)

TURNED_OVER = (
    1.8  # [rad] at least between a wrist and the same turned over: joints 2 to 4 together turn by π, so π / √3
)


class Wrist(NamedTuple):
    """The turn of joints 2 to 4 together, those of joints 5 and 6, and the sine of the bend between axes 2 and 6."""

    turn: float
    bent: float
    q6: float
    sine: float


@kernel(inlined=True)
def behind_base(R: Rotation, c1: float, s1: float, arm: PlaneArm, q6: float) -> Wrist:
    """The wrist behind a joint 1 with this cosine and sine; where axis 6 is parallel to axes 2 to 4, `q6` is kept.

    With joint 1 taken away, what is left of the rotation `R` is Rz(turn) Ry(bent) Rz(q6) in E.
    """
    E = arm.R_EP
    x0, x1 = c1 * R.xx + s1 * R.yx, c1 * R.yx - s1 * R.xx
    y0, y1 = c1 * R.xy + s1 * R.yy, c1 * R.yy - s1 * R.xy
    z0, z1 = c1 * R.xz + s1 * R.yz, c1 * R.yz - s1 * R.xz
    xx, xy = E[0, 0] * x0 + E[0, 1] * x1 + E[0, 2] * R.zx, E[0, 0] * y0 + E[0, 1] * y1 + E[0, 2] * R.zy
    yx, yy = E[1, 0] * x0 + E[1, 1] * x1 + E[1, 2] * R.zx, E[1, 0] * y0 + E[1, 1] * y1 + E[1, 2] * R.zy
    zx, zy = E[2, 0] * x0 + E[2, 1] * x1 + E[2, 2] * R.zx, E[2, 0] * y0 + E[2, 1] * y1 + E[2, 2] * R.zy
    zz = E[2, 0] * z0 + E[2, 1] * z1 + E[2, 2] * R.zz
    sine = math.sqrt(zx * zx + zy * zy)
    if sine < LOCK:  # joints 2 to 4 do the rest
        c6, s6 = cos_sin(q6)
    else:
        c6, s6 = -zx / sine, zy / sine
        q6 = atan2(s6, c6)
    bent = atan2(s6 * zy - c6 * zx, zz)
    # from the rotation with joint 6 taken away: exact however badly joint 6 is known
    turn = atan2(-s6 * xx - c6 * xy, s6 * yx + c6 * yy)
    return Wrist(turn, bent, q6, sine)


@kernel(inlined=True)
def turned_over(wrist: Wrist) -> Wrist:
    """The other wrist that holds the flange so."""
    return Wrist(wrist.turn + math.pi, -wrist.bent, wrist.q6 + math.pi, wrist.sine)


@kernel(inlined=True)
def fourth_axis(reach: float, wz: float, turn: float, arm: PlaneArm) -> tuple[float, float]:
    """Where axis 4 is in the plane, z and x from joint 2, with the centre at `reach` and `wz` of P."""
    c, s = cos_sin(turn)
    dx = reach - arm.x2 - (c * arm.last_x + s * arm.last_z)
    return wz - (c * arm.last_z - s * arm.last_x), dx


@kernel(inlined=True)
def joints_of(
    q1: float, dz: float, dx: float, bend: float, wrist: Wrist, arm: PlaneArm
) -> tuple[float, float, float, float, float, float]:
    """All joints, with axis 4 at dz, dx from joint 2 and the signed `bend` of the elbow."""
    turn3 = bend + arm.straight
    real, imaginary, _, _ = shoulder_turn(dz, dx, turn3, arm)
    q2 = atan2(imaginary, real)
    q4 = arm.sign4 * (wrist.turn - q2 - turn3)
    return q1, q2, arm.sign3 * turn3, q4, wrist.bent - arm.zero6, wrist.q6


@kernel
def solve(X: Array, only: int, arm: PlaneArm, previous: Array, out: Array, flags: Indices) -> float:
    """All eight joint vectors `out` (8, 6) of the flange pose X (4, 4); branch = 4 backward + 2 elbow + wrist.

    E has Z along axis 2 and Y along axis 5 at zero; R_FE contains the angle of
    axis 6 from axis 2. `flags`, `only` and the return as for the spherical wrist.
    """
    for b in range(8):
        flags[b] = 0
    wx, wy, wz = centre_in_plane(X, arm.p_BP, arm.p_FC, arm.R_PB)
    radius, lateral = math.sqrt(wx * wx + wy * wy), arm.lateral
    if radius < abs(lateral) - REACH_SLACK:
        return 0.0
    forward = math.sqrt(max(0.0, (radius - lateral) * (radius + lateral)))
    R = wrist_rotation(X, arm)
    apart = shoulders_apart(lateral, forward)
    for shoulder in range(2):
        if only >= 0 and only // 4 != shoulder:
            continue
        reach = forward if shoulder == 0 else -forward
        q1, c1, s1 = heading(wx, wy, radius, reach, lateral, previous[0])
        wrist = behind_base(R, c1, s1, arm, previous[5])
        for flipped in range(2):
            dz, dx = fourth_axis(reach, wz, wrist.turn, arm)
            bend = bend_of_elbow(dz, dx, arm.upper_length, arm.fore_length)
            if bend >= 0.0:
                flag = flags_of(forward, bend)
                if wrist.sine < NEAR:
                    flag |= WRIST
                apart = min(apart, 2.0 * bend, 2.0 * (math.pi - bend), TURNED_OVER)
                for elbow in range(2):
                    if only >= 0 and only // 2 % 2 != elbow:
                        continue
                    b = 4 * shoulder + 2 * elbow + flipped
                    angles = joints_of(q1, dz, dx, bend if elbow == 0 else -bend, wrist, arm)
                    for i in range(6):
                        out[b, i] = angles[i]
                    flags[b] = flag
            if wrist.sine >= LOCK:
                wrist = turned_over(wrist)
    return apart


@kernel(lean=True, inlined=True)
def follow(X: Array, branch: int, arm: PlaneArm, lower: Array, upper: Array, previous: Array, out: Array) -> bool:
    """`follow` of the spherical wrist: joints `out` (6,) on the `branch` of the row before, if they are near to it."""
    wx, wy, wz = centre_in_plane(X, arm.p_BP, arm.p_FC, arm.R_PB)
    radius, lateral = math.sqrt(wx * wx + wy * wy), arm.lateral
    forward = math.sqrt(max(0.0, (radius - lateral) * (radius + lateral)))
    if radius < abs(lateral) or forward < NEAR:
        return False
    reach = forward if branch < 4 else -forward
    q1, c1, s1 = heading(wx, wy, radius, reach, lateral, previous[0])
    wrist = behind_base(wrist_rotation(X, arm), c1, s1, arm, previous[5])
    if wrist.sine < NEAR:
        return False
    if branch % 2 == 1:
        wrist = turned_over(wrist)
    dz, dx = fourth_axis(reach, wz, wrist.turn, arm)
    bend = bend_of_elbow(dz, dx, arm.upper_length, arm.fore_length)
    if bend < NEAR or math.pi - bend < NEAR:
        return False
    angles = joints_of(q1, dz, dx, bend if branch // 2 % 2 == 0 else -bend, wrist, arm)
    apart = min(shoulders_apart(lateral, forward), 2.0 * bend, 2.0 * (math.pi - bend), TURNED_OVER)
    return is_next(angles, previous, lower, upper, 0.25 * apart * apart, out)
