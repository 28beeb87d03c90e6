"""Closed-form inverse kinematics of six-axis arms with a spherical wrist, compiled.

The method is Pieper's (1968): the wrist centre gives joints 1 to 3, the rotation
that is left gives joints 4 to 6. Packing of `arm` and frames: `plane_kernels`.
"""

from __future__ import annotations

import math

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.plane_kernels import (
    ELBOW,
    EXISTS,
    LOCK,
    NEAR,
    REACH_SLACK,
    SHOULDER,
    WRIST,
    bend_of_elbow,
    centre_in_plane,
    elbow_is_straight,
    heading,
    rotate_three,
    shoulder_turn,
    turn_back,
)


@kernel
def solve(
    X: Array,
    only: int,
    arm: Array,
    R_PB: Array,
    R_EP: Array,
    R_FE: Array,
    previous: Array,
    room: Array,
    out: Array,
    flags: Indices,
) -> float:
    """All eight joint vectors `out` (8, 6) of the flange pose X (4, 4); branch = 4 backward + 2 elbow + wrist.

    E has Z along axis 4 and Y along axis 5 at zero; R_FE contains the angle of
    axis 6 from axis 4. `flags` (8,): 0 where the branch does not exist.
    `room` (3, 3, 3) is space to work in. With `only` a branch number, just the two
    branches with its shoulder and elbow are computed; returned is how far [rad]
    at least they are, in joint space, from those left out.
    """
    wrist, turned, left = room[0], room[1], room[2]
    for b in range(8):
        flags[b] = 0
    wx, wy, wz = centre_in_plane(X, arm, R_PB)
    radius, lateral = math.sqrt(wx * wx + wy * wy), arm[7]
    if radius < abs(lateral) - REACH_SLACK:
        return 0.0
    forward = math.sqrt(max(0.0, (radius - lateral) * (radius + lateral)))
    rotate_three(R_PB, X, R_FE, left, wrist)
    apart = abs(math.pi - 2.0 * math.atan2(abs(lateral), forward)) if lateral != 0.0 else math.pi
    for shoulder in range(2):
        if only >= 0 and only // 4 != shoulder:
            continue
        reach = forward if shoulder == 0 else -forward
        q1, c1, s1 = heading(wx, wy, radius, reach, lateral, previous[0])
        dx, dz = reach - arm[6], wz
        bend = bend_of_elbow(dz, dx, arm[17], arm[18])
        if bend < 0.0:
            continue
        flag = EXISTS
        if forward < NEAR:
            flag |= SHOULDER
        if elbow_is_straight(bend):
            flag |= ELBOW
        turn_back(wrist, c1, s1, turned)
        apart = min(apart, 2.0 * bend, 2.0 * (math.pi - bend))
        for elbow in range(2):
            if only >= 0 and only // 2 % 2 != elbow:
                continue
            turn3 = (bend if elbow == 0 else -bend) + arm[19]
            real, imaginary, ct, st = shoulder_turn(dz, dx, turn3, arm)
            q2 = math.atan2(imaginary, real)
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
            # left = Rz(q4) Ry(bent) Rz(q6)
            sine = math.sqrt(left[0, 2] * left[0, 2] + left[1, 2] * left[1, 2])
            if sine < LOCK:
                q4 = previous[3]  # axes 4 and 6 are in line; joint 6 does the rest
                c4, s4 = math.cos(q4), math.sin(q4)
            else:
                c4, s4 = left[0, 2] / sine, left[1, 2] / sine
                q4 = math.atan2(s4, c4)
            bent = math.atan2(c4 * left[0, 2] + s4 * left[1, 2], left[2, 2])
            # from the rotation with joint 4 taken away: exact however badly joint 4 is known
            q6 = math.atan2(c4 * left[1, 0] - s4 * left[0, 0], c4 * left[1, 1] - s4 * left[0, 1])
            b = 4 * shoulder + 2 * elbow
            for flipped in range(2):
                row = out[b + flipped]
                row[0], row[1], row[2] = q1, q2, arm[12] * turn3
                row[3], row[4], row[5] = q4, bent - arm[13], q6
                flags[b + flipped] = flag | WRIST if sine < NEAR else flag
                if sine >= LOCK:
                    q4 += math.pi
                    bent = -bent
                    q6 += math.pi
    return apart
