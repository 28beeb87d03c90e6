"""Columns without the room that they do not use: what a memento keeps of a stock."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns

Array = NDArray[np.float64]


@kernel(lean=True)
def pack(columns: Columns, low: Array, high: Array) -> None:
    """Write the used intervals of all columns one after the other into `low` and `high` (m,)."""
    lo, hi, count = columns
    at = 0
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            for k in range(count[i, j]):
                low[at], high[at] = lo[i, j, k], hi[i, j, k]
                at += 1


@kernel(lean=True)
def unpack(low: Array, high: Array, columns: Columns) -> None:
    """Write packed intervals (m,) back into columns whose numbers are set."""
    lo, hi, count = columns
    at = 0
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            for k in range(count[i, j]):
                lo[i, j, k], hi[i, j, k] = low[at], high[at]
                at += 1
