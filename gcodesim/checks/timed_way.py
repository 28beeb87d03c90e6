"""The joints of a whole cell over time, straight between its nodes up to a bound that is known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import applied
from gcodesim.checks.meetings import JointWay
from gcodesim.frames import Array

SLACK: Final = 1e-5
"""How far [m] a body may be from where the straight way of the joints puts it."""

_GRID: Final = 0.1  # [s] between nodes to begin with, besides the ends of pieces
_SAFETY: Final = 1.3  # what a curve leaves its chord by, over what it does so at three places
_ROUNDS: Final = 6
_MOST_PARTS: Final = 64  # of one stretch in one round
_SHARES: Final = (0.25, 0.5, 0.75)

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
        for last in range(_ROUNDS):
            q0, q1 = q[:-1], q[1:]
            bend = _SAFETY * _leaves(joints, nodes, q0, q1)
            slack = applied(bend, reach) if last < _ROUNDS - 1 else np.zeros(len(bend))
            parts = np.clip(np.ceil(np.sqrt(slack / SLACK)), 1, _MOST_PARTS).astype(np.int64)
            if not (parts > 1).any():
                break
            nodes = _split(nodes, parts)
            q = joints(nodes)
        return TimedWay(nodes, JointWay(np.ascontiguousarray(q), bend))

    def part(self, begin: float, end: float) -> TimedWay:
        """From one node to another, by their times."""
        a, b = (int(np.searchsorted(self.time, at - 1e-12)) for at in (begin, end))
        b = min(b, len(self.time) - 1)
        return TimedWay(self.time[a : b + 1], JointWay(self.way.q[a : b + 1], self.way.bend[a:b]))

    def at(self, stretch: int, share: float) -> float:
        """The time [s] at a share of a stretch."""
        return float(self.time[stretch] + share * (self.time[stretch + 1] - self.time[stretch]))


def _leaves(joints: JointsAt, nodes: Array, q0: Array, q1: Array) -> Array:
    """How far (n, j) the joints are from the straight line in time between nodes, at three places of each stretch."""
    inner = np.stack([nodes[:-1] + share * np.diff(nodes) for share in _SHARES], axis=1)
    q = joints(inner.ravel()).reshape(len(q0), len(_SHARES), -1)
    off = [np.abs(q[:, i] - q0 - share * (q1 - q0)) for i, share in enumerate(_SHARES)]
    most: Array = np.maximum.reduce(off)
    return most


def _split(nodes: Array, parts: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Array:
    """Each stretch in so many equal parts."""
    own = np.repeat(np.arange(len(parts)), parts)
    number = np.arange(len(own)) - np.repeat(np.cumsum(parts) - parts, parts)
    step = np.diff(nodes) / parts
    return np.append(nodes[own] + number * step[own], nodes[-1])
