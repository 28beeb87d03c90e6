"""Pieces of a stock that hang together: numbered in its columns, and taken out of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field
from gcodesim.material.wall_kernels import shorten_walls

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

TOUCHING = 1.0e-9
"""Height [m] over which intervals of neighbours have to overlap to hang together."""


class PieceSizes(NamedTuple):
    """Of each piece: `length` of its intervals [m], by a cell's area its volume; its number of `intervals`; the box of
    its columns and heights, `low` and `high` (m, 3): two indices and a height [m]."""

    length: Array
    intervals: Array
    low: Array
    high: Array


@kernel
def number_pieces(columns: Columns, label: Ints, waiting: NDArray[np.int64]) -> int:
    """Number the pieces in which intervals hang together across the sides of columns; how many there are.

    label (nx, ny, k) gets numbers from 1 on where it was 0; `waiting` has room for all intervals.
    """
    lo, hi, count = columns
    nx, ny, room = lo.shape
    pieces = 0
    for i0 in range(nx):
        for j0 in range(ny):
            for k0 in range(count[i0, j0]):
                if label[i0, j0, k0] > 0:
                    continue
                pieces += 1
                label[i0, j0, k0] = pieces
                waiting[0] = (i0 * ny + j0) * room + k0
                number = 1
                while number > 0:
                    number -= 1
                    k = waiting[number] % room
                    j = waiting[number] // room % ny
                    i = waiting[number] // room // ny
                    low, high = lo[i, j, k] + TOUCHING, hi[i, j, k] - TOUCHING
                    for side in range(4):
                        a = i + (1 if side == 0 else -1 if side == 1 else 0)
                        b = j + (1 if side == 2 else -1 if side == 3 else 0)
                        if a < 0 or b < 0 or a >= nx or b >= ny:
                            continue
                        for c in range(count[a, b]):
                            if label[a, b, c] == 0 and lo[a, b, c] < high and hi[a, b, c] > low:
                                label[a, b, c] = pieces
                                waiting[number] = (a * ny + b) * room + c
                                number += 1
    return pieces


@kernel
def measure_pieces(columns: Columns, label: Ints, sizes: PieceSizes) -> None:
    """Add up the `sizes` of all pieces; lows begin at infinity, highs at minus infinity."""
    lo, hi, count = columns
    for i in range(lo.shape[0]):
        for j in range(lo.shape[1]):
            for k in range(count[i, j]):
                p = label[i, j, k] - 1
                sizes.length[p] += hi[i, j, k] - lo[i, j, k]
                sizes.intervals[p] += 1.0
                for axis in range(3):
                    least = float(i) if axis == 0 else float(j) if axis == 1 else lo[i, j, k]
                    most = float(i) if axis == 0 else float(j) if axis == 1 else hi[i, j, k]
                    sizes.low[p, axis] = min(sizes.low[p, axis], least)
                    sizes.high[p, axis] = max(sizes.high[p, axis], most)


@kernel
def take_pieces(field: Field, label: Ints, goes: NDArray[np.uint8]) -> None:
    """Take the pieces that `goes` names, by their number less one, out of the columns; walls go with them."""
    columns = field.columns
    lo, hi, count = columns
    for i in range(lo.shape[0]):
        for j in range(lo.shape[1]):
            kept, gone = 0, 0.0
            for k in range(count[i, j]):
                if goes[label[i, j, k] - 1] == 0:
                    lo[i, j, kept], hi[i, j, kept] = lo[i, j, k], hi[i, j, k]
                    kept += 1
                else:
                    gone += hi[i, j, k] - lo[i, j, k]
            if kept == count[i, j]:
                continue
            count[i, j] = kept
            if kept == 0:
                hi[i, j, 0] = lo[i, j, 0]
            shorten_walls(field.walls, i, j, gone)
            field.dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
