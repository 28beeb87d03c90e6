"""Pieces that came loose: found in the columns of a stock, measured, and taken out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gcodesim.material.field_kernels import Columns
    from gcodesim.material.loose_kernels import PieceSizes
    from gcodesim.material.stock import Stock

Array = NDArray[np.float64]

FEWEST: Final = 16
"""Columns of a piece, at least: less is what a grid leaves standing beside a wall."""


class PartedPiece(NamedTuple):
    """A piece that hangs on nothing: its volume [m³] and its box, `low` and `high` (3,) [m] in S."""

    volume: float
    low: Array
    high: Array


def may_be_apart(stock: Stock) -> bool:
    """Whether a stock could lie in pieces: where all columns are whole and stand on one floor, it cannot."""
    lo, _, number = stock.field.columns
    if lo.shape[2] > 1 and bool((number > 1).any()):
        return True
    if bool((number == 1).all()):
        return bool(lo[:, :, 0].max() > lo[:, :, 0].min())
    return True


class _Pieces(NamedTuple):
    """Numbers of the pieces (nx, ny, k) in which intervals lie, from 1 on, and their sizes."""

    label: NDArray[np.int32]
    sizes: PieceSizes


def _pieces_of(columns: Columns) -> _Pieces:
    from gcodesim.material.loose_kernels import PieceSizes, measure_pieces, number_pieces

    label = np.zeros(columns.lo.shape, dtype=np.int32)
    count = number_pieces(columns, label, np.zeros(int(columns.number.sum()) + 1, dtype=np.int64))
    sizes = PieceSizes(np.zeros(count), np.zeros(count), np.full((count, 3), np.inf), np.full((count, 3), -np.inf))
    measure_pieces(columns, label, sizes)
    return _Pieces(label, sizes)


def drop_loose(stock: Stock) -> list[PartedPiece]:
    """Take all pieces but the greatest out of `stock` (in place), greatest first; crumbs stay.

    Pieces hang together where columns that share a side do, so a tab holds if it is a column wide. Columns along x and
    y are given up if anything falls. A stock that was in pieces from the start keeps them all.
    """
    if not may_be_apart(stock):
        return []
    from gcodesim.material.loose_kernels import take_pieces

    label, sizes = _pieces_of(stock.field.columns)
    order = np.argsort(-sizes.length, kind="stable")
    loose = [int(p) for p in order[1:] if sizes.intervals[p] >= FEWEST]
    if not loose or int((_pieces_of(stock.original).sizes.intervals >= FEWEST).sum()) > 1:
        return []
    goes = np.zeros(len(order), dtype=np.uint8)
    goes[loose] = 1
    stock.lattice = None
    take_pieces(stock.field, label, goes)
    corner, spacing = np.append(stock.origin, 0.0), np.append(stock.spacing, 1.0)
    beyond, area = np.array([1.0, 1.0, 0.0]), float(np.prod(stock.spacing))
    return [
        PartedPiece(
            volume=float(sizes.length[p]) * area,
            low=corner + spacing * sizes.low[p],
            high=corner + spacing * (sizes.high[p] + beyond),
        )
        for p in loose
    ]
