"""Beads on stocks that stand in each other: parts fill their room in the whole for a while, and what is laid stays."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.bead_kernels import unite
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.removal_kernels import subtract

Array = NDArray[np.float64]

FUSE = 1.0e-9  # [m] between what stands in each other, up to which it touches


@kernel
def put_in(columns: Columns, grid: Grid, part: Columns, of_part: Grid, at: Array) -> bool:
    """Add to columns what a part holds at their middles, whose frame stands at (3,) [m] in theirs; False: no room."""
    nx, ny = columns.number.shape
    mx, my = part.number.shape
    for i in range(nx):
        a = math.floor((grid.x + (i + 0.5) * grid.dx - at[0] - of_part.x) / of_part.dx)
        if a < 0 or a >= mx:
            continue
        for j in range(ny):
            b = math.floor((grid.y + (j + 0.5) * grid.dy - at[1] - of_part.y) / of_part.dy)
            if b < 0 or b >= my:
                continue
            for k in range(part.number[a, b]):
                low, high = part.lo[a, b, k] + at[2], part.hi[a, b, k] + at[2]
                if high > low and unite(columns, i, j, low, high, FUSE) < 0.0:
                    return False
    return True


@kernel
def keep_laid(before: Columns, joined: Columns, now: Columns, laid: Columns) -> bool:
    """Make of the columns `now` those `before` with what was laid since they were `joined`; False: no room.

    `laid` has room (1, 1, k) for what was laid in a column. Columns that nothing was laid on get their old bits back.
    """
    nx, ny = now.number.shape
    for i in range(nx):
        for j in range(ny):
            same = now.number[i, j] == joined.number[i, j]
            for k in range(now.number[i, j]):
                if not same:
                    break
                same = now.lo[i, j, k] == joined.lo[i, j, k] and now.hi[i, j, k] == joined.hi[i, j, k]
            laid.number[0, 0] = 0
            if not same:
                laid.number[0, 0] = now.number[i, j]
                for k in range(now.number[i, j]):
                    laid.lo[0, 0, k], laid.hi[0, 0, k] = now.lo[i, j, k], now.hi[i, j, k]
                for k in range(joined.number[i, j]):
                    if subtract(laid, 0, 0, joined.lo[i, j, k], joined.hi[i, j, k]) < 0.0:
                        return False
            now.number[i, j] = before.number[i, j]
            for k in range(before.number[i, j]):
                now.lo[i, j, k], now.hi[i, j, k] = before.lo[i, j, k], before.hi[i, j, k]
            for k in range(laid.number[0, 0]):
                if unite(now, i, j, laid.lo[0, 0, k], laid.hi[0, 0, k], FUSE) < 0.0:
                    return False
    return True
