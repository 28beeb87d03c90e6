"""Closed-form inverse kinematics of six-axis arms with a spherical wrist, compiled.

`SphericalWrist` packs the geometry. In the plane frame P, Z is along axis 1 and
Y along axis 2, so a turn by an angle about Y multiplies the complex number
z + i x by exp(i angle). The method is Pieper's (1968): the wrist centre gives
joints 1 to 3, the rotation that is left gives joints 4 to 6.
"""

from __future__ import annotations

import math

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.path_kernels import OK, SINGULAR, choose
from gcodesim.kinematics.protocol import Statuses

REACH_SLACK = 1e-9  # [m] beyond the reach that still counts as stretched out: rounding, not distance
NEAR = 1e-6  # [rad] of wrist and elbow, [m] of the shoulder from singular: joint speeds are unbounded in practice
LOCK = 1e-10  # [rad], [m] from singular: the free joint keeps its last value, the pose errs by no more than this
EXISTS, SHOULDER, ELBOW, WRIST = 1, 2, 4, 8


@kernel
def solve(
    X: Array,
    arm: Array,
    R_PB: Array,
    R_EP: Array,
    R_FE: Array,
    previous: Array,
    room: Array,
    out: Array,
    flags: Indices,
) -> None:
    """All eight joint vectors `out` (8, 6) of the flange pose X (4, 4); branch = 4 backward + 2 elbow + wrist.

    `arm`: origin of P in B (0..2), wrist centre in F (3..5), x of joint 2 in P (6),
    lateral offset of the wrist centre (7), vectors z, x from joint 2 to 3 (8, 9)
    and from joint 3 to the wrist centre (10, 11), sign of axis 3 along axis 2
    (12), angle of axis 6 from axis 4 about axis 5 (13). E has Z along axis 4 and Y
    along axis 5 at zero. `flags` (8,): 0 where the branch does not exist, else
    EXISTS and what is singular. `room` (3, 3, 3) is space to work in.
    """
    x2, lateral = arm[6], arm[7]
    z_a, x_a, z_b, x_b = arm[8], arm[9], arm[10], arm[11]
    length_a, length_b = math.hypot(z_a, x_a), math.hypot(z_b, x_b)
    angle_a, angle_b = math.atan2(x_a, z_a), math.atan2(x_b, z_b)
    wrist, turned, left = room[0], room[1], room[2]
    flags[:] = 0

    cx = X[0, 0] * arm[3] + X[0, 1] * arm[4] + X[0, 2] * arm[5] + X[0, 3] - arm[0]
    cy = X[1, 0] * arm[3] + X[1, 1] * arm[4] + X[1, 2] * arm[5] + X[1, 3] - arm[1]
    cz = X[2, 0] * arm[3] + X[2, 1] * arm[4] + X[2, 2] * arm[5] + X[2, 3] - arm[2]
    wx = R_PB[0, 0] * cx + R_PB[0, 1] * cy + R_PB[0, 2] * cz
    wy = R_PB[1, 0] * cx + R_PB[1, 1] * cy + R_PB[1, 2] * cz
    wz = R_PB[2, 0] * cx + R_PB[2, 1] * cy + R_PB[2, 2] * cz
    radius = math.sqrt(wx * wx + wy * wy)
    if radius < abs(lateral) - REACH_SLACK:
        return
    forward = math.sqrt(max(0.0, (radius - lateral) * (radius + lateral)))

    # the wrist's axes in P, before joints 1 to 3 are taken away: R_PB R_BF R_FE
    for r in range(3):
        for k in range(3):
            left[r, k] = R_PB[r, 0] * X[0, k] + R_PB[r, 1] * X[1, k] + R_PB[r, 2] * X[2, k]
    for r in range(3):
        for k in range(3):
            wrist[r, k] = left[r, 0] * R_FE[0, k] + left[r, 1] * R_FE[1, k] + left[r, 2] * R_FE[2, k]

    for shoulder in range(2):
        reach = forward if shoulder == 0 else -forward
        q1 = math.atan2(wy, wx) - math.atan2(lateral, reach)
        if radius < LOCK:
            q1 = previous[0]  # the wrist centre is on axis 1 and any heading does
        dx, dz = reach - x2, wz
        square = dx * dx + dz * dz
        distance = math.sqrt(square)
        if distance > length_a + length_b + REACH_SLACK or distance < abs(length_a - length_b) - REACH_SLACK:
            continue
        cosine = (square - length_a * length_a - length_b * length_b) / (2.0 * length_a * length_b)
        bend = math.acos(min(1.0, max(-1.0, cosine)))
        flag = EXISTS
        if forward < NEAR:
            flag |= SHOULDER
        if bend < NEAR or math.pi - bend < NEAR:
            flag |= ELBOW
        c1, s1 = math.cos(q1), math.sin(q1)
        for k in range(3):
            turned[0, k] = c1 * wrist[0, k] + s1 * wrist[1, k]
            turned[1, k] = c1 * wrist[1, k] - s1 * wrist[0, k]
            turned[2, k] = wrist[2, k]
        for elbow in range(2):
            turn3 = (bend if elbow == 0 else -bend) - angle_b + angle_a
            # the triangle as complex numbers: d = exp(i q2) (a + exp(i turn3) b)
            ct, st = math.cos(turn3), math.sin(turn3)
            ez, ex = z_a + ct * z_b - st * x_b, x_a + ct * x_b + st * z_b
            q2 = math.atan2(dx * ez - dz * ex, dz * ez + dx * ex)
            cp, sp = math.cos(q2 + turn3), math.sin(q2 + turn3)
            for k in range(3):
                n0 = cp * turned[0, k] - sp * turned[2, k]
                n1 = turned[1, k]
                n2 = sp * turned[0, k] + cp * turned[2, k]
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


@kernel
def inverse_path(
    X: Array,
    seed: Array,
    arm: Array,
    R_PB: Array,
    R_EP: Array,
    R_FE: Array,
    lower: Array,
    upper: Array,
    out: Array,
    status: Statuses,
) -> None:
    """Joints `out` (n, 6) and `status` (n,) along flange poses X (n, 4, 4), each row nearest to the one before."""
    candidates = np.empty((8, 6))
    room = np.empty((3, 3, 3))
    flags = np.zeros(8, dtype=np.int64)
    revolute = np.ones(6, dtype=np.int64)
    previous = seed.copy()
    branch = -1
    for k in range(X.shape[0]):
        solve(X[k], arm, R_PB, R_EP, R_FE, previous, room, candidates, flags)
        branch, state = choose(candidates, flags, previous, lower, upper, revolute, branch, out[k])
        if state == OK and flags[branch] != EXISTS:
            state = SINGULAR
        status[k] = state
        previous[:] = out[k]
