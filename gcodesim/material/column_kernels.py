"""Columns and patches of a field for those who look for what comes near it: places, heights, how many there are."""

from __future__ import annotations

import math

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Field


@kernel(lean=True, inlined=True)
def finest(field: Field) -> float:
    """The shorter side of a cell [m]."""
    return min(field.grid.dx, field.grid.dy)


@kernel(lean=True, inlined=True)
def breadth(field: Field) -> float:
    """The longer side of all columns together [m]."""
    nx, ny = field.columns.number.shape
    return float(max(field.grid.dx * nx, field.grid.dy * ny))


@kernel(lean=True, inlined=True)
def sides(field: Field) -> tuple[float, float]:
    """The sides of a cell along x and y [m]."""
    return field.grid.dx, field.grid.dy


@kernel(lean=True, inlined=True)
def index_at(field: Field, x: float, y: float) -> tuple[float, float]:
    """Where a place (x, y) [m] is, counted in columns: whole numbers are their middles."""
    return (x - field.grid.x) / field.grid.dx - 0.5, (y - field.grid.y) / field.grid.dy - 0.5


@kernel(lean=True, inlined=True)
def middle_of(field: Field, i: int, j: int) -> tuple[float, float]:
    """The middle (x, y) [m] of a column, also beside the field."""
    return field.grid.x + (i + 0.5) * field.grid.dx, field.grid.y + (j + 0.5) * field.grid.dy


@kernel(lean=True, inlined=True)
def is_of_one_layer(field: Field) -> bool:
    """Whether no column has room for more than one interval."""
    return bool(field.columns.lo.shape[2] == 1)


@kernel(lean=True)
def patches_within(field: Field, x0: float, x1: float, y0: float, y1: float) -> tuple[int, int, int, int]:
    """Patches that may have columns in a rectangle [m]: first and last + 1 along x, and along y."""
    grid, tops = field.grid, field.tops
    width, depth = grid.dx * (1 << PATCH_SHIFT), grid.dy * (1 << PATCH_SHIFT)
    return (
        max(math.floor((x0 - grid.x) / width), 0),
        min(math.floor((x1 - grid.x) / width) + 1, tops.shape[0]),
        max(math.floor((y0 - grid.y) / depth), 0),
        min(math.floor((y1 - grid.y) / depth) + 1, tops.shape[1]),
    )


@kernel(lean=True)
def patch_room(field: Field, i: int, j: int) -> tuple[float, float, float, float, float]:
    """Where a patch is along x and along y [m], and the height that none of its material exceeds."""
    grid = field.grid
    width, depth = grid.dx * (1 << PATCH_SHIFT), grid.dy * (1 << PATCH_SHIFT)
    x, y = grid.x + i * width, grid.y + j * depth
    return x, x + width, y, y + depth, field.tops[i, j]


@kernel(lean=True)
def columns_of_patch(field: Field, i: int, j: int) -> tuple[int, int, int, int]:
    """Columns of a patch: first and last + 1 along x, and along y."""
    nx, ny = field.columns.number.shape
    return (
        i << PATCH_SHIFT,
        min((i + 1) << PATCH_SHIFT, nx),
        j << PATCH_SHIFT,
        min((j + 1) << PATCH_SHIFT, ny),
    )


@kernel(lean=True)
def column_at(field: Field, i: int, j: int) -> tuple[float, float, int]:
    """The middle (x, y) [m] of a column, and how many intervals it holds."""
    grid = field.grid
    return grid.x + (i + 0.5) * grid.dx, grid.y + (j + 0.5) * grid.dy, field.columns.number[i, j]


@kernel(lean=True)
def interval_of(field: Field, i: int, j: int, k: int) -> tuple[float, float]:
    """Interval `k` of a column, from below [m]."""
    return field.columns.lo[i, j, k], field.columns.hi[i, j, k]
