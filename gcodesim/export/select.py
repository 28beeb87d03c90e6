"""Selects a part of a log: between two times or two program lines, with at least some time between samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen


@frozen
class TimeRange:
    """Times first ≤ t ≤ last [ns], with at least `period_ns` between two samples (0: all of them)."""

    first_ns: int = 0
    last_ns: int | None = None
    period_ns: int = 0

    def chosen(self, t_ns: NDArray[np.int64]) -> NDArray[np.int64]:
        """Indices of the instants `t_ns` (n,), ascending, that belong to the part: the first in each period."""
        inside = t_ns >= self.first_ns
        if self.last_ns is not None:
            inside &= t_ns <= self.last_ns
        index = np.flatnonzero(inside)
        if self.period_ns > 0 and len(index):
            slot = (t_ns[index] - self.first_ns) // self.period_ns
            index = index[np.diff(slot, prepend=-1) > 0]
        return index
