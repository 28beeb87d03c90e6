"""For how long something holds: in all, and at most at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array


class Lasting:
    """Times [ticks of the clock] during which each of j things holds, gathered window by window.

    `total` (j,) is all of it, `longest` (j,) the longest stretch without a break, `begin` (j,) when it holds first, -1:
    never.
    """

    def __init__(self, count: int) -> None:
        self.total = np.zeros(count, dtype=np.int64)
        self.longest = np.zeros(count, dtype=np.int64)
        self.begin = np.full(count, -1, dtype=np.int64)
        self._now = 0
        self._going = np.zeros(count, dtype=np.int64)  # the stretch that has not ended yet

    def add(self, holds: NDArray[np.bool_], ticks: NDArray[np.int64]) -> None:
        """Whether each thing holds in the next n steps (n, j), and the ticks (n,) that they take."""
        ever = holds.any(axis=0)
        self._going[~ever] = 0
        fresh = ever & (self.begin < 0)
        before = self._now + np.cumsum(ticks) - ticks
        self.begin[fresh] = before[holds[:, fresh].argmax(axis=0)]
        self._now += int(ticks.sum())
        for j in np.flatnonzero(ever):
            so_far = np.cumsum(ticks * holds[:, j])
            stretches = np.diff(np.concatenate([[-self._going[j]], so_far[~holds[:, j]], so_far[-1:]]))
            self.total[j] += so_far[-1]
            self.longest[j] = max(self.longest[j], stretches.max())
            self._going[j] = stretches[-1]

    def in_seconds(self, dt: float) -> tuple[Array, Array, Array]:
        """`total`, `longest` and `begin` (j,) where a tick takes `dt` [s]."""
        total, longest, begin = (ticks.astype(np.float64) for ticks in (self.total, self.longest, self.begin))
        return total * dt, longest * dt, begin * dt


def in_words(total: float, longest: float) -> str:
    """Seconds as messages say them."""
    if total == longest:
        return f"{total:.3f} s"
    return f"{total:.3f} s in all, {longest:.3f} s at most at a time"
