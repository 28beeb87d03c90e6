"""How far the volume on the grid can be from the true one, read from the columns themselves.

Heights are exact, walls are not: somewhere between the centres of two columns that differ there is a wall, so each
pair of neighbours leaves half a cell of their difference open; a wall whose place is known (wall_kernels) leaves a
tenth of a cell, for its ends and curves. Where heights run on evenly (a slope, not a wall) the
centre of a cell is its mean, and only the change of the slope counts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.query_kernels import difference

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Singles = NDArray[np.float32]

KNOWN_WALL = 0.2  # share of half a cell that a wall of known place leaves open


@kernel
def changes(
    lo: Array, hi: Array, count: Ints, lo_before: Array, hi_before: Array, count_before: Ints, change: Array
) -> float:
    """Fill `change` (nx, ny) with the length [m] in which each column differs from before; returns the sum.

    The arrays from before may have one column that stands for all.
    """
    nx, ny = count.shape
    one_x, one_y = count_before.shape[0] == 1, count_before.shape[1] == 1
    total = 0.0
    for i in range(nx):
        for j in range(ny):
            ib, jb = 0 if one_x else i, 0 if one_y else j
            change[i, j] = difference(lo, hi, count, i, j, lo_before, hi_before, count_before, ib, jb)
            total += change[i, j]
    return total


@kernel
def simple(lo: Array, hi: Array, count: Ints, i: int, j: int, bottom: float) -> bool:
    """Whether a column exists and is one interval that stands on `bottom`."""
    nx, ny = count.shape
    return 0 <= i < nx and 0 <= j < ny and bool(count[i, j] == 1 and lo[i, j, 0] == bottom)


@kernel
def open_length(lo: Array, hi: Array, count: Ints, change: Array, i: int, j: int, di: int, dj: int) -> float:
    """Length [m] of changed material that may lie on either side of the border from column (i, j) to its neighbour."""
    a, b = i + di, j + dj
    moved = float(change[i, j] + change[a, b])
    if moved == 0.0:
        return 0.0
    apart = difference(lo, hi, count, i, j, lo, hi, count, a, b)
    if apart == 0.0:
        return 0.0
    if count[i, j] == 1 and count[a, b] == 1 and lo[i, j, 0] == lo[a, b, 0]:
        # four columns in a row: the part of the step that is a slope running on
        bottom = lo[i, j, 0]
        if simple(lo, hi, count, i - di, j - dj, bottom) and simple(lo, hi, count, a + di, b + dj, bottom):
            before = hi[i, j, 0] - hi[i - di, j - dj, 0]
            here = hi[a, b, 0] - hi[i, j, 0]
            after = hi[a + di, b + dj, 0] - hi[a, b, 0]
            if before * here > 0.0 and here * after > 0.0:
                even = min(abs(before), abs(here), abs(after))
                apart = apart - float(even) + float(abs(after - before)) / 6.0
    return min(apart, moved)


@kernel
def error_bound(lo: Array, hi: Array, count: Ints, walls: Singles, change: Array, grid: Array) -> float:
    """Volume [m^3] by which changed material may be off: half a cell at every wall that was made."""
    nx, ny = count.shape
    total = 0.0
    for i in range(nx):
        row = 0.0
        for j in range(ny):
            if i + 1 < nx:
                known = KNOWN_WALL if walls[0, i + 1, j] != 0.0 else 1.0
                row += known * open_length(lo, hi, count, change, i, j, 1, 0)
            if j + 1 < ny:
                known = KNOWN_WALL if walls[1, i, j + 1] != 0.0 else 1.0
                row += known * open_length(lo, hi, count, change, i, j, 0, 1)
        total += row
    return 0.5 * total * float(grid[2] * grid[3])
