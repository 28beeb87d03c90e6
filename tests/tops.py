"""Heights of a stock, for tests that state where a surface has to be."""

from __future__ import annotations

import math

from gcodesim.material.stock import Stock


def top_at(stock: Stock, x: float, y: float) -> float:
    """Height [m] of the highest material in the column of (x, y); -inf where there is none."""
    return max((high for _, high in stock.intervals_at(x, y)), default=-math.inf)
