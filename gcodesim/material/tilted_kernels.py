"""Columns along any direction, made from columns along x, y and z: what a leaning tool has around itself.

At a point the columns nearby tell how far it is to the surface along their own axis, interpolated between four of
them; of the three axes the one counts whose four columns differ least, which is the one that meets the face nearly
head-on. So plane faces come out exact in any direction, and edges are bevelled by less than a cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field, Grid
from gcodesim.material.query_kernels import surrounding
from gcodesim.material.sweep_kernels import x_of, y_of

Array = NDArray[np.float64]

FARTHEST = 4.0
"""Cells beyond which distances are not told apart."""

LEAST_STRIDE, MOST_STRIDE = 0.5, 2.0
"""Cells from one look at the material to the next along a column."""

HALVINGS = 9
"""Of the last stride, where a column meets the surface: to a thousandth of a cell."""


class ThreeFields(NamedTuple):
    """The columns of a stock along x, y and z, each on its own grid."""

    x: Columns
    x_grid: Grid
    y: Columns
    y_grid: Grid
    z: Columns
    z_grid: Grid


class StockRoom(NamedTuple):
    """Where there may be material: lowest and highest corner of the stock at the start, (3,) [m]."""

    low: Array
    high: Array


@kernel(lean=True)
def depth_in(columns: Columns, i: int, j: int, w: float, limit: float) -> float:
    """How far the height w [m] lies inside of the material of a column, less than 0 outside; within +-limit [m]."""
    lo, hi, count = columns
    if i < 0 or j < 0 or i >= count.shape[0] or j >= count.shape[1]:
        return -limit
    depth = -limit
    for k in range(count[i, j]):
        depth = max(depth, min(w - lo[i, j, k], hi[i, j, k] - w))
    return min(depth, limit)


@kernel(lean=True)
def depth_around(columns: Columns, grid: Grid, x: float, y: float, w: float, limit: float) -> tuple[float, float]:
    """The same between four columns, and by how much these differ [m]."""
    i, j, wx, wy = surrounding(grid, x, y)
    a, b = depth_in(columns, i, j, w, limit), depth_in(columns, i + 1, j, w, limit)
    c, d = depth_in(columns, i, j + 1, w, limit), depth_in(columns, i + 1, j + 1, w, limit)
    depth = (1.0 - wy) * ((1.0 - wx) * a + wx * b) + wy * ((1.0 - wx) * c + wx * d)
    return depth, max(a, b, c, d) - min(a, b, c, d)


@kernel(lean=True)
def depth_at(fields: ThreeFields, x: float, y: float, z: float, limit: float) -> float:
    """How deep the point (x, y, z) lies in material along the axis that meets the surface best, < 0 outside [m]."""
    depth, spread = depth_around(fields.z, fields.z_grid, x, y, z, limit)
    other, differ = depth_around(fields.x, fields.x_grid, y, z, x, limit)
    if differ < spread or (differ == spread and abs(other) < abs(depth)):
        depth, spread = other, differ
    other, differ = depth_around(fields.y, fields.y_grid, z, x, y, limit)
    if differ < spread or (differ == spread and abs(other) < abs(depth)):
        depth = other
    return depth


@kernel(lean=True)
def span_in(room: StockRoom, begin: Array, axis: Array, least: float, most: float) -> tuple[float, float]:
    """The part of least..most [m] along a line from `begin` (3,) in which it is in the room; empty: most < least."""
    for d in range(3):
        if abs(axis[d]) < 1.0e-12:
            if begin[d] < room.low[d] or begin[d] > room.high[d]:
                return 1.0, 0.0
            continue
        one, other = (room.low[d] - begin[d]) / axis[d], (room.high[d] - begin[d]) / axis[d]
        least, most = max(least, min(one, other)), min(most, max(one, other))
    return least, most


@kernel(lean=True)
def fill_column(
    fields: ThreeFields, room: StockRoom, begin: Array, axis: Array, heights: Array, cell: float, lo: Array, hi: Array
) -> int:
    """Find the material on begin + h axis between heights (2,) of h [m]; number of intervals, in lo and hi."""
    limit = FARTHEST * cell
    h, end = span_in(room, begin, axis, heights[0], heights[1])
    if h >= end:
        return 0
    found = 0
    depth = depth_at(fields, begin[0] + h * axis[0], begin[1] + h * axis[1], begin[2] + h * axis[2], limit)
    inside = depth > 0.0
    if inside:
        lo[0] = h
    while h < end:
        stride = min(max(0.5 * abs(depth), LEAST_STRIDE * cell), MOST_STRIDE * cell)
        after = min(h + stride, end)
        x, y, z = begin[0] + after * axis[0], begin[1] + after * axis[1], begin[2] + after * axis[2]
        depth = depth_at(fields, x, y, z, limit)
        if (depth > 0.0) != inside:
            low, high = h, after
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                x, y, z = begin[0] + middle * axis[0], begin[1] + middle * axis[1], begin[2] + middle * axis[2]
                if (depth_at(fields, x, y, z, limit) > 0.0) == inside:
                    low = middle
                else:
                    high = middle
            if inside:
                hi[found] = 0.5 * (low + high)
                found += 1
            elif found < lo.shape[0]:
                lo[found] = 0.5 * (low + high)
            else:
                return found
            inside = not inside
        h = after
    if inside and found < lo.shape[0]:
        hi[found] = end
        found += 1
    return found


@kernel
def fill_tilted(fields: ThreeFields, room: StockRoom, frame: Array, heights: Array, field: Field) -> None:
    """Fill the columns of `field`, along the last column of `frame` (3, 3), with the material of a stock.

    `frame` has the axes of the field as columns; both origins are one. heights (2,) [m]: from where to where to look.
    """
    columns, grid = field.columns, field.grid
    lo, hi, count = columns
    cell = max(grid.dx, grid.dy)
    begin, axis = np.empty(3), np.empty(3)
    for d in range(3):
        axis[d] = frame[d, 2]
    for i in range(count.shape[0]):
        x = x_of(grid, i)
        for j in range(count.shape[1]):
            y = y_of(grid, j)
            for d in range(3):
                begin[d] = frame[d, 0] * x + frame[d, 1] * y
            count[i, j] = fill_column(fields, room, begin, axis, heights, cell, lo[i, j], hi[i, j])
            if count[i, j] == 0:
                hi[i, j, 0] = lo[i, j, 0]
