"""Stocks side by side in the arrays of one kernel, which so needs no code of its own for each number of stocks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gcodesim.material.beam_in_parts_kernels import AblatingParts
from gcodesim.material.beam_kernels import CROWDED
from gcodesim.material.field_kernels import Columns

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gcodesim.material.stock import Stock


def side_by_side(stocks: Sequence[Stock], kind: str, threshold: float) -> AblatingParts:
    """Copies of the columns of m stocks, their walls, and the doses of a `kind`; `threshold` [per m²] is for all."""
    fields = [stock.field for stock in stocks]
    return AblatingParts(
        lo=_stacked([field.columns.lo for field in fields]),
        hi=_stacked([field.columns.hi for field in fields]),
        number=_stacked([field.columns.number for field in fields]),
        grids=np.array([field.grid for field in fields]),
        walls=_stacked([field.walls for field in fields]),
        dirty=_stacked([field.dirty for field in fields]),
        tops=_stacked([field.tops for field in fields]),
        dose=_stacked([stock.doses[kind] for stock in stocks]),
        threshold=threshold,
        notes=np.zeros((len(stocks), 2)),
    )


def put_back(parts: AblatingParts, stocks: Sequence[Stock], kind: str) -> None:
    """Give m stocks what has become of their copies, and more room where a column had none."""
    for k, stock in enumerate(stocks):
        field = stock.field
        nx, ny = field.columns.number.shape
        own = slice(nx), slice(ny)
        columns = Columns(parts.lo[k][own].copy(), parts.hi[k][own].copy(), parts.number[k][own].copy())
        stock.field = field._replace(columns=columns)
        for kept, rows in (
            (field.walls, parts.walls),
            (field.dirty, parts.dirty),
            (field.tops, parts.tops),
            (stock.doses[kind], parts.dose),
        ):
            kept[...] = rows[k][tuple(slice(size) for size in kept.shape)]
        if parts.notes[k, CROWDED]:
            stock.grow()


def _stacked(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Arrays of one kind one above the other, each in the room of the greatest and zero beyond its own."""
    room = np.max([array.shape for array in arrays], axis=0)
    rows = np.zeros((len(arrays), *room), dtype=arrays[0].dtype)
    for row, array in zip(rows, arrays, strict=True):
        row[tuple(slice(size) for size in array.shape)] = array
    return rows
