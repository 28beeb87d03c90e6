"""Removal from columns along Z by an upright body of slabs, for cutters that no `Shape` is like.

Every slab is convex, so what it sweeps over a column is one interval; undercuts leave several in a column.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Field
from gcodesim.material.line_kernels import FAR, SlabReach, ToolPose, cut_straight, joined, reach_of, slab_at
from gcodesim.material.removal_kernels import overlap
from gcodesim.material.slab_kernels import line_of, swept
from gcodesim.material.sweep_kernels import columns_across_x, columns_across_y, x_of, y_of

Array = NDArray[np.float64]


@kernel(lean=True)
def upright_pose(start: Array, end: Array, share: float) -> ToolPose:
    """The pose of an upright tool at a share of its way from tip to tip (3,) [m]."""
    return ToolPose(
        start[0] + share * (end[0] - start[0]),
        start[1] + share * (end[1] - start[1]),
        start[2] + share * (end[2] - start[2]),
        0.0,
        0.0,
        1.0,
    )


@kernel(lean=True)
def remove_form(field: Field, start: Array, end: Array, slabs: Array) -> tuple[float, bool]:
    """Remove what slabs (m, 6) sweep from tip `start` to `end` (3,) [m]; (volume [m³] of the columns, ok).

    ok is False when a column had no room for one more interval; see `remove_piece`.
    """
    widest = 0.0
    for number in range(len(slabs)):
        widest = max(widest, slabs[number, 5])
    dx, dy = end[0] - start[0], end[1] - start[1]
    flat = np.sqrt(dx * dx + dy * dy)
    parts = max(1, int(np.ceil(flat / (FAR * widest))))
    area, total = field.grid.dx * field.grid.dy, 0.0
    for part in range(parts):
        begin, close = upright_pose(start, end, part / parts), upright_pose(start, end, (part + 1) / parts)
        for number in range(len(slabs)):
            gone, ok = cut_straight(field, slab_at(slabs, number), begin, close)
            total += gone * area
            if not ok:
                return total, False
    return total, True


@kernel(lean=True)
def touch_form(field: Field, start: Array, end: Array, slabs: Array) -> tuple[float, float]:
    """Material that slabs would run through: volume [m³], and depth [m] as the longest part of a column.

    Nothing is removed; see `touch_piece`. Where slabs meet, a column may count twice.
    """
    columns, grid = field.columns, field.grid
    lo, hi, count = columns
    nx, ny = count.shape
    begin, close = upright_pose(start, end, 0.0), upright_pose(start, end, 1.0)
    mu, mv, mw = close.u - begin.u, close.v - begin.v, close.w - begin.w
    volume, depth = 0.0, 0.0
    for number in range(len(slabs)):
        slab = slab_at(slabs, number)
        reach: SlabReach = joined(reach_of(slab, begin), reach_of(slab, close))
        first_i, last_i = columns_across_x(grid, nx, reach.u0, reach.u1)
        first_j, last_j = columns_across_y(grid, ny, reach.v0, reach.v1)
        for i in range(first_i, last_i):
            for j in range(first_j, last_j):
                n = count[i, j]
                if n == 0 or hi[i, j, n - 1] <= reach.w0 or lo[i, j, 0] >= reach.w1:
                    continue
                line = line_of(x_of(grid, i) - begin.u, y_of(grid, j) - begin.v, 0.0, 0.0, 1.0, mu, mv, mw, slab)
                low, high = swept(line, slab)
                if low < high:
                    shared = overlap(columns, i, j, begin.w + low, begin.w + high)
                    volume += shared
                    depth = max(depth, shared)
    return volume * grid.dx * grid.dy, depth
