"""Where a body touches a stock: whether points of its surface are inside the border that people see."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

SKIN: Final = 1e-9
"""[m] by which a point has to be below a face of a column: resting on it is not touching."""

_HALF: Final = 0.5 - 1e-9
_MOST: Final = 500_000  # points that are tested at once


def in_material(stock: Stock, points: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) of S [m] lie in material.

    Heights are those of the columns; across them material ends where the share of it, bilinear between the centres of
    the columns, falls below a half. So walls along the grid or across it stand within half a cell of their place.
    """
    found = np.zeros(len(points), dtype=bool)
    for first in range(0, len(points), _MOST):
        found[first : first + _MOST] = _occupied(stock, points[first : first + _MOST])
    return found


def _occupied(stock: Stock, points: Array) -> NDArray[np.bool_]:
    (lo, hi, number), grid = stock.field.columns, stock.field.grid
    nx, ny = number.shape
    u = (points[:, 0] - grid.x) / grid.dx - 0.5
    v = (points[:, 1] - grid.y) / grid.dy - 0.5
    i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
    wx, wy = u - i, v - j
    share = np.zeros(len(points))
    for di in (0, 1):
        for dj in (0, 1):
            inside = (i + di >= 0) & (i + di < nx) & (j + dj >= 0) & (j + dj < ny)
            here = np.flatnonzero(inside)
            if not len(here):
                continue
            a, b = i[here] + di, j[here] + dj
            z = points[here, 2, None]
            slots = np.arange(lo.shape[2]) < number[a, b][:, None]
            full = (slots & (lo[a, b] + SKIN < z) & (z < hi[a, b] - SKIN)).any(axis=1)
            weight = (wx if di else 1.0 - wx) * (wy if dj else 1.0 - wy)
            share[here] += np.where(full, weight[here], 0.0)
    filled: NDArray[np.bool_] = share >= _HALF
    return filled
