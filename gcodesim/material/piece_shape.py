"""The shape of a piece that came loose: its skin, boxes that fill it, and the skin of what it came loose from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.solids.mesh_file import Triangles

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

BANDS: Final = 32
"""Boxes along x that fill a piece: an engine asks each of them in each step of its fall."""

DRAWN_COLUMNS: Final = 60_000
"""Columns of what a piece may fall onto that an engine is shown."""

_RIM: Final = 2  # columns beside a piece that are kept, so that its walls are drawn where they are


class PieceShape(NamedTuple):
    """A piece in S: its skin, and `boxes` (b, 2, 3) [m] within it.

    `rest` is the skin of the stock without it, around it as far as it is long.
    """

    skin: Triangles
    boxes: Array
    rest: Triangles


def piece_shape(piece: Stock, rest: Stock, low: Array, high: Array) -> PieceShape:
    """What is in the box `low`, `high` (3,) [m]: `piece` is a stock with nothing else, `rest` all that stays."""
    alone = _around(piece, low, high, _RIM * piece.cell)
    around = _around(rest, low, high, float((high - low).max()))
    return PieceShape(
        skin=_skin(alone, alone.resolution),
        boxes=boxes_within(alone.field.columns, alone.field.grid),
        rest=_skin(around, around.spacing_for(DRAWN_COLUMNS)),
    )


def _skin(stock: Stock, spacing: float) -> Triangles:
    surface = stock.surface(spacing)
    return Triangles(points=surface.vertices, faces=surface.faces.astype(np.int32, copy=False))


def _around(stock: Stock, low: Array, high: Array, room: float) -> Stock:
    """The columns of a stock within a box and `room` [m] beside it; all of it where there are columns along x and y."""
    from gcodesim.material.stock import Stock

    if stock.lattice is not None:
        return stock
    columns, grid = stock.field.columns, stock.field.grid
    origin, spacing, shape = stock.origin, stock.spacing, np.array(columns.number.shape)
    first = np.clip(np.floor((low[:2] - room - origin) / spacing).astype(int), 0, shape - 1)
    last = np.clip(np.ceil((high[:2] + room - origin) / spacing).astype(int), first + 1, shape)
    (i, j), (m, n) = first.tolist(), last.tolist()
    part = Stock(
        columns=_cut_out(columns, i, m, j, n),
        grid=Grid(grid.x + i * grid.dx, grid.y + j * grid.dy, grid.dx, grid.dy),
        z_range=stock.z_range,
        resolution=stock.resolution,
        material=stock.material,
        original=_cut_out(stock.original, i, m, j, n),
    )
    part.set_walls(stock.field.walls[:, i : m + 1, j : n + 1])
    return part


def _cut_out(columns: Columns, i: int, m: int, j: int, n: int) -> Columns:
    if columns.number.size == 1:  # one for all
        return columns
    lo, hi, number = columns
    return Columns(
        np.ascontiguousarray(lo[i:m, j:n]), np.ascontiguousarray(hi[i:m, j:n]), np.ascontiguousarray(number[i:m, j:n])
    )


def boxes_within(columns: Columns, grid: Grid) -> Array:
    """Boxes (b, 2, 3) [m] that lie in columns and fill most of them; bands along x, divided where heights change."""
    nx = len(columns.number)
    for width in (-(-nx // BANDS), 1):
        boxes = [
            box
            for level in range(columns.lo.shape[2])
            for first in range(0, nx, width)
            for box in _in_band(columns, grid, first, min(first + width, nx), level)
        ]
        if boxes:
            return np.array(boxes)
    return np.zeros((0, 2, 3))


def _in_band(columns: Columns, grid: Grid, first: int, last: int, level: int) -> list[tuple[list[float], list[float]]]:
    """Those that an interval of the columns `first` ≤ i < `last` along x has in common."""
    rows = slice(first, last)
    inside = (columns.number[rows] > level).all(axis=0)
    low = np.where(inside, columns.lo[rows, :, level].max(axis=0), 0.0)
    high = np.where(inside, columns.hi[rows, :, level].min(axis=0), 0.0)
    inside &= high > low
    x = grid.x + first * grid.dx, grid.x + last * grid.dx
    step = max(grid.dx, grid.dy, float(high.max() - low.min()) / BANDS)
    found = []
    at = 0
    while at < len(inside):
        if not inside[at]:
            at += 1
            continue
        same = inside[at:] & (np.abs(low[at:] - low[at]) <= step) & (np.abs(high[at:] - high[at]) <= step)
        until = at + (len(same) if same.all() else int(np.argmin(same)))
        bottom, top = float(low[at:until].max()), float(high[at:until].min())
        if top > bottom:
            y = grid.y + at * grid.dy, grid.y + until * grid.dy
            found.append(([x[0], y[0], bottom], [x[1], y[1], top]))
        at = until
    return found
