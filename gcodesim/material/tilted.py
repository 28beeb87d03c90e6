"""The material around a leaning tool as a field of its own, whose columns stand along the tool's axis."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.field_kernels import PATCH, Columns, Field, Grid

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

MOST_INTERVALS: Final = 4
"""Layers of material above each other that such a field tells apart."""


def tilted_frame(axis: Array) -> Array:
    """Axes (3, 3), as columns, of the frame whose Z is the unit vector `axis` (3,); turned from S the shortest way."""
    x, y, z = (float(part) for part in axis)
    if z < -0.999999:  # any turn about a level axis is as short
        return np.diag([1.0, -1.0, -1.0])
    share = 1.0 / (1.0 + z)
    return np.array(
        [[1.0 - x * x * share, -x * y * share, x], [-x * y * share, 1.0 - y * y * share, y], [-x, -y, z]],
    )


def tilted_field(stock: Stock, frame: Array, low: Array, high: Array) -> Field:
    """The material between two corners (3,) [m] of `frame` (3, 3), which has the same origin as S."""
    from gcodesim.material.kernels import patch_tops
    from gcodesim.material.lattice import ensure_lattice
    from gcodesim.material.tilted_kernels import StockRoom, ThreeFields, fill_tilted

    lattice = ensure_lattice(stock)
    cell = stock.cell
    nx, ny = (max(2, ceil(float(high[d] - low[d]) / cell)) for d in range(2))
    patches = (-(-nx // PATCH), -(-ny // PATCH))
    shape = (nx, ny, MOST_INTERVALS)
    field = Field(
        columns=Columns(np.zeros(shape), np.zeros(shape), np.zeros((nx, ny), np.int32)),
        grid=Grid(float(low[0]), float(low[1]), cell, cell),
        walls=np.zeros((8, nx + 1, ny + 1), np.float32),
        dirty=np.zeros(patches, np.uint8),
        tops=np.zeros(patches),
    )
    along_x, along_y = lattice.fields
    fields = ThreeFields(
        along_x.columns, along_x.grid, along_y.columns, along_y.grid, stock.field.columns, stock.field.grid
    )
    room = StockRoom(*(np.ascontiguousarray(corner, dtype=float) for corner in stock.bounds))
    fill_tilted(fields, room, np.ascontiguousarray(frame), np.array([low[2], high[2]]), field)
    patch_tops(field.columns, field.tops)
    return field
