"""Centre of mass and inertia of a stock of even density."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.solids.mass import MassOfSkin

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock


def mass_of_stock(stock: Stock, mass: float) -> MassOfSkin | None:
    """Mass [kg], centre and inertia of a stock in the part's own frame S; None where nothing is left of it.

    From the columns, whose places are those of the cells: walls inside of a cell count by whole columns, so that the
    centre lies within a small share of a cell of the true one.
    """
    from gcodesim.material.moment_kernels import moments_of_columns

    low, high = stock.bounds
    middle, sums = 0.5 * (low + high), np.zeros(10)
    moments_of_columns(stock.field.columns, stock.field.grid, middle, sums)
    if sums[0] <= 0.0:
        return None
    first = sums[1:4] / sums[0]
    xx, yy, zz, xy, yz, zx = (sums[4:] / sums[0]).tolist()
    second = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) - first[:, None] * first[None, :]
    second = mass * multiplied(stock.turn, second, stock.turn.T)
    return MassOfSkin(
        mass=mass,
        center=applied(stock.turn, middle + first),
        inertia=(second[0, 0] + second[1, 1] + second[2, 2]) * np.eye(3) - second,
    )
