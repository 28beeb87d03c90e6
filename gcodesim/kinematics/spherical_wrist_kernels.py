"""Closed-form inverse kinematics of six-axis arms with a spherical wrist, compiled.

The method is Pieper's (1968): the wrist centre gives joints 1 to 3, the rotation
that is left gives joints 4 to 6. Frames: `plane_kernels`.
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


@kernel(inlined=True)
def wrist_angles(R: Array, q4: float) -> tuple[float, float, float, float]:
    """Turns of joints 4, 5 and 6 with R = Rz(q4) Ry(bent) Rz(q6), and the sine of the bend; locked, `q4` is kept."""
    sine = math.sqrt(R[0, 2] * R[0, 2] + R[1, 2] * R[1, 2])
    if sine < LOCK:  # axes 4 and 6 are in line; joint 6 does the rest
        c4, s4 = cos_sin(q4)
    else:
        c4, s4 = R[0, 2] / sine, R[1, 2] / sine
        q4 = atan2(s4, c4)
    bent = atan2(c4 * R[0, 2] + s4 * R[1, 2], R[2, 2])
    # from the rotation with joint 4 taken away: exact however badly joint 4 is known
    q6 = atan2(c4 * R[1, 0] - s4 * R[0, 0], c4 * R[1, 1] - s4 * R[0, 1])
    return q4, bent, q6, sine


@kernel
def solve(X: Array, only: int, arm: PlaneArm, previous: Array, room: Array, out: Array, flags: Indices) -> float:
    """All eight joint vectors `out` (8, 6) of the flange pose X (4, 4); branch = 4 backward + 2 elbow + wrist.

    E has Z along axis 4 and Y along axis 5 at zero; R_FE contains the angle of
    axis 6 from axis 4. `flags` (8,): 0 where the branch does not exist.
    `room` (3, 3, 3) is space to work in. With `only` a branch number, just the two
    branches with its shoulder and elbow are computed; returned is how far [rad]
    at least they are, in joint space, from those left out.
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
        dx, dz = reach - arm.x2, wz
        bend = bend_of_elbow(dz, dx, arm.upper_length, arm.fore_length)
        if bend < 0.0:
            continue
        flag = flags_of(forward, bend)
        turn_back(wrist, c1, s1, turned)
        apart = min(apart, 2.0 * bend, 2.0 * (math.pi - bend))
        for elbow in range(2):
            if only >= 0 and only // 2 % 2 != elbow:
                continue
            turn3 = (bend if elbow == 0 else -bend) + arm.straight
            real, imaginary, ct, st = shoulder_turn(dz, dx, turn3, arm)
            q2 = atan2(imaginary, real)
            length = math.sqrt(real * real + imaginary * imaginary)
            # exp(i (q2 + turn3)), the turn of link 3
            c, s = (real * ct - imaginary * st) / length, (real * st + imaginary * ct) / length
            for k in range(3):
                n0 = c * turned[0, k] - s * turned[2, k]
                n1 = turned[1, k]
                n2 = s * turned[0, k] + c * turned[2, k]
                left[0, k] = R_EP[0, 0] * n0 + R_EP[0, 1] * n1 + R_EP[0, 2] * n2
                left[1, k] = R_EP[1, 0] * n0 + R_EP[1, 1] * n1 + R_EP[1, 2] * n2
                left[2, k] = R_EP[2, 0] * n0 + R_EP[2, 1] * n1 + R_EP[2, 2] * n2
            q4, bent, q6, sine = wrist_angles(left, previous[3])
            b = 4 * shoulder + 2 * elbow
            for flipped in range(2):
                row = out[b + flipped]
                row[0], row[1], row[2] = q1, q2, arm.sign3 * turn3
                row[3], row[4], row[5] = q4, bent - arm.zero6, q6
                flags[b + flipped] = flag | WRIST if sine < NEAR else flag
                if sine >= LOCK:
                    q4 += math.pi
                    bent = -bent
                    q6 += math.pi
    return apart
