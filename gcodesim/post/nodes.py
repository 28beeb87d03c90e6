"""Where an arm is at the programmed points of a plan, and on the way between them."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.frames import Array, Pose, rotation_about
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ARC, HOME, RAPID
from gcodesim.planning.guide import GROUND
from gcodesim.post.moves import ArmPlace

if TYPE_CHECKING:
    from gcodesim.kinematics.assembly import Assembly
    from gcodesim.kinematics.protocol import Kinematics
    from gcodesim.motion.trajectory import Samples
    from gcodesim.planning.arm_joints import ArmJoints
    from gcodesim.planning.plan import Plan

_INSIDE: Final = 1e-9  # [s] before the end of a row, where its own piece still lasts
_FINE: Final = 4e-3  # [rad, m] of any joint between two samples of a way
_FEWEST, _MOST = 8, 4096  # samples of a way
_AT_REST: Final = 1e-9  # [m/s]


@frozen(slots=False, eq=False)
class PlannedArm:
    """A plan of an arm, asked for places; `joints` is its joint path."""

    plan: Plan
    joints: ArmJoints

    @property
    def assembly(self) -> Assembly | None:
        """The arm with its external axes; None without any."""
        guide = self.joints.flange.guide
        return None if guide is None or guide.outside is None else guide.outside.assembly

    @property
    def arm(self) -> Kinematics:
        """The arm alone."""
        return self.joints.kinematics if self.assembly is None else self.assembly.arm

    @property
    def keeps_attitude(self) -> bool:
        """Whether the tool keeps its attitude and nothing else moves, so that a line is a line for any control."""
        return self.joints.flange.guide is None and self.joints.flange.turning is None

    @cached_property
    def _ends(self) -> Samples:
        """The trajectory at the end of each row (n)."""
        t = self.plan.trajectory
        return t.sample(t.row_end - np.minimum(_INSIDE, 0.5 * (t.row_end - t.row_start)))

    @cached_property
    def _q_ends(self) -> Array:
        return self.plan.joints(self._ends)

    @cached_property
    def goes_on(self) -> NDArray[np.bool_]:
        """Whether the arm moves at the end of each row (n,)."""
        t = self.plan.trajectory
        moving: NDArray[np.bool_] = t.sample(t.row_end).speed > _AT_REST
        return moving & (self._ends.speed > _AT_REST)

    @cached_property
    def zones(self) -> Array:
        """How far [m] before the end of each row (n,) its rounded corner begins, or after it ends if that is less; NaN
        where there is none."""
        pieces, path = self.joints.flange.pieces, self.plan.path
        zones = np.full(len(path), np.nan)
        for piece in np.flatnonzero(pieces.joint & ~pieces.fixed):
            row = int(pieces.row_first[piece])
            sides = pieces.points(np.array([piece, piece]), np.array([0.0, pieces.length[piece]]))[0]
            zones[row] = min(norm(side[:3] - path.end[row, :3]) for side in sides)
        return zones

    def by_joints(self, row: int) -> bool:
        """Whether a row is a move by joints."""
        return bool(self.joints.flange.pieces.fixed[self._ends.piece[row]])

    def share_of_joints(self, row: int) -> float:
        """Of such a row: the share of its greatest speed that the joint has which comes nearest to it."""
        move = self.joints.moves[int(self._ends.piece[row])]
        return float((np.abs(move.end - move.start) * move.peak / self.plan.kinematics.joints.speed).max())

    def feeds_tip(self, row: int) -> bool:
        """Whether the program says how fast the tip goes in a row."""
        path = self.plan.path
        fast = path.kind[row] in (RAPID, HOME) or not np.isfinite(path.feed[row])
        return not fast and not path.rotary_feed[row] and bool(path.length[row] > 0.0)

    def work_rests(self, row: int) -> bool:
        """Whether no external axis carries the work of a row."""
        guide = self.joints.flange.guide
        return guide is None or bool(guide.platform[row] == GROUND)

    def greatest_speed(self, row: int) -> float:
        """Of the controlled point [m/s], at nine moments of a row."""
        t = self.plan.trajectory
        times = t.row_start[row] + (t.row_end[row] - t.row_start[row]) * np.arange(1, 10) / 10.0
        return max(norm(v) for v in t.sample(times).velocity[:, :3])

    def begin(self) -> ArmPlace:
        """Where the arm stands first."""
        return self._place(self.plan.joints(self.plan.trajectory.sample(np.zeros(1)))[0], 0)

    def end_of(self, row: int) -> ArmPlace:
        """The point that is programmed as the end of a row, whether the corner there is rounded or not."""
        if self.by_joints(row):
            return self._place(self.joints.moves[int(self._ends.piece[row])].end, row)
        own = slice(row, row + 1)
        return self._solved(self._ends.piece[own], self._ends.s[own], self.plan.path.end[own], self._q_ends[row], row)

    def at(self, row: int, share: float) -> ArmPlace:
        """The place that is programmed at a share 0…1 of the way of a row that is no move by joints."""
        t = self.plan.trajectory
        near = t.sample(np.array([t.row_start[row] + share * (t.row_end[row] - t.row_start[row])]))
        position = self._position(row, share)[None]
        return self._solved(near.piece, near.s, position, self.plan.joints(near)[0], row)

    def _solved(self, piece: NDArray[np.int64], s: Array, position: Array, seed: Array, row: int) -> ArmPlace:
        """Where the arm is when the controlled point is at `position` (1, 6)."""
        flange = self.joints.flange
        X = flange.poses(piece, s, position)
        guide = flange.guide
        if guide is None or guide.outside is None:
            return self._place(self.joints.kinematics.inverse(X, seed)[0][0], row)
        assembly = guide.outside.assembly
        q = assembly.arm.inverse(X, seed[assembly.own])[0]
        return self._place(assembly.together(q, guide.outside.values(piece, s, position))[0], row)

    def _position(self, row: int, share: float) -> Array:
        """The programmed point (6,) there."""
        path = self.plan.path
        point: Array = path.start[row] + share * (path.end[row] - path.start[row])
        if path.kind[row] == ARC:
            n, c = path.normal[row], path.center[row]
            begin, end = path.start[row, :3] - c, path.end[row, :3] - c
            lifts = dot(begin, n), dot(end, n)
            first, last = begin - lifts[0] * n, end - lifts[1] * n
            grown = 1.0 + share * (norm(last) / norm(first) - 1.0) if norm(first) > 0.0 else 1.0
            flat = grown * applied(rotation_about(n, share * float(path.sweep[row])), first)
            point[:3] = c + flat + (lifts[0] + share * (lifts[1] - lifts[0])) * n
        return point

    def way(self, row: int) -> tuple[Array, list[ArmPlace]]:
        """Times [s] and places of a row as it is run, without rounded corners, close to each other."""
        t = self.plan.trajectory
        t0, t1 = float(t.row_start[row]), float(t.row_end[row])
        ends = self.plan.joints(t.sample(np.array([t0, 0.5 * (t0 + t1), t1])))
        travel = float(np.abs(np.diff(ends, axis=0)).sum(axis=0).max())
        count = int(np.clip(np.ceil(travel / _FINE), _FEWEST, _MOST))
        samples = t.sample(t0 + (t1 - t0) * np.arange(1, count) / count)
        pieces = self.joints.flange.pieces
        plain = ~(pieces.joint & ~pieces.fixed)[samples.piece]
        q = self.plan.joints(samples)[plain]
        X = self.plan.tip(q, np.full(len(q), row, dtype=np.int64))
        return samples.time[plain], [self._split(joints, tip) for joints, tip in zip(q, X, strict=True)]

    def tip_at(self, row: int, q: Array, externals: Array) -> Array:
        """X_BT (4, 4) with the tool of a row at these joints of the arm and external axes."""
        joints = q[None] if self.assembly is None else self.assembly.together(q[None], externals[None])
        X: Array = self.plan.tip(joints, np.array([row]))[0]
        return X

    def _place(self, q: Array, row: int) -> ArmPlace:
        return self._split(q, self.plan.tip(q[None], np.array([row]))[0])

    def _split(self, q: Array, X_BT: Array) -> ArmPlace:
        if self.assembly is None:
            return ArmPlace(X_BT=Pose.from_matrix(X_BT), q=q, externals=np.zeros(0))
        own, outside = q[self.assembly.own], q[self.assembly.externals]
        return ArmPlace(X_BT=Pose.from_matrix(X_BT), q=own, externals=outside)
