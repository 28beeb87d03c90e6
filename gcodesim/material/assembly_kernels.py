"""Beads on stocks that stand in each other: parts fill their room in the whole for a while, and what is laid stays."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.bead_kernels import unite
from gcodesim.material.beam_kernels import PARALLEL
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.removal_kernels import subtract

Array = NDArray[np.float64]

FUSE = 1.0e-9  # [m] between what stands in each other, up to which it touches


class ColumnAxis(NamedTuple):
    """The points (x, y, z) + t (dx, dy, dz) [m] of a part's frame: the middle of a column of the whole, at height t."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float


@kernel
def put_in_column(columns: Columns, i: int, j: int, part: Columns, of_part: Grid, line: ColumnAxis) -> bool:
    """Add to column (i, j) what a part holds along `line`; False: no room. It may be called again with more room."""
    mx, my = part.number.shape
    begin, end = -math.inf, math.inf  # where the line is over the grid
    for axis in range(2):
        at, d = (line.x, line.dx) if axis == 0 else (line.y, line.dy)
        low = of_part.x if axis == 0 else of_part.y
        high = low + (of_part.dx * mx if axis == 0 else of_part.dy * my)
        if abs(d) < PARALLEL:
            if at < low or at >= high:
                return True
            continue
        one, other = (low - at) / d, (high - at) / d
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
    t = begin
    while t < end:
        inside = 0.0 if t == -math.inf else t + 1.0e-9 * min(of_part.dx, of_part.dy)
        a = math.floor((line.x + (line.dx * inside if abs(line.dx) >= PARALLEL else 0.0) - of_part.x) / of_part.dx)
        b = math.floor((line.y + (line.dy * inside if abs(line.dy) >= PARALLEL else 0.0) - of_part.y) / of_part.dy)
        a, b = min(max(a, 0), mx - 1), min(max(b, 0), my - 1)
        to_x = to_y = math.inf
        if abs(line.dx) >= PARALLEL:
            to_x = (of_part.x + of_part.dx * (a + (1 if line.dx > 0.0 else 0)) - line.x) / line.dx
        if abs(line.dy) >= PARALLEL:
            to_y = (of_part.y + of_part.dy * (b + (1 if line.dy > 0.0 else 0)) - line.y) / line.dy
        until = min(to_x, to_y, end)
        if t > -math.inf:
            until = max(until, inside)
        for k in range(part.number[a, b]):
            low, high = part.lo[a, b, k] - line.z, part.hi[a, b, k] - line.z
            if abs(line.dz) < PARALLEL:
                low, high = (t, until) if low < 0.0 < high else (0.0, 0.0)
            else:
                low, high = min(low / line.dz, high / line.dz), max(low / line.dz, high / line.dz)
                low, high = max(low, t), min(high, until)
            if high > low and unite(columns, i, j, low, high, FUSE) < 0.0:
                return False
        t = until
    return True


@kernel
def put_in(columns: Columns, grid: Grid, part: Columns, of_part: Grid, X: Array) -> bool:
    """Add to columns what a part holds at their middles; it sees their frame at X (4, 4). False: there is no room."""
    nx, ny = columns.number.shape
    for i in range(nx):
        x = grid.x + (i + 0.5) * grid.dx
        for j in range(ny):
            y = grid.y + (j + 0.5) * grid.dy
            line = ColumnAxis(
                X[0, 0] * x + X[0, 1] * y + X[0, 3],
                X[1, 0] * x + X[1, 1] * y + X[1, 3],
                X[2, 0] * x + X[2, 1] * y + X[2, 3],
                X[0, 2], X[1, 2], X[2, 2],
            )  # fmt: skip
            if not put_in_column(columns, i, j, part, of_part, line):
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
