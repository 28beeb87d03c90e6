"""In which order the steps of several channels have to be cut."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@kernel(lean=True)
def spells_of(low: Array, high: Array, at: Ints, spells: Ints) -> int:
    """Fill `spells` (m, 2) with the channel that cuts next and the step up to which it does; returns how many rows.

    low, high (c, t, n, 3): corners of the boxes in which c channels act on t stocks in n steps. Step by step, and
    within a step in the order of the channels, is the order that counts: two steps change places only where their
    boxes share nothing. `at` (c,) is the step that each channel comes to: zeros at first.
    """
    channels, steps = low.shape[0], low.shape[2]
    count, left = 0, channels * steps
    while left > 0:
        for c in range(channels):
            end = at[c]
            while end < steps and _is_next(low, high, at, c, end):
                end += 1
            if end > at[c]:
                spells[count, 0], spells[count, 1] = c, end
                count += 1
                left -= end - at[c]
                at[c] = end
    return count


@kernel(lean=True)
def _is_next(low: Array, high: Array, at: Ints, c: int, i: int) -> bool:
    """Whether step i of channel c meets nothing that others, who come to steps `at` (c,), have to cut before."""
    for d in range(low.shape[0]):
        if d == c:
            continue
        for j in range(at[d], i + 1 if d < c else i):
            for t in range(low.shape[1]):
                apart = False
                for axis in range(3):
                    if low[c, t, i, axis] >= high[d, t, j, axis] or high[c, t, i, axis] <= low[d, t, j, axis]:
                        apart = True
                        break
                if not apart:
                    return False
    return True
