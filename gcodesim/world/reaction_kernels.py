"""The wrench between flange and tool along a path, compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Tree
from gcodesim.kinematics.tree_kernels import fill_jacobian, joint_frames, place


class FlangeLoad(NamedTuple):
    """A rigid body on the flange F: mass [kg], centre of mass (3,) and tip (3,) in F [m], inertia (3, 3) there."""

    mass: float
    com: Array
    tip: Array
    inertia: Array


class ReactionRoom(NamedTuple):
    """What `reactions` works in: joint frames (j, 4, 4), flange (4, 4), Jacobian (6, j), twist (6,), the rotation of
    the flange times an inertia (3, 3), and vectors (3,) of this row and of the one before."""

    frames: Array
    flange: Array
    J: Array
    twist: Array
    turned: Array
    lever: Array
    tip: Array
    v_com: Array
    v_before: Array
    momentum: Array
    momentum_before: Array


@kernel(inlined=True)
def reaction_room(count: int) -> ReactionRoom:
    """Room for a tree of `count` joints."""
    return ReactionRoom(
        np.empty((count, 4, 4)), np.empty((4, 4)), np.empty((6, count)), np.empty(6), np.empty((3, 3)),
        np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3),
    )  # fmt: skip


@kernel(lean=True)
def turn_into(R: Array, v: Array, out: Array) -> None:
    """out = R v, of matrices (3, 3) or larger."""
    for r in range(3):
        out[r] = R[r, 0] * v[0] + R[r, 1] * v[1] + R[r, 2] * v[2]


@kernel(lean=True)
def move_load(q: Array, qd: Array, tree: Tree, load: FlangeLoad, room: ReactionRoom) -> None:
    """Velocity of the centre of mass, angular momentum, lever and tip in base axes at joints q, qd (j,)."""
    frames, flange, J, twist, turned = room.frames, room.flange, room.J, room.twist, room.turned
    lever, v_com, momentum = room.lever, room.v_com, room.momentum
    joint_frames(q, tree.parent, tree.before, tree.axis, tree.prismatic, frames)
    place(frames, tree.flange_carrier, tree.flange_offset, flange)
    fill_jacobian(frames, tree.axis, tree.prismatic, tree.path, flange[0, 3], flange[1, 3], flange[2, 3], J)
    for r in range(6):
        total = J[r, 0] * qd[0]
        for i in range(1, qd.shape[0]):
            total += J[r, i] * qd[i]
        twist[r] = total
    turn_into(flange, load.com, lever)
    turn_into(flange, load.tip, room.tip)
    v_com[0] = twist[0] + (twist[4] * lever[2] - twist[5] * lever[1])
    v_com[1] = twist[1] + (twist[5] * lever[0] - twist[3] * lever[2])
    v_com[2] = twist[2] + (twist[3] * lever[1] - twist[4] * lever[0])
    inertia = load.inertia
    for r in range(3):
        for k in range(3):
            turned[r, k] = flange[r, 0] * inertia[0, k] + flange[r, 1] * inertia[1, k] + flange[r, 2] * inertia[2, k]
    for r in range(3):
        total = 0.0
        for k in range(3):
            moment = turned[r, 0] * flange[k, 0] + turned[r, 1] * flange[k, 1] + turned[r, 2] * flange[k, 2]
            total = total + moment * twist[3 + k] if k else moment * twist[3]
        momentum[r] = total


@kernel(lean=True)
def fill_reactions(
    q: Array, qd: Array, wrench: Array, gravity: Array, dt: float, tree: Tree, load: FlangeLoad, room: ReactionRoom,
    out: Array,
) -> None:  # fmt: skip
    """The loop of `reactions`, which has made all arrays."""
    lever, tip = room.lever, room.tip
    for k in range(q.shape[0]):
        for r in range(3):
            room.v_before[r], room.momentum_before[r] = room.v_com[r], room.momentum[r]
        move_load(q[k], qd[k], tree, load, room)
        if k == 0:
            continue
        w, row = wrench[k - 1], out[k - 1]
        weighted_x = load.mass * ((room.v_com[0] - room.v_before[0]) / dt - gravity[0])
        weighted_y = load.mass * ((room.v_com[1] - room.v_before[1]) / dt - gravity[1])
        weighted_z = load.mass * ((room.v_com[2] - room.v_before[2]) / dt - gravity[2])
        row[0], row[1], row[2] = weighted_x - w[0], weighted_y - w[1], weighted_z - w[2]
        row[3] = (room.momentum[0] - room.momentum_before[0]) / dt + (lever[1] * weighted_z - lever[2] * weighted_y)
        row[4] = (room.momentum[1] - room.momentum_before[1]) / dt + (lever[2] * weighted_x - lever[0] * weighted_z)
        row[5] = (room.momentum[2] - room.momentum_before[2]) / dt + (lever[0] * weighted_y - lever[1] * weighted_x)
        row[3] = row[3] - (tip[1] * w[2] - tip[2] * w[1]) - w[3]
        row[4] = row[4] - (tip[2] * w[0] - tip[0] * w[2]) - w[4]
        row[5] = row[5] - (tip[0] * w[1] - tip[1] * w[0]) - w[5]


@kernel
def reactions(
    q: Array, qd: Array, wrench: Array, gravity: Array, dt: float, tree: Tree, load: FlangeLoad, out: Array
) -> None:
    """Wrenches `out` (n, 6) of the flange on its load: see `tool_reaction`, which has the same arguments."""
    fill_reactions(q, qd, wrench, gravity, dt, tree, load, reaction_room(q.shape[1]), out)
