"""Inverse dynamics of a tree by recursive Newton–Euler equations, compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Tree
from gcodesim.kinematics.tree_kernels import copy_row, joint_frames, place


class MovedBodies(NamedTuple):
    """What each joint moves by itself, in joint axes: mass (j,), centre (j, 3), inertia (j, 3, 3) about that."""

    mass: Array
    com: Array
    inertia: Array


class EffortRoom(NamedTuple):
    """What efforts of j joints are worked out in; vectors (j, 3) in base axes, of each body or joint.

    Joint `frames` (j, 4, 4), directions `z` of the axes, centres of mass `c` from the joints; angular velocity
    `spin`, its rate, and the acceleration of the joint's `origin`; force and moment that act on the body.
    Four vectors (3,) for whatever is at hand, and the pose (4, 4) of the tip.
    """

    frames: Array
    z: Array
    c: Array
    spin: Array
    spin_rate: Array
    origin: Array
    force: Array
    moment: Array
    arm: Array
    vector: Array
    I_spin: Array
    I_rate: Array
    X_tip: Array


@kernel(lean=True)
def add_cross(out: Array, a: Array, b: Array) -> None:
    """out += a × b, vectors (3,)."""
    out[0] += a[1] * b[2] - a[2] * b[1]
    out[1] += a[2] * b[0] - a[0] * b[2]
    out[2] += a[0] * b[1] - a[1] * b[0]


@kernel(lean=True)
def add_carried(out: Array, spin: Array, spin_rate: Array, arm: Array, room: Array) -> None:
    """out += α × r + ω × (ω × r): what a point at `arm` feels on a body that turns."""
    for r in range(3):
        room[r] = 0.0
    add_cross(room, spin, arm)
    add_cross(out, spin, room)
    add_cross(out, spin_rate, arm)


@kernel(inlined=True)
def room_for(count: int) -> EffortRoom:
    """Room for a tree of `count` joints."""
    frames, z, c = np.empty((count, 4, 4)), np.empty((count, 3)), np.empty((count, 3))
    spin, spin_rate, origin = np.empty((count, 3)), np.empty((count, 3)), np.empty((count, 3))
    force, moment = np.empty((count, 3)), np.empty((count, 3))
    return EffortRoom(
        frames, z, c, spin, spin_rate, origin, force, moment, np.empty(3), np.empty(3), np.empty(3), np.empty(3),
        np.empty((4, 4)),
    )  # fmt: skip


@kernel(lean=True, inlined=True)
def move_body(
    i: int, speed: float, acceleration: float, tree: Tree, com: Array, gravity: Array, room: EffortRoom
) -> None:
    """Motion of body `i` from that of the one that carries it and from its own joint."""
    axis, frames, vector = tree.axis, room.frames, room.vector
    z, c, spin, spin_rate, origin, arm = room.z, room.c, room.spin, room.spin_rate, room.origin, room.arm
    p = tree.parent[i]
    for r in range(3):
        z[i, r] = frames[i, r, 0] * axis[i, 0] + frames[i, r, 1] * axis[i, 1] + frames[i, r, 2] * axis[i, 2]
        c[i, r] = frames[i, r, 0] * com[i, 0] + frames[i, r, 1] * com[i, 1] + frames[i, r, 2] * com[i, 2]
        spin[i, r] = spin[p, r] if p >= 0 else 0.0
        spin_rate[i, r] = spin_rate[p, r] if p >= 0 else 0.0
        origin[i, r] = origin[p, r] if p >= 0 else -gravity[r]
        arm[r] = frames[i, r, 3] - (frames[p, r, 3] if p >= 0 else 0.0)
    add_carried(origin[i], spin[i], spin_rate[i], arm, vector)
    for r in range(3):
        vector[r] = z[i, r] * speed
    if tree.prismatic[i] == 1:
        add_cross(origin[i], spin[i], vector)
        add_cross(origin[i], spin[i], vector)  # twice: Coriolis
        for r in range(3):
            origin[i, r] += z[i, r] * acceleration
    else:
        add_cross(spin_rate[i], spin[i], vector)
        for r in range(3):
            spin_rate[i, r] += z[i, r] * acceleration
            spin[i, r] += vector[r]


@kernel(lean=True, inlined=True)
def balance_body(i: int, mass: float, inertia: Array, room: EffortRoom) -> None:
    """Force and moment that keep body `i` in its motion; `inertia` (3, 3) of that body."""
    frames, c, spin, spin_rate, force, moment = room.frames, room.c, room.spin, room.spin_rate, room.force, room.moment
    arm, vector, I_spin, I_rate = room.arm, room.vector, room.I_spin, room.I_rate
    copy_row(room.origin[i], force[i])
    add_carried(force[i], spin[i], spin_rate[i], c[i], vector)
    for r in range(3):
        force[i, r] *= mass
    for r in range(3):
        arm[r] = frames[i, 0, r] * spin[i, 0] + frames[i, 1, r] * spin[i, 1] + frames[i, 2, r] * spin[i, 2]
        vector[r] = (
            frames[i, 0, r] * spin_rate[i, 0] + frames[i, 1, r] * spin_rate[i, 1] + frames[i, 2, r] * spin_rate[i, 2]
        )
    for r in range(3):
        I_spin[r] = inertia[r, 0] * arm[0] + inertia[r, 1] * arm[1] + inertia[r, 2] * arm[2]
        I_rate[r] = inertia[r, 0] * vector[0] + inertia[r, 1] * vector[1] + inertia[r, 2] * vector[2]
    for r in range(3):
        arm[r] = frames[i, r, 0] * I_spin[0] + frames[i, r, 1] * I_spin[1] + frames[i, r, 2] * I_spin[2]
        moment[i, r] = frames[i, r, 0] * I_rate[0] + frames[i, r, 1] * I_rate[1] + frames[i, r, 2] * I_rate[2]
    add_cross(moment[i], spin[i], arm)
    add_cross(moment[i], c[i], force[i])


@kernel(lean=True, inlined=True)
def load_tip(carrier: int, tip: Array, wrench: Array, room: EffortRoom) -> None:
    """Take `wrench` (6,), which acts at the tip, off the force and moment of the body that carries it."""
    frames, force, moment, arm, vector = room.frames, room.force, room.moment, room.arm, room.vector
    X_tip = room.X_tip
    place(frames, carrier, tip, X_tip)
    for r in range(3):
        arm[r] = X_tip[r, 3] - frames[carrier, r, 3]
        vector[r] = -wrench[r]
        moment[carrier, r] -= wrench[3 + r]
        force[carrier, r] += vector[r]
    add_cross(moment[carrier], arm, vector)


@kernel(lean=True, inlined=True)
def gather_efforts(tree: Tree, room: EffortRoom, out: Array) -> None:
    """From the tips inwards: the effort `out` (j,) of each joint, and what it hands on to the one that carries it."""
    parent, prismatic = tree.parent, tree.prismatic
    frames, z, force, moment, arm = room.frames, room.z, room.force, room.moment, room.arm
    for i in range(out.shape[0] - 1, -1, -1):
        p = parent[i]
        total = 0.0
        for r in range(3):
            total += z[i, r] * (force[i, r] if prismatic[i] == 1 else moment[i, r])
        out[i] = total
        if p >= 0:
            for r in range(3):
                arm[r] = frames[i, r, 3] - frames[p, r, 3]
                force[p, r] += force[i, r]
                moment[p, r] += moment[i, r]
            add_cross(moment[p], arm, force[i])


@kernel(lean=True)
def fill_efforts(
    q: Array, qd: Array, qdd: Array, wrench: Array, gravity: Array, bodies: MovedBodies, tree: Tree, tip: Array,
    room: EffortRoom, out: Array,
) -> None:  # fmt: skip
    """The loop of `efforts_along`, which has made all arrays, so that none is counted at each row."""
    carrier = tree.flange_carrier
    for k in range(q.shape[0]):
        stays = k > 0
        for i in range(q.shape[1]):
            stays = stays and q[k, i] == q[k - 1, i]
        if not stays:
            joint_frames(q[k], tree.parent, tree.before, tree.axis, tree.prismatic, room.frames)
        for i in range(q.shape[1]):
            move_body(i, qd[k, i], qdd[k, i], tree, bodies.com, gravity, room)
            balance_body(i, bodies.mass[i], bodies.inertia[i], room)
        if carrier >= 0:
            load_tip(carrier, tip, wrench[k], room)
        gather_efforts(tree, room, out[k])


@kernel
def efforts_along(
    q: Array, qd: Array, qdd: Array, wrench: Array, gravity: Array, bodies: MovedBodies, tree: Tree, tip: Array,
    out: Array,
) -> None:  # fmt: skip
    """Efforts `out` (n, j) along q, qd, qdd (n, j) under `wrench` (n, 6) at the tip, base axes, acting on the tool.

    `tip` (4, 4) rides on the joint that carries the flange. Luh, Walker, Paul 1980: motion outwards with the
    base falling up, forces inwards. All vectors in base axes.
    """
    fill_efforts(q, qd, qdd, wrench, gravity, bodies, tree, tip, room_for(q.shape[1]), out)
