"""How far the volume on the grid can be from the true one, read from the columns themselves.

Heights are exact, walls are not: somewhere between the centres of two columns that differ there is a wall, so each
pair of neighbours leaves half a cell of their difference open; a wall whose place is known (wall_kernels) leaves a
tenth of a cell, for its ends and curves. Where heights change evenly (a slope, not a wall) the
height at the centre of a cell is its mean, and only the change of the slope counts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field
from gcodesim.material.query_kernels import difference

Array = NDArray[np.float64]

KNOWN_WALL = 0.2  # share of half a cell that a wall of known place leaves open


@kernel
def changes(columns: Columns, before: Columns, change: Array) -> float:
    """Fill `change` (nx, ny) with the length [m] in which each column differs from before; returns the sum.

    The state before may be given as one column for all.
    """
    nx, ny = columns.number.shape
    one_x, one_y = before.number.shape[0] == 1, before.number.shape[1] == 1
    total = 0.0
    for i in range(nx):
        for j in range(ny):
            ib, jb = 0 if one_x else i, 0 if one_y else j
            change[i, j] = difference(columns, i, j, before, ib, jb)
            total += change[i, j]
    return total


@kernel
def simple(columns: Columns, i: int, j: int, bottom: float) -> bool:
    """Whether a column exists and is one interval that stands on `bottom`."""
    lo, _, count = columns
    nx, ny = count.shape
    return 0 <= i < nx and 0 <= j < ny and bool(count[i, j] == 1 and lo[i, j, 0] == bottom)


@kernel
def open_length(columns: Columns, change: Array, i: int, j: int, di: int, dj: int) -> float:
    """Length [m] of changed material that may lie on either side of the border from column (i, j) to its neighbour."""
    lo, hi, count = columns
    a, b = i + di, j + dj
    moved = float(change[i, j] + change[a, b])
    if moved == 0.0:
        return 0.0
    apart = difference(columns, i, j, columns, a, b)
    if apart == 0.0:
        return 0.0
    if count[i, j] == 1 and count[a, b] == 1 and lo[i, j, 0] == lo[a, b, 0]:
        # four columns in a row: the part of the step that is a continuing slope
        bottom = lo[i, j, 0]
        if simple(columns, i - di, j - dj, bottom) and simple(columns, a + di, b + dj, bottom):
            before = hi[i, j, 0] - hi[i - di, j - dj, 0]
            here = hi[a, b, 0] - hi[i, j, 0]
            after = hi[a + di, b + dj, 0] - hi[a, b, 0]
            if before * here > 0.0 and here * after > 0.0:
                even = min(abs(before), abs(here), abs(after))
                apart = apart - float(even) + float(abs(after - before)) / 6.0
    return min(apart, moved)


@kernel
def error_bound(field: Field, change: Array) -> float:
    """Volume [m^3] by which changed material may be off: half a cell at every wall that was made."""
    columns, grid, walls, _, _ = field
    nx, ny = columns.number.shape
    total = 0.0
    for i in range(nx):
        row = 0.0
        for j in range(ny):
            if i + 1 < nx:
                known = KNOWN_WALL if walls[0, i + 1, j] != 0.0 else 1.0
                row += known * open_length(columns, change, i, j, 1, 0)
            if j + 1 < ny:
                known = KNOWN_WALL if walls[1, i, j + 1] != 0.0 else 1.0
                row += known * open_length(columns, change, i, j, 0, 1)
        total += row
    return 0.5 * total * float(grid.dx * grid.dy)
