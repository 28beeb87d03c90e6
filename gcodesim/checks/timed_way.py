"""The joints of a whole cell over time, straight between its nodes up to a bound that is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied
from gcodesim.checks.meetings import JointWay
from gcodesim.frames import Array

SLACK: Final = 1e-5
"""How far [m] a body may be from where the straight way of the joints puts it."""

_GRID: Final = 0.1  # [s] between nodes to begin with, besides the ends of pieces
_SAFETY: Final = 1.3  # what a curve leaves its chord by, over what it does so at three places
_ROUNDS: Final = 5  # in which stretches are divided at the most
_MOST_PARTS: Final = 64  # of one stretch in one round
_SHARES: Final = (0.25, 0.5, 0.75)
_BLOCK: Final = 5_000  # stretches that are asked at once: a program of an hour has a hundred times as many

JointsAt = Callable[[Array], Array]
"""Joints (n, j) at times (n,) [s], which increase."""


@dataclass(frozen=True, eq=False)
class TimedWay:
    """The joints at times `time` (n + 1,) [s], and what they may leave the straight way between these by."""

    time: Array
    way: JointWay

    @staticmethod
    def of(joints: JointsAt, times: Array, reach: Array) -> TimedWay:
        """With nodes at `times`, and so many more that no body leaves the way by more than `SLACK`; `reach` (j,)."""
        nodes = distinct(np.concatenate([times, np.arange(times[0], times[-1], _GRID)]))
        q = joints(nodes)
        bend = _leaves(joints, nodes[:-1], nodes[1:], q[:-1], q[1:])
        for _ in range(_ROUNDS):
            parts = np.clip(np.ceil(np.sqrt(applied(bend, reach) / SLACK)), 1, _MOST_PARTS).astype(np.int64)
            if not (parts > 1).any():
                break
            nodes, q, bend = _divided(joints, nodes, q, bend, parts)
        return TimedWay(nodes, JointWay(np.ascontiguousarray(q), bend))

    def part(self, begin: float, end: float) -> TimedWay:
        """From one node to another, by their times."""
        a, b = (int(np.searchsorted(self.time, at - 1e-12)) for at in (begin, end))
        b = min(b, len(self.time) - 1)
        return TimedWay(self.time[a : b + 1], JointWay(self.way.q[a : b + 1], self.way.bend[a:b]))

    def at(self, stretch: int, share: float) -> float:
        """The time [s] at a share of a stretch."""
        return float(self.time[stretch] + share * (self.time[stretch + 1] - self.time[stretch]))


def _leaves(joints: JointsAt, begin: Array, end: Array, q0: Array, q1: Array) -> Array:
    """How far (n, j) joints leave the straight line in time from one node to another: `_SAFETY` times what they do so

    at three places of each stretch.
    """
    most = np.empty_like(q0)
    for first in range(0, len(q0), _BLOCK):
        rows = slice(first, first + _BLOCK)
        low, high, t0, t1 = q0[rows], q1[rows], begin[rows], end[rows]
        inner = np.stack([t0 + share * (t1 - t0) for share in _SHARES], axis=1)
        q = joints(inner.ravel()).reshape(len(low), len(_SHARES), -1)
        off = [np.abs(q[:, i] - low - share * (high - low)) for i, share in enumerate(_SHARES)]
        most[rows] = _SAFETY * np.maximum.reduce(off)
    return most


def _divided(
    joints: JointsAt, nodes: Array, q: Array, bend: Array, parts: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """Each stretch in so many equal parts: nodes, joints, what they leave. Only where it is divided they are asked."""
    own = np.repeat(np.arange(len(parts)), parts)
    number = np.arange(len(own)) - np.repeat(np.cumsum(parts) - parts, parts)
    step = np.diff(nodes) / parts
    times = np.append(nodes[own] + number * step[own], nodes[-1])
    values, leaves = np.append(q[own], q[-1:], axis=0), bend[own]
    inner, fresh = np.flatnonzero(number > 0), np.flatnonzero(parts[own] > 1)
    values[inner] = joints(times[inner])
    leaves[fresh] = _leaves(joints, times[fresh], times[fresh + 1], values[fresh], values[fresh + 1])
    return times, values, leaves
