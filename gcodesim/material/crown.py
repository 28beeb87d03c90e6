"""Laying molten beads on a stock."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.material.crown_kernels import Crown, Molten, melt

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock

__all__ = ["Crown", "Molten", "melt_onto"]


def melt_onto(stock: Stock, crown: Crown) -> Molten:
    """Lay molten beads on whatever lies below them, in place. Columns along x and y are given up."""
    stock.lattice = None
    molten = Molten(*np.zeros((2, len(crown.volumes))))
    ways, volumes, widths = (np.ascontiguousarray(part) for part in (crown.ways, crown.volumes, crown.widths))
    crown = Crown(ways, volumes, widths, crown.reach)
    done = 0
    while (done := melt(stock.field, crown, done, molten)) < len(crown.volumes):
        stock.grow()
    return molten
