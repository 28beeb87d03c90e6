"""Closed-form inverse kinematics of six-axis arms with a spherical wrist, compiled.

The method is Pieper's (1968): the wrist centre gives joints 1 to 3, the rotation
that is left gives joints 4 to 6. Frames: `plane_kernels`.
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


@kernel(inlined=True)
def left_of(
    x: float, y: float, z: float, turned: tuple[float, float, float, float], R_EP: Array
) -> tuple[float, float, float]:
    """A column of what is left of a rotation: the column less joint 1 and the turn of link 3, in E.

    `turned` are cosine and sine of joint 1, and those of the turn.
    """
    c1, s1, c, s = turned
    across, along = c1 * y - s1 * x, c1 * x + s1 * y
    n0, n2 = c * along - s * z, s * along + c * z
    return (
        R_EP[0, 0] * n0 + R_EP[0, 1] * across + R_EP[0, 2] * n2,
        R_EP[1, 0] * n0 + R_EP[1, 1] * across + R_EP[1, 2] * n2,
        R_EP[2, 0] * n0 + R_EP[2, 1] * across + R_EP[2, 2] * n2,
    )


class Bent(NamedTuple):
    """Joint 2, the turn of joint 3, turns of joints 4, 5 and 6, and the sine of the wrist's bend."""

    q2: float
    turn3: float
    q4: float
    bent: float
    q6: float
    sine: float


@kernel(inlined=True)
def behind_shoulder(
    R: Rotation, head: tuple[float, float], dz: float, dx: float, bend: float, arm: PlaneArm, q4: float
) -> Bent:
    """Joints 2 to 6 behind a joint 1 with cosine and sine `head`, with the centre at dz, dx from joint 2.

    The elbow has the signed `bend`. The wrist's turns are those with R = Rz(q4) Ry(bent) Rz(q6) of what is left of the
    rotation `R`; locked, `q4` is kept.
    """
    turn3 = bend + arm.straight
    real, imaginary, ct, st = shoulder_turn(dz, dx, turn3, arm)
    q2 = atan2(imaginary, real)
    length = math.sqrt(real * real + imaginary * imaginary)
    # exp(i (q2 + turn3)), the turn of link 3
    c, s = (real * ct - imaginary * st) / length, (real * st + imaginary * ct) / length
    turned = (head[0], head[1], c, s)
    xx, yx, _ = left_of(R.xx, R.yx, R.zx, turned, arm.R_EP)
    xy, yy, _ = left_of(R.xy, R.yy, R.zy, turned, arm.R_EP)
    xz, yz, zz = left_of(R.xz, R.yz, R.zz, turned, arm.R_EP)
    sine = math.sqrt(xz * xz + yz * yz)
    if sine < LOCK:  # axes 4 and 6 are in line; joint 6 does the rest
        c4, s4 = cos_sin(q4)
    else:
        c4, s4 = xz / sine, yz / sine
        q4 = atan2(s4, c4)
    bent = atan2(c4 * xz + s4 * yz, zz)
    # from the rotation with joint 4 taken away: exact however badly joint 4 is known
    q6 = atan2(c4 * yx - s4 * xx, c4 * yy - s4 * xy)
    return Bent(q2, turn3, q4, bent, q6, sine)


@kernel
def solve(X: Array, only: int, arm: PlaneArm, previous: Array, out: Array, flags: Indices) -> float:
    """All eight joint vectors `out` (8, 6) of the flange pose X (4, 4); branch = 4 backward + 2 elbow + wrist.

    E has Z along axis 4 and Y along axis 5 at zero; R_FE contains the angle of
    axis 6 from axis 4. `flags` (8,): 0 where the branch does not exist.
    With `only` a branch number, just the two branches with its shoulder and elbow
    are computed; returned is how far [rad] at least they are, in joint space, from
    those left out.
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
        dx, dz = reach - arm.x2, wz
        bend = bend_of_elbow(dz, dx, arm.upper_length, arm.fore_length)
        if bend < 0.0:
            continue
        flag = flags_of(forward, bend)
        apart = min(apart, 2.0 * bend, 2.0 * (math.pi - bend))
        for elbow in range(2):
            if only >= 0 and only // 2 % 2 != elbow:
                continue
            found = behind_shoulder(R, (c1, s1), dz, dx, bend if elbow == 0 else -bend, arm, previous[3])
            q4, bent, q6 = found.q4, found.bent, found.q6
            b = 4 * shoulder + 2 * elbow
            for flipped in range(2):
                row = out[b + flipped]
                row[0], row[1], row[2] = q1, found.q2, arm.sign3 * found.turn3
                row[3], row[4], row[5] = q4, bent - arm.zero6, q6
                flags[b + flipped] = flag | WRIST if found.sine < NEAR else flag
                if found.sine >= LOCK:
                    q4 += math.pi
                    bent = -bent
                    q6 += math.pi
    return apart


@kernel(lean=True, inlined=True)
def follow(X: Array, branch: int, arm: PlaneArm, lower: Array, upper: Array, previous: Array, out: Array) -> bool:
    """Joints `out` (6,) of the flange pose X (4, 4) on the `branch` of the row before, if they are near to it.

    False where another branch may be the one to choose, or where this one is singular or leaves the limits
    `lower`, `upper` (6,): then `out` is not valid, and all branches have to be looked at.
    """
    wx, wy, wz = centre_in_plane(X, arm.p_BP, arm.p_FC, arm.R_PB)
    radius, lateral = math.sqrt(wx * wx + wy * wy), arm.lateral
    forward = math.sqrt(max(0.0, (radius - lateral) * (radius + lateral)))
    if radius < abs(lateral) or forward < NEAR:
        return False
    reach = forward if branch < 4 else -forward
    q1, c1, s1 = heading(wx, wy, radius, reach, lateral, previous[0])
    dx, dz = reach - arm.x2, wz
    bend = bend_of_elbow(dz, dx, arm.upper_length, arm.fore_length)
    if bend < NEAR or math.pi - bend < NEAR:
        return False
    elbow = bend if branch // 2 % 2 == 0 else -bend
    found = behind_shoulder(wrist_rotation(X, arm), (c1, s1), dz, dx, elbow, arm, previous[3])
    if found.sine < NEAR:
        return False
    q4, bent, q6 = found.q4, found.bent, found.q6
    if branch % 2 == 1:
        q4, bent, q6 = q4 + math.pi, -bent, q6 + math.pi
    angles = (q1, found.q2, arm.sign3 * found.turn3, q4, bent - arm.zero6, q6)
    # a wrist that is turned over is half a turn away in joints 4 and 6, which is farther than any of these
    apart = min(shoulders_apart(lateral, forward), 2.0 * bend, 2.0 * (math.pi - bend))
    return is_next(angles, previous, lower, upper, 0.25 * apart * apart, out)
