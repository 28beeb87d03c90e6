"""Rows that belong to one event: a fault that lasts is one finding, not one per row."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Flags = NDArray[np.bool_]


def runs(
    fault: Flags, ends: Flags | None = None, group: NDArray[np.integer] | None = None
) -> Iterator[NDArray[np.intp]]:
    """Indices of the rows at `fault` (n,), event by event.

    An event ends at a row without fault where `ends` (n,) is set (default: at
    every row without fault), and where `group` (n,) changes.
    """
    rows = np.flatnonzero(fault)
    if not len(rows):
        return
    breaks = ~fault if ends is None else ends & ~fault
    passed = np.cumsum(breaks)[rows]
    new = np.diff(passed) != 0
    if group is not None:
        changes = np.cumsum(np.diff(group, prepend=group[:1]) != 0)
        new |= np.diff(changes[rows]) != 0
    yield from np.split(rows, np.flatnonzero(new) + 1)
