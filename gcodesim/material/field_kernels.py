"""A field of dexels in the form that kernels take: columns of exact height on a regular grid, walls, and marks.

Kernels of other packages pass a `Field` on to those of this one; only this package names its contents.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]

PATCH_SHIFT = 4
"""Columns are watched in patches of 16 x 16."""
PATCH = 1 << PATCH_SHIFT


class Grid(NamedTuple):
    """Where the columns are: the outer corner x, y, and the size dx, dy of a cell [m]."""

    x: float
    y: float
    dx: float
    dy: float


class Columns(NamedTuple):
    """Columns (nx, ny): the first `number` of up to k intervals lo..hi (nx, ny, k) [m] of each hold material.

    Intervals are in rising order and do not touch. In an empty column the first interval ends where it begins.
    """

    lo: Array
    hi: Array
    number: Ints


class Field(NamedTuple):
    """Columns along Z of one frame, on a grid.

    walls (8, nx + 1, ny + 1): where walls really are (`wall_kernels`). For each patch of 16 x 16 columns: `dirty`,
    whether it has changed since the last look, and `tops`, a height [m] that none of its material exceeds.
    """

    columns: Columns
    grid: Grid
    walls: Singles
    dirty: Bytes
    tops: Array


@kernel(lean=True, inlined=True)
def coarsest(field: Field) -> float:
    """The longer side of a cell [m]."""
    return max(field.grid.dx, field.grid.dy)


@kernel(lean=True, inlined=True)
def diagonal(field: Field) -> float:
    """The diagonal of a cell [m]."""
    grid = field.grid
    return float(np.sqrt(grid.dx * grid.dx + grid.dy * grid.dy))


@kernel(lean=True, inlined=True)
def breadth_along(field: Field, ux: float, uy: float) -> float:
    """The width [m] of a cell seen along the unit vector (ux, uy)."""
    return float(field.grid.dx * abs(uy) + field.grid.dy * abs(ux))


@kernel(lean=True)
def patch_at(field: Field, x: float, y: float) -> tuple[int, int]:
    """The patch of (x, y); it may lie outside the field."""
    grid = field.grid
    return int(np.floor((x - grid.x) / (grid.dx * PATCH))), int(np.floor((y - grid.y) / (grid.dy * PATCH)))


@kernel(lean=True, inlined=True)
def patch_top(columns: Columns, pi: int, pj: int) -> float:
    """Height [m] of the highest material in patch (pi, pj); -inf when it is empty."""
    _, hi, count = columns
    top = -np.inf
    for i in range(pi << PATCH_SHIFT, min((pi + 1) << PATCH_SHIFT, count.shape[0])):
        for j in range(pj << PATCH_SHIFT, min((pj + 1) << PATCH_SHIFT, count.shape[1])):
            n = count[i, j]
            if n > 0 and hi[i, j, n - 1] > top:
                top = hi[i, j, n - 1]
    return top


@kernel(lean=True)
def patch_tops(columns: Columns, tops: Array) -> None:
    """Fill `tops` (patches) with the height [m] of the highest material of each patch."""
    for pi in range(tops.shape[0]):
        for pj in range(tops.shape[1]):
            tops[pi, pj] = patch_top(columns, pi, pj)


@kernel(lean=True)
def tighten_tops(field: Field, x: float, y: float, radius: float) -> None:
    """Update the height of the material in the patches within `radius` [m] of (x, y), which cutting has lowered."""
    tops, grid = field.tops, field.grid
    pi, pj = patch_at(field, x, y)
    reach_i = int(np.ceil(radius / (grid.dx * PATCH)))
    reach_j = int(np.ceil(radius / (grid.dy * PATCH)))
    for i in range(max(pi - reach_i, 0), min(pi + reach_i + 1, tops.shape[0])):
        for j in range(max(pj - reach_j, 0), min(pj + reach_j + 1, tops.shape[1])):
            tops[i, j] = patch_top(field.columns, i, j)


@kernel(lean=True)
def top_nearby(field: Field, x: float, y: float, radius: float) -> float:
    """Height [m] that no material within `radius` of (x, y) exceeds; -inf where there is no stock."""
    tops = field.tops
    first_i, first_j = patch_at(field, x - radius, y - radius)
    last_i, last_j = patch_at(field, x + radius, y + radius)
    top = -np.inf
    for i in range(max(first_i, 0), min(last_i + 1, tops.shape[0])):
        for j in range(max(first_j, 0), min(last_j + 1, tops.shape[1])):
            top = max(top, tops[i, j])
    return top
