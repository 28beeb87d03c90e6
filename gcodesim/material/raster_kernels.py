"""A closed triangle mesh as columns: where the line of each column enters and leaves it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.sweep_kernels import columns_across_x, columns_across_y, x_of, y_of

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


class Crossings(NamedTuple):
    """Where the lines of columns cross a mesh: the number of crossings of each (nx, ny) and their places in the lists.

    heights [m] and ups: +1 where the line leaves the body, going up, -1 where it enters. Lists may be empty as long as
    crossings are only counted.
    """

    number: Ints
    start: Ints
    heights: Array
    ups: Ints


@kernel
def side(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    """Twice the signed area of (a, b, point); exactly the negative if a and b change places."""
    if ax < bx or (ax == bx and ay < by):
        return (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    return -((ax - bx) * (y - by) - (ay - by) * (x - bx))


@kernel
def find_crossings(vertices: Array, faces: Ints, grid: Grid, crossings: Crossings, store: bool) -> None:
    """Crossings of every column's line with the triangles: their number, and with `store` also their lists."""
    found, start, heights, ups = crossings
    nx, ny = found.shape
    found[:] = 0
    for f in range(faces.shape[0]):
        ax, ay, az = vertices[faces[f, 0]]
        bx, by, bz = vertices[faces[f, 1]]
        cx, cy, cz = vertices[faces[f, 2]]
        area = side(ax, ay, bx, by, cx, cy)
        if area == 0.0:
            continue
        up = 1 if area > 0.0 else -1
        first_i, last_i = columns_across_x(grid, nx, min(ax, bx, cx), max(ax, bx, cx))
        first_j, last_j = columns_across_y(grid, ny, min(ay, by, cy), max(ay, by, cy))
        for i in range(first_i, last_i):
            x = x_of(grid, i)
            for j in range(first_j, last_j):
                y = y_of(grid, j)
                wa = up * side(bx, by, cx, cy, x, y)
                wb = up * side(cx, cy, ax, ay, x, y)
                wc = up * side(ax, ay, bx, by, x, y)
                if wa < 0.0 or wb < 0.0 or wc < 0.0:
                    continue
                if store:
                    place = start[i, j] + found[i, j]
                    heights[place] = (wa * az + wb * bz + wc * cz) / (wa + wb + wc)
                    ups[place] = up
                found[i, j] += 1


@kernel
def fill_columns(crossings: Crossings, columns: Columns, dry: bool) -> tuple[int, int]:
    """Intervals between entering and leaving, overlapping shells united; (most intervals of a column, open columns).

    `dry`: count only. A column is open if the mesh does not close along it; it gets only the certain intervals.
    """
    found, start, heights, ups = crossings
    lo, hi, count = columns
    nx, ny = found.shape
    most, leaks = 0, 0
    for i in range(nx):
        for j in range(ny):
            begin, n = start[i, j], found[i, j]
            order = np.argsort(heights[begin : begin + n], kind="mergesort")
            depth, intervals, low = 0, 0, 0.0
            for t in range(n):
                z, up = heights[begin + order[t]], ups[begin + order[t]]
                if up < 0:
                    if depth == 0:
                        low = z
                    depth += 1
                elif depth > 0:
                    depth -= 1
                    if depth == 0 and z > low:
                        if not dry:
                            lo[i, j, intervals], hi[i, j, intervals] = low, z
                        intervals += 1
                else:
                    depth = -1000000
            if depth != 0:
                leaks += 1
            most = max(most, intervals)
            if not dry:
                count[i, j] = intervals
    return most, leaks
