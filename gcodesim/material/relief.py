"""The height of a stock, column by column; used to compare two stocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]


@frozen(eq=False)
class Relief:
    """`tops` (nx, ny): height of the top of each column [m], NaN where it is empty; `lengths` of its material [m].

    `corner` and `cell` (x, y) [m] say where the columns are.
    """

    corner: tuple[float, float]
    cell: tuple[float, float]
    tops: Array
    lengths: Array

    def is_on_grid_of(self, other: Relief) -> bool:
        """Whether both have their columns at the same places."""
        mine, its = (*self.corner, *self.cell), (*other.corner, *other.cell)
        return self.tops.shape == other.tops.shape and np.allclose(its, mine, atol=1e-9)

    def tops_at(self, other: Relief) -> Array:
        """`tops` for the columns of another relief, taken where their centres are; NaN outside."""
        if self.is_on_grid_of(other):
            return self.tops
        (x0, y0), (dx, dy), (nx, ny) = other.corner, other.cell, other.tops.shape
        x = x0 + (np.arange(nx) + 0.5) * dx
        y = y0 + (np.arange(ny) + 0.5) * dy
        i = np.floor((x - self.corner[0]) / self.cell[0]).astype(int)
        j = np.floor((y - self.corner[1]) / self.cell[1]).astype(int)
        wide, deep = self.tops.shape
        inside = ((i >= 0) & (i < wide))[:, None] & ((j >= 0) & (j < deep))[None, :]
        nearest = self.tops[np.clip(i, 0, wide - 1)][:, np.clip(j, 0, deep - 1)]
        return np.where(inside, nearest, np.nan)


def relief_of(stock: Stock) -> Relief:
    """The relief of a stock as it is now."""
    lo, hi, count = stock.field.columns
    x, y, dx, dy = stock.field.grid
    used = np.arange(lo.shape[2])[None, None, :] < count[:, :, None]
    tops = np.max(np.where(used, hi, -np.inf), axis=2)
    return Relief(
        corner=(x, y),
        cell=(dx, dy),
        tops=np.where(np.isfinite(tops), tops, np.nan),
        lengths=np.where(used, hi - lo, 0.0).sum(axis=2),
    )
