"""When bodies of a machine meet each other, or bodies that stand still, anywhere along a path of its joints."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import inverse_pose, multiplied, norms
from gcodesim.checks.gap_kernels import RELATIVE, Convexes
from gcodesim.checks.rigid import RigidBody, Woods
from gcodesim.checks.search_kernels import PairSearch
from gcodesim.checks.way_kernels import Couple, JointTree, WayColumns, way_room
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import Tree

if TYPE_CHECKING:
    from gcodesim.checks.meeting_kernels import Meetings

TOUCH: Final = 1e-6
"""Bodies that enter each other by less than this [m] only touch."""

EXACT: Final = 1e-6
"""By how much [m] the gap of a meeting may be above the least on the way."""

SHARE: Final = 2e-4
"""The same for the least gap of all pairs, as a share of itself."""

HELD: Final = 4096
"""Nodes of a way at which the frames of joints are kept."""

MOST: Final = 4096
"""Meetings that one search finds at most."""


@frozen(kw_only=False, eq=False)
class JointWay:
    """A way of the joints: straight between `q` (n + 1, j) [rad, m]; it may leave that by `bend` (n, j)."""

    q: Array
    bend: Array

    @staticmethod
    def straight(q: Array) -> JointWay:
        """Through joints (n, j), exactly straight in between; one row is a machine at rest."""
        q = np.ascontiguousarray(q, dtype=float)
        if len(q) == 1:
            q = np.repeat(q, 2, axis=0)
        return JointWay(q, np.zeros((len(q) - 1, q.shape[1])))

    def at(self, stretch: int, share: float) -> Array:
        """Joints (j,) at a share of a stretch."""
        q: Array = self.q[stretch] + share * (self.q[stretch + 1] - self.q[stretch])
        return q


@frozen
class Meeting:
    """Bodies `first` and `second` (their numbers) are nearer than a level, from `share` of `stretch` on to `last`.

    `gap` [m] is the least, at `deepest`, a share of another stretch; negative: how deep they are in each other.
    """

    first: int
    second: int
    stretch: int
    share: float
    last: int
    deepest: tuple[int, float]
    gap: float


@frozen(slots=False, kw_only=False, eq=False)
class MovingBodies:
    """Bodies on the joints of a machine, and those pairs (p, 2) of them that may not meet.

    Who searches often for the same bodies hands their `woods` in; `carrier` (b,) are other joints than their own.
    """

    tree: Tree | JointTree
    bodies: Sequence[RigidBody]
    pairs: NDArray[np.int64]
    woods: Woods | None = None
    carrier: NDArray[np.int64] | None = None

    def of_pairs(self, pairs: Sequence[tuple[int, int]]) -> MovingBodies:
        """The same bodies, for other pairs of them."""
        return replace(self, pairs=np.array(pairs, dtype=np.int64).reshape(-1, 2), woods=self._woods)

    @cached_property
    def _woods(self) -> Woods:
        return self.woods or Woods.of(self.bodies)

    @cached_property
    def _carrier(self) -> NDArray[np.int64]:
        if self.carrier is not None:
            return self.carrier
        return np.array([body.carrier for body in self.bodies], dtype=np.int64)

    @cached_property
    def chain(self) -> JointTree:
        """The joints as kernels take them."""
        tree = self.tree
        before, axis = np.ascontiguousarray(tree.before), np.ascontiguousarray(tree.axis)
        return JointTree(np.ascontiguousarray(tree.parent), before, axis, np.ascontiguousarray(tree.prismatic))

    def _carried_by(self, joint: int) -> list[int]:
        """Joints that move what `joint` carries, the outermost first."""
        found = []
        while joint >= 0:
            found.append(joint)
            joint = int(self.tree.parent[joint])
        return found

    def couple(self, travel: Array) -> Couple:
        """The pairs with bounds for joints that shift by no more than `travel` (j,) [m]."""
        carrier, pairs = self._carrier, self.pairs
        reach = np.zeros((len(pairs), len(self.tree.parent)))
        side = np.zeros(reach.shape, dtype=np.int64)
        common = np.full(len(pairs), -1, dtype=np.int64)
        offsets = norms(self.tree.before[:, :3, 3])
        for p, pair in enumerate(pairs):
            ways = [self._carried_by(int(carrier[body])) for body in pair]
            shared = set(ways[0]) & set(ways[1])
            common[p] = max(shared, default=-1)
            for which, (body, way) in enumerate(zip(pair, ways, strict=True), 1):
                far = float(self._woods.far[body])
                for joint in way:
                    shifts = bool(self.tree.prismatic[joint])
                    if joint not in shared:
                        reach[p, joint], side[p, joint] = 1.0 if shifts else far, which
                    far += float(offsets[joint]) + (float(travel[joint]) if shifts else 0.0)
        first, second = carrier[pairs[:, 0]].copy(), carrier[pairs[:, 1]].copy()
        return Couple(first, second, common, reach, side)

    def table(self) -> tuple[Convexes, list[tuple[int, int]]]:
        """All convex bodies, and from where to where in this table those of each body are."""
        counts = [len(body.convexes.first) for body in self.bodies]
        ends = np.cumsum(counts).tolist()
        return self._woods.convexes, [(end - count, end) for end, count in zip(ends, counts, strict=True)]

    def search(
        self, way: JointWay, *, level: float = -TOUCH, followed: Callable[[list[Meeting]], Sequence[int]] | None = None
    ) -> list[Meeting]:
        """Every time that two of the bodies come nearer than `level` [m], in the order of the pairs and of the way.

        Nothing is missed that goes deeper than the level by more than what the way may leave its straight line. The gap
        of a meeting is the least of it on the straight way, to `EXACT` and a share of 1e-6 of itself. Who needs that of
        some only chooses by `followed`, from meetings with the gaps of their beginnings, by their places in the list.
        """
        from gcodesim.checks.couple_kernels import least_room
        from gcodesim.checks.meeting_kernels import complete, meet, meetings_room, touch_exactly, walk_room

        if not len(self.pairs) or not len(way.bend):
            return []
        found = meetings_room(MOST)
        search = self._search(way)
        meet(level, search, walk_room(len(self.pairs)), found)
        if level <= 0.0:
            touch_exactly(search, found)
        meetings = self._inside_at_start(way) if level <= 0.0 else []
        inside = {(meeting.first, meeting.second) for meeting in meetings}
        rows = [e for e in range(int(found.used[0])) if not (found.rows[e, 1] == 0 and self._pair(found, e) in inside)]
        which = range(len(rows)) if followed is None else followed([self._meeting(found, e) for e in rows])
        complete(np.array([rows[i] for i in which], dtype=np.int64), search, least_room(EXACT, RELATIVE), found)
        return meetings + [self._meeting(found, e) for e in rows]

    def _pair(self, found: Meetings, e: int) -> tuple[int, int]:
        """The bodies of meeting `e`."""
        first, second = self.pairs[found.rows[e, 0]].tolist()
        return first, second

    def _meeting(self, found: Meetings, e: int) -> Meeting:
        _, k, last, deepest, _, _ = found.rows[e].tolist()
        share, _, worst, gap = found.figures[e].tolist()
        first, second = self._pair(found, e)
        return Meeting(first=first, second=second, stretch=k, share=share, last=last, deepest=(deepest, worst), gap=gap)

    def touching(self, q: Array) -> NDArray[np.int64]:
        """Which of the pairs is the first whose bodies are in each other at joints q (n, j), for each row; −1: none."""
        from gcodesim.checks.posture_kernels import touching

        if not len(self.pairs) or not len(q):
            return np.full(len(q), -1, dtype=np.int64)
        search = self._search(JointWay(np.ascontiguousarray(q, dtype=float), np.zeros((0, q.shape[1]))))
        found: NDArray[np.int64] = touching(-TOUCH, search)
        return found

    def least_gap(self, way: JointWay, *, tolerance: float = EXACT) -> float:
        """The least gap [m] of all pairs on the way, inf without pairs; where bodies meet, some number not above 0.

        It is above the true one by `tolerance` and a share of 2e-4 at most.
        """
        from gcodesim.checks.couple_kernels import least_room
        from gcodesim.checks.least_kernels import lower_all

        if not len(self.pairs):
            return float("inf")
        if self._inside_at_start(way):
            return 0.0
        least = least_room(tolerance, SHARE)
        lower_all(self._search(way), least)
        return float(least.gap[0])

    def _search(self, way: JointWay) -> PairSearch:
        """What the kernels take."""
        from gcodesim.checks.descent_kernels import descent_room
        from gcodesim.checks.gap_kernels import gap_room

        woods, joints, nodes = self._woods, way.q.shape[1], min(len(way.q), HELD)
        couple = self.couple(np.abs(way.q).max(axis=0))
        return PairSearch(
            np.ascontiguousarray(woods.root[self.pairs]),
            couple,
            self.chain,
            WayColumns(np.ascontiguousarray(way.q), np.ascontiguousarray(way.bend)),
            woods.forest,
            woods.convexes,
            descent_room(woods.deepest),
            np.full(nodes, -1, dtype=np.int64),
            np.zeros((nodes, joints, 4, 4)),
            np.zeros(joints),
            way_room(joints),
            gap_room(),
        )

    def _inside_at_start(self, way: JointWay) -> list[Meeting]:
        """Pairs of which one body is inside a closed mesh of the other at the start, without touching its surface."""
        dented = [p for p, pair in enumerate(self.pairs) if any(self.bodies[body].dents for body in pair)]
        found = []
        frames = self._frames(way.q[0]) if dented else {}
        for p in dented:
            first, second = self.pairs[p].tolist()
            if self._is_inside(first, second, frames) or self._is_inside(second, first, frames):
                gap = -float(min(self._woods.far[first], self._woods.far[second]))
                found.append(
                    Meeting(first=first, second=second, stretch=0, share=0.0, last=0, deepest=(0, 0.0), gap=gap)
                )
        return found

    def _is_inside(self, inner: int, outer: int, frames: dict[int, Array]) -> bool:
        """Whether a point of one body is inside a mesh of the other."""
        one, other = self.bodies[inner], self.bodies[outer]
        if not other.dents:
            return False
        X = multiplied(inverse_pose(frames[int(self._carrier[outer])][None])[0], frames[int(self._carrier[inner])])
        points = multiplied(one.insides, X[:3, :3].T) + X[:3, 3]
        return any(mesh.holds_one_of(points) for mesh in other.dents)

    def _frames(self, q: Array) -> dict[int, Array]:
        """Poses (4, 4) of all joints and of the base, -1."""
        from gcodesim.kinematics.tree_kernels import joint_frames

        chain = self.chain
        out = np.zeros((len(q), 4, 4))
        joint_frames(np.ascontiguousarray(q), chain.parent, chain.before, chain.axis, chain.prismatic, out)
        return {-1: np.eye(4), **dict(enumerate(out))}
