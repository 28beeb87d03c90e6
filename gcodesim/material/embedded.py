"""Parts in a stock: the room that a body takes is taken out of the stock in which it lies, before anything is cut."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.field_kernels import Columns
from gcodesim.material.mesh import columns_of_mesh, outward

if TYPE_CHECKING:
    from gcodesim.material.stock import Lines, Stock

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


def take_out(stock: Stock, vertices: Array, faces: Ints) -> float:
    """Take the room of a closed mesh, vertices (v, 3) [m] in S, out of a stock that is as it was made; [m³] of it.

    Columns are cut where the mesh enters and leaves them; the walls of the room are at the borders of columns.
    """
    from gcodesim.material.kernels import patch_tops

    before = stock.volume
    field = stock.field
    columns, _ = _without((field.columns, field.grid), vertices, faces)
    stock.field = field._replace(columns=columns)
    patch_tops(columns, stock.field.tops)
    stock.original = Columns(columns.lo.copy(), columns.hi.copy(), columns.number.copy())
    whole = stock.exact
    if whole is not None:
        stock.exact = lambda order: _without(whole(order), vertices[:, list(order)], faces)
    return before - stock.volume


def _without(lines: Lines, vertices: Array, faces: Ints) -> Lines:
    """Columns on a grid without what lies in a mesh."""
    from gcodesim.material.line_kernels import common_columns

    columns, grid = lines
    vertices, faces = outward(vertices, faces)
    inside, _ = columns_of_mesh(vertices, faces, grid, columns.number.shape)
    beside = _complement(inside)
    room = columns.lo.shape[2] + beside.lo.shape[2]
    shape = columns.number.shape
    left = Columns(np.zeros((*shape, room)), np.zeros((*shape, room)), np.zeros(shape, dtype=np.int32))
    common_columns(columns, beside, left)
    most = max(int(left.number.max()), 1)
    low, high = (np.ascontiguousarray(ends[:, :, :most]) for ends in (left.lo, left.hi))
    return Columns(low, high, left.number), grid


def _complement(columns: Columns) -> Columns:
    """All that is not in material, up and down without end."""
    lo, hi, number = columns
    shape = (*number.shape, 1)
    used = np.arange(lo.shape[2]) < number[:, :, None]
    below = np.concatenate([np.full(shape, -np.inf), np.where(used, hi, np.inf)], axis=2)
    above = np.concatenate([np.where(used, lo, np.inf), np.full(shape, np.inf)], axis=2)
    return Columns(below, above, number + 1)
