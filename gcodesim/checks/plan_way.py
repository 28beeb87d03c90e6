"""A plan as a way of joints that is straight between its nodes, up to a bound that is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.batches import batches
from gcodesim.arithmetic.matrices import applied
from gcodesim.checks.meetings import JointWay
from gcodesim.frames import Array
from gcodesim.motion.curve_kernels import ROUND
from gcodesim.motion.pieces import OVERLAP, Pieces
from gcodesim.motion.trajectory import Samples

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan

SLACK: Final = 2e-6
"""How far [m] a body may be from where the straight way of the joints puts it."""

_SPACING: Final = 20e-3  # [m] between nodes to begin with
_BEND: Final = 0.3  # [rad] of direction between nodes on arcs
_SAFETY: Final = 1.3  # what a curve leaves its chord by, over what it does so half-way
_ROUNDS: Final = 3
_MOST_PARTS: Final = 400  # of one stretch in one round
_HALVINGS: Final = 60
_SAME: Final = 1e-12


@dataclass(frozen=True, eq=False)
class PlanWay:
    """The way of a plan; stretch i is from `s0` to `s1` (n,) of `piece` (n,)."""

    plan: Plan
    way: JointWay
    piece: NDArray[np.int64]
    s0: Array
    s1: Array

    @staticmethod
    def of(plan: Plan, reach: Array) -> PlanWay:
        """With nodes so close that no body leaves the straight way by more than `SLACK`; `reach` (j,) [m, 1]."""
        found = _Stretches.of(plan)
        for _ in range(_ROUNDS):
            slack = applied(found.bend, reach)
            parts = np.clip(np.ceil(np.sqrt(slack / SLACK)), 1, _MOST_PARTS).astype(np.int64)
            if not (parts > 1).any():
                break
            found = found.split(plan, parts)
        return found.joined(plan)

    def row(self, stretch: int) -> int:
        """Path row of a stretch."""
        pieces = self.plan.trajectory.pieces
        return int(pieces.row_first[self.piece[stretch]])

    def time(self, stretch: int, share: float) -> float:
        """When a share of a stretch is done [s]: nearly, since joints and path need not run alike within it."""
        trajectory = self.plan.trajectory
        piece = int(self.piece[stretch])
        s = float(self.s0[stretch] + share * (self.s1[stretch] - self.s0[stretch]))
        phases = trajectory.phases
        mine = np.flatnonzero((phases.piece == piece) & (phases.event < 0))
        if not len(mine):
            return 0.0
        low = float(phases.time[mine[0]])
        high = float(phases.time[mine[-1]] + phases.duration[mine[-1]])
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            sample = trajectory.sample(np.array([middle]))
            before = int(sample.piece[0]) < piece or (int(sample.piece[0]) == piece and float(sample.s[0]) < s)
            low, high = (middle, high) if before else (low, middle)
        return high


class _Stretches(NamedTuple):
    """Parts of pieces from `s0` to `s1` (n,), with joints (n, j) at both ends and in the middle."""

    piece: NDArray[np.int64]
    s0: Array
    s1: Array
    q0: Array
    middle: Array
    q1: Array

    @staticmethod
    def of(plan: Plan) -> _Stretches:
        piece, s0, s1 = _first_parts(plan.trajectory.pieces)
        return _Stretches(piece, s0, s1, *(_joints_at(plan, piece, s) for s in (s0, 0.5 * (s0 + s1), s1)))

    @property
    def bend(self) -> Array:
        """How far (n, j) the joints may leave the straight line between both ends."""
        return _SAFETY * _leaves(self.q0, self.middle, self.q1)

    def split(self, plan: Plan, parts: NDArray[np.int64]) -> _Stretches:
        """Each in so many equal parts; joints are asked for only where none are known."""
        piece, s0, s1 = _split(self.piece, self.s0, self.s1, parts)
        own = np.repeat(np.arange(len(parts)), parts)
        q0, middle, q1 = self.q0[own], self.middle[own], self.q1[own]
        inner = np.flatnonzero(own[1:] == own[:-1])  # ends within what was one stretch
        q1[inner] = q0[inner + 1] = _joints_at(plan, piece[inner], s1[inner])
        new = np.flatnonzero(parts[own] > 1)
        middle[new] = _joints_at(plan, piece[new], 0.5 * (s0 + s1)[new])
        return _Stretches(piece, s0, s1, q0, middle, q1)

    def joined(self, plan: Plan) -> PlanWay:
        """One way through all of them; where one does not begin where the last ended, a stretch between."""
        piece, s0, s1, q0, _, q1 = self
        gap = np.append(False, np.abs(q0[1:] - q1[:-1]).max(axis=1) > _SAME) if len(q0) else np.zeros(0, dtype=bool)
        at = np.flatnonzero(gap)
        nodes = np.concatenate([q0[:1], np.insert(q1, at, q0[at], axis=0)])
        way = JointWay(np.ascontiguousarray(nodes), np.insert(self.bend, at, 0.0, axis=0))
        return PlanWay(plan, way, np.insert(piece, at, piece[at]), np.insert(s0, at, s0[at]), np.insert(s1, at, s0[at]))


def _first_parts(pieces: Pieces) -> tuple[NDArray[np.int64], Array, Array]:
    """Every piece, long and bent ones in several parts."""
    curves = pieces.curves
    turn = np.where(curves.kind == ROUND, np.abs(curves.sweep) / np.maximum(curves.length, 1e-300), 0.0)[pieces.curve]
    wanted = np.maximum(np.where(pieces.fixed, 1.0, pieces.length / _SPACING), turn * pieces.length / _BEND)
    parts = np.maximum(np.ceil(wanted), np.where(pieces.kind == OVERLAP, 2, 1)).astype(np.int64)
    piece = np.arange(len(pieces), dtype=np.int64)
    return _split(piece, np.zeros(len(pieces)), pieces.length.astype(float), parts)


def _split(
    piece: NDArray[np.int64], s0: Array, s1: Array, parts: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Array, Array]:
    """Each stretch in so many equal parts."""
    own = np.repeat(np.arange(len(piece)), parts)
    number = np.arange(len(own)) - np.repeat(np.cumsum(parts) - parts, parts)
    step = (s1 - s0)[own] / parts[own]
    begin = s0[own] + number * step
    end = np.where(number + 1 == parts[own], s1[own], begin + step)
    return piece[own], begin, end


def _joints_at(plan: Plan, piece: NDArray[np.int64], s: Array) -> Array:
    """Joints (n, j) at places of pieces, in the order of the path."""
    pieces, n = plan.trajectory.pieces, len(piece)
    position, _ = pieces.points(piece, s)
    none = np.zeros(n)
    samples = Samples(
        time=none,
        position=position,
        velocity=np.zeros((n, 6)),
        piece=piece,
        s=s,
        fraction=s / np.maximum(pieces.length[piece], 1e-300),
        row=pieces.row_first[piece].astype(np.int64),
        speed=none,
        event=np.full(n, -1, dtype=np.int64),
    )
    return plan.joints(samples)


def _leaves(q0: Array, middle: Array, q1: Array) -> Array:
    """How far (n, j) the joints in the middle are from the straight line between both ends, wherever along it."""
    off = np.empty(q0.shape)
    for some in batches(len(q0)):
        way, step = middle[some] - q0[some], q1[some] - q0[some]
        square = np.sum(step * step, axis=1)
        share = np.clip(np.sum(way * step, axis=1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
        off[some] = np.abs(way - share[:, None] * step)
    return off
