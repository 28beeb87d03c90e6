"""Efforts of several motions through the same places, compiled: the frames of a place are worked out once."""

from __future__ import annotations

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Tree
from gcodesim.kinematics.dynamics_kernels import (
    EffortRoom,
    MovedBodies,
    balance_body,
    gather_efforts,
    load_tip,
    move_body,
    room_for,
)
from gcodesim.kinematics.tree_kernels import joint_frames


@kernel(lean=True)
def fill_motions(
    q: Array, qd: Array, qdd: Array, wrench: Array, gravity: Array, bodies: MovedBodies, tree: Tree, tip: Array,
    room: EffortRoom, out: Array,
) -> None:  # fmt: skip
    """The loop of `efforts_of_motions`, which has made all arrays, so that none is counted at each row."""
    carrier, alone = tree.flange_carrier, wrench.shape[0] == 1
    for k in range(q.shape[0]):
        joint_frames(q[k], tree.parent, tree.before, tree.axis, tree.prismatic, room.frames)
        for m in range(qd.shape[0]):
            for i in range(q.shape[1]):
                move_body(i, qd[m, k, i], qdd[m, k, i], tree, bodies.com, gravity, room)
                balance_body(i, bodies.mass[i], bodies.inertia[i], room)
            if carrier >= 0:
                load_tip(carrier, tip, wrench[0 if alone else k], room)
            gather_efforts(tree, room, out[m, k])


@kernel
def efforts_of_motions(
    q: Array, qd: Array, qdd: Array, wrench: Array, gravity: Array, bodies: MovedBodies, tree: Tree, tip: Array,
    out: Array,
) -> None:  # fmt: skip
    """Efforts `out` (m, n, j) of m motions qd, qdd (m, n, j) through joints q (n, j), as `efforts_along` has them.

    `wrench` (n, 6), or (1, 6) for all places, acts on the tool at its `tip` (4, 4), base axes.
    """
    fill_motions(q, qd, qdd, wrench, gravity, bodies, tree, tip, room_for(q.shape[1]), out)
