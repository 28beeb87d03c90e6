"""Stocks whose columns a test sets or reads itself."""

from __future__ import annotations

import numpy as np

from gcodesim.material.stock import Stock


def raise_from(stock: Stock, first: int, top: float) -> None:
    """Let the columns behind the `first` ones along x end at `top` [m]."""
    stock.field.columns.hi[first:] = top
    stock.field.tops[:] = top


def bottoms_and_tops(stock: Stock) -> tuple[np.ndarray, np.ndarray]:
    """Where the only piece of each column (nx, ny) begins and ends [m]."""
    lo, hi, count = stock.field.columns
    assert count.min() == count.max() == 1
    return lo[:, :, 0], hi[:, :, 0]
