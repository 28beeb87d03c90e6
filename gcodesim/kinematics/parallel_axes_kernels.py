"""Closed-form inverse kinematics of six-axis arms whose axes 2, 3, 4 are parallel, compiled.

The point where axes 5 and 6 meet gives joint 1, the rotation that is left gives
the turn of links 2 to 4 together, joints 5 and 6, and a triangle joints 2 and 3
(Hawkins 2013 for the Universal Robots arms). The arm: `PlaneArm`.
"""

from __future__ import annotations

import math

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.plane_kernels import (
    LOCK,
    NEAR,
    REACH_SLACK,
    WRIST,
    PlaneArm,
    bend_of_elbow,
    centre_in_plane,
    flags_of,
    heading,
    rotate_three,
    shoulder_turn,
    turn_back,
)

TURNED_OVER = (
    1.8  # [rad] at least between a wrist and the same turned over: joints 2 to 4 together turn by π, so π / √3
)


@kernel
def solve(X: Array, only: int, arm: PlaneArm, previous: Array, room: Array, out: Array, flags: Indices) -> float:
    """All eight joint vectors `out` (8, 6) of the flange pose X (4, 4); branch = 4 backward + 2 elbow + wrist.

    E has Z along axis 2 and Y along axis 5 at zero; R_FE contains the angle of
    axis 6 from axis 2. `flags`, `only`, `room` and the return as for the spherical wrist.
    """
    wrist, turned, left = room[0], room[1], room[2]
    R_PB, R_EP = arm.R_PB, arm.R_EP
    for b in range(8):
        flags[b] = 0
    wx, wy, wz = centre_in_plane(X, arm.p_BP, arm.p_FC, R_PB)
    radius, lateral = math.sqrt(wx * wx + wy * wy), arm.lateral
    if radius < abs(lateral) - REACH_SLACK:
        return 0.0
    forward = math.sqrt(max(0.0, (radius - lateral) * (radius + lateral)))
    rotate_three(R_PB, X, arm.R_FE, left, wrist)
    apart = abs(math.pi - 2.0 * atan2(abs(lateral), forward)) if lateral != 0.0 else math.pi
    for shoulder in range(2):
        if only >= 0 and only // 4 != shoulder:
            continue
        reach = forward if shoulder == 0 else -forward
        q1, c1, s1 = heading(wx, wy, radius, reach, lateral, previous[0])
        turn_back(wrist, c1, s1, turned)
        for r in range(3):
            for k in range(3):
                left[r, k] = R_EP[r, 0] * turned[0, k] + R_EP[r, 1] * turned[1, k] + R_EP[r, 2] * turned[2, k]
        # left = Rz(turn) Ry(bent) Rz(q6), turn being that of joints 2 to 4 together
        sine = math.sqrt(left[2, 0] * left[2, 0] + left[2, 1] * left[2, 1])
        if sine < LOCK:
            q6 = previous[5]  # axis 6 is parallel to axes 2 to 4; those do the rest
            c6, s6 = cos_sin(q6)
        else:
            c6, s6 = -left[2, 0] / sine, left[2, 1] / sine
            q6 = atan2(s6, c6)
        bent = atan2(s6 * left[2, 1] - c6 * left[2, 0], left[2, 2])
        # from the rotation with joint 6 taken away: exact however badly joint 6 is known
        turn = atan2(-s6 * left[0, 0] - c6 * left[0, 1], s6 * left[1, 0] + c6 * left[1, 1])
        for flipped in range(2):
            c, s = cos_sin(turn)
            dx = reach - arm.x2 - (c * arm.last_x + s * arm.last_z)
            dz = wz - (c * arm.last_z - s * arm.last_x)
            bend = bend_of_elbow(dz, dx, arm.upper_length, arm.fore_length)
            if bend >= 0.0:
                flag = flags_of(forward, bend)
                if sine < NEAR:
                    flag |= WRIST
                apart = min(apart, 2.0 * bend, 2.0 * (math.pi - bend), TURNED_OVER)
                for elbow in range(2):
                    if only >= 0 and only // 2 % 2 != elbow:
                        continue
                    turn3 = (bend if elbow == 0 else -bend) + arm.straight
                    real, imaginary, _, _ = shoulder_turn(dz, dx, turn3, arm)
                    q2 = atan2(imaginary, real)
                    b = 4 * shoulder + 2 * elbow + flipped
                    row = out[b]
                    row[0], row[1], row[2] = q1, q2, arm.sign3 * turn3
                    row[3], row[4], row[5] = arm.sign4 * (turn - q2 - turn3), bent - arm.zero6, q6
                    flags[b] = flag
            if sine >= LOCK:
                turn += math.pi
                bent = -bent
                q6 += math.pi
    return apart
