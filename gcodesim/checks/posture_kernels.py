"""Whether bodies of a machine are in each other in one posture after the other."""

from __future__ import annotations

import numpy as np

from gcodesim.checks.box_kernels import SeenFrame, boxes_come_near
from gcodesim.checks.gap_kernels import Convexes, GapRoom, Ints
from gcodesim.checks.meeting_kernels import Forest, Walk
from gcodesim.checks.way_kernels import Couple, JointTree, WayColumns, WayRoom, seen_from
from gcodesim.compiled import kernel
from gcodesim.kinematics.tree_kernels import joint_frames


@kernel
def touching(
    pairs: Ints,
    level: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
) -> Ints:
    """Which of `pairs` (p, 2), roots of trees, is the first below `level` [m] at each row of the way's q; -1: none."""
    couple, chain, way, forest, bodies = scene
    room, gaps = rooms
    sight = SeenFrame(np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3))
    out = np.full(way.q.shape[0], -1, dtype=np.int64)
    for k in range(way.q.shape[0]):
        for j in range(way.q.shape[1]):
            room.q[j] = way.q[k, j]
        joint_frames(room.q, chain.parent, chain.before, chain.axis, chain.prismatic, room.frames)
        for p in range(pairs.shape[0]):
            seen_from(room.frames, couple.common[p], couple.first[p], walk.Xa)
            seen_from(room.frames, couple.common[p], couple.second[p], walk.Xb)
            if boxes_come_near(pairs[p], level, forest, bodies, sight, walk, gaps, room.n):
                out[k] = p
                break
    return out
