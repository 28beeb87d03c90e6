"""Inverse dynamics of a tree by recursive Newton–Euler equations, compiled."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.tree_kernels import copy_row, joint_frames, place


@kernel
def add_cross(out: Array, a: Array, b: Array) -> None:
    """out += a × b, vectors (3,)."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@kernel
def add_carried(out: Array, spin: Array, spin_rate: Array, arm: Array, room: Array) -> None:
    """out += α × r + ω × (ω × r): what a point at `arm` feels on a body that turns."""
    for r in range(3):
        room[r] = 0.0
    add_cross(room, spin, arm)
    add_cross(out, spin, room)
    add_cross(out, spin_rate, arm)


@kernel
def efforts_along(
    q: Array,
    qd: Array,
    qdd: Array,
    wrench: Array,
    gravity: Array,
    mass: Array,
    com: Array,
    inertia: Array,
    parent: Indices,
    before: Array,
    axis: Array,
    prismatic: Indices,
    carrier: int,
    tip: Array,
    out: Array,
) -> None:
    """Efforts `out` (n, j) along q, qd, qdd (n, j) under `wrench` (n, 6) at the tip, base axes, acting on the tool.

    `mass` (j,), `com` (j, 3), `inertia` (j, 3, 3) about it, of the body that each
    joint moves, in joint axes. `tip` (4, 4) rides on joint `carrier`. Luh, Walker,
    Paul 1980: motion outwards with the base falling up, forces inwards. All
    vectors in base axes.
    """
    count = q.shape[1]
    frames, X_tip = np.empty((count, 4, 4)), np.empty((4, 4))
    z, c = np.empty((count, 3)), np.empty((count, 3))
    spin, spin_rate, origin = np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 3))
    force, moment = np.empty((count, 3)), np.empty((count, 3))
    arm, room, I_spin, I_rate = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for k in range(q.shape[0]):
        joint_frames(q[k], parent, before, axis, prismatic, frames)
        for i in range(count):
            p = parent[i]
            for r in range(3):
                z[i, r] = frames[i, r, 0] * axis[i, 0] + frames[i, r, 1] * axis[i, 1] + frames[i, r, 2] * axis[i, 2]
                c[i, r] = frames[i, r, 0] * com[i, 0] + frames[i, r, 1] * com[i, 1] + frames[i, r, 2] * com[i, 2]
                spin[i, r] = spin[p, r] if p >= 0 else 0.0
                spin_rate[i, r] = spin_rate[p, r] if p >= 0 else 0.0
                origin[i, r] = origin[p, r] if p >= 0 else -gravity[r]
                arm[r] = frames[i, r, 3] - (frames[p, r, 3] if p >= 0 else 0.0)
            add_carried(origin[i], spin[i], spin_rate[i], arm, room)
            for r in range(3):
                room[r] = z[i, r] * qd[k, i]
            if prismatic[i] == 1:
                add_cross(origin[i], spin[i], room)
                add_cross(origin[i], spin[i], room)  # twice: Coriolis
                for r in range(3):
                    origin[i, r] += z[i, r] * qdd[k, i]
            else:
                add_cross(spin_rate[i], spin[i], room)
                for r in range(3):
                    spin_rate[i, r] += z[i, r] * qdd[k, i]
                    spin[i, r] += room[r]
            # the body's own balance
            copy_row(origin[i], force[i])
            add_carried(force[i], spin[i], spin_rate[i], c[i], room)
            for r in range(3):
                force[i, r] *= mass[i]
            for r in range(3):
                arm[r] = frames[i, 0, r] * spin[i, 0] + frames[i, 1, r] * spin[i, 1] + frames[i, 2, r] * spin[i, 2]
                room[r] = (
                    frames[i, 0, r] * spin_rate[i, 0]
                    + frames[i, 1, r] * spin_rate[i, 1]
                    + frames[i, 2, r] * spin_rate[i, 2]
                )
            for r in range(3):
                I_spin[r] = inertia[i, r, 0] * arm[0] + inertia[i, r, 1] * arm[1] + inertia[i, r, 2] * arm[2]
                I_rate[r] = inertia[i, r, 0] * room[0] + inertia[i, r, 1] * room[1] + inertia[i, r, 2] * room[2]
            for r in range(3):
                arm[r] = frames[i, r, 0] * I_spin[0] + frames[i, r, 1] * I_spin[1] + frames[i, r, 2] * I_spin[2]
                moment[i, r] = frames[i, r, 0] * I_rate[0] + frames[i, r, 1] * I_rate[1] + frames[i, r, 2] * I_rate[2]
            add_cross(moment[i], spin[i], arm)
            add_cross(moment[i], c[i], force[i])
        if carrier >= 0:
            place(frames, carrier, tip, X_tip)
            for r in range(3):
                arm[r] = X_tip[r, 3] - frames[carrier, r, 3]
                room[r] = -wrench[k, r]
                moment[carrier, r] -= wrench[k, 3 + r]
                force[carrier, r] += room[r]
            add_cross(moment[carrier], arm, room)
        for i in range(count - 1, -1, -1):
            p = parent[i]
            total = 0.0
            for r in range(3):
                total += z[i, r] * (force[i, r] if prismatic[i] == 1 else moment[i, r])
            out[k, i] = total
            if p >= 0:
                for r in range(3):
                    arm[r] = frames[i, r, 3] - frames[p, r, 3]
                    force[p, r] += force[i, r]
                    moment[p, r] += moment[i, r]
                add_cross(moment[p], arm, force[i])
