"""Tiles for the log: their columns from a stock, and their triangles separated by class, small and quick to write."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns
from gcodesim.material.flat_kernels import PatchTriangles

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


@kernel(lean=True)
def take_columns(columns: Columns, ix: Ints, iy: Ints, taken: Columns) -> None:
    """Copy the columns at `ix` (m,) and `iy` (n,) to those (m, n) of `taken`; of each only its used intervals."""
    lo, hi, count = columns
    for a in range(len(ix)):
        for b in range(len(iy)):
            i, j = ix[a], iy[b]
            pieces = count[i, j]
            taken.number[a, b] = pieces
            for k in range(pieces):
                taken.lo[a, b, k], taken.hi[a, b, k] = lo[i, j, k], hi[i, j, k]


@kernel(lean=True, inlined=True)
def is_void(columns: Columns, i: int, j: int, k: int, closing: float, original: Columns) -> bool:
    """Whether the gap above interval k, if less than `closing` [m] high, was no material at the start either."""
    lo, hi, _ = columns
    bottom, top = hi[i, j, k], lo[i, j, k + 1]
    if top - bottom >= closing:
        return False
    at_i, at_j = min(i, original.number.shape[0] - 1), min(j, original.number.shape[1] - 1)
    for m in range(original.number[at_i, at_j]):
        if original.lo[at_i, at_j, m] < top and original.hi[at_i, at_j, m] > bottom:
            return False
    return True


@kernel(lean=True)
def most_intervals(columns: Columns, ix: Ints, iy: Ints) -> int:
    """The greatest number of intervals in the columns at `ix` (m,) and `iy` (n,)."""
    most = 0
    for a in range(len(ix)):
        for b in range(len(iy)):
            most = max(most, columns.number[ix[a], iy[b]])
    return most


@kernel(lean=True)
def close_voids(columns: Columns, original: Columns, closing: float) -> int:
    """Close gaps between what was laid that are less than `closing` [m] high, in place; the most intervals then.

    `original` are the columns at the start, or one for all.
    """
    lo, hi, count = columns
    most = 0
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            kept = 0
            for k in range(count[i, j]):
                if k > 0 and is_void(columns, i, j, k - 1, closing, original):
                    hi[i, j, kept - 1] = hi[i, j, k]
                    continue
                kept += 1
                lo[i, j, kept - 1], hi[i, j, kept - 1] = lo[i, j, k], hi[i, j, k]
            count[i, j] = kept
            most = max(most, kept)
    return most


@kernel(lean=True)
def same_columns(columns: Columns, before: Columns) -> bool:
    """Whether as many columns have the same pieces as before."""
    lo, hi, count = columns
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            if count[i, j] != before.number[i, j]:
                return False
            for k in range(count[i, j]):
                if lo[i, j, k] != before.lo[i, j, k] or hi[i, j, k] != before.hi[i, j, k]:
                    return False
    return True


@kernel
def facets_of(
    points: Array, fine: PatchTriangles, coarse: PatchTriangles, which: int, rounding: float
) -> tuple[Array, Ints]:
    """The triangles (f, 3) of one class out of two lists of them, and the points (v, 3) [m] that they have.

    Points stay in their order and become whole multiples of 1 / rounding.
    """
    faces, cut = fine
    flat_parts, flat_cut = coarse
    number = np.full(len(points), -1, np.int32)
    found = 0
    for f in range(len(faces)):
        if cut[f] == which:
            number[faces[f, 0]], number[faces[f, 1]], number[faces[f, 2]] = 0, 0, 0
            found += 1
    for f in range(len(flat_parts)):
        if flat_cut[f] == which:
            number[flat_parts[f, 0]], number[flat_parts[f, 1]], number[flat_parts[f, 2]] = 0, 0, 0
            found += 1
    used = 0
    for v in range(len(points)):
        if number[v] == 0:
            number[v] = used
            used += 1
    kept = np.empty((used, 3))
    for v in range(len(points)):
        if number[v] >= 0:
            for d in range(3):
                # + 0.0 turns -0.0 into 0.0
                kept[number[v], d] = np.rint(points[v, d] * rounding) / rounding + 0.0
    triangles = np.empty((found, 3), np.int32)
    found = 0
    for f in range(len(faces)):
        if cut[f] == which:
            for d in range(3):
                triangles[found, d] = number[faces[f, d]]
            found += 1
    for f in range(len(flat_parts)):
        if flat_cut[f] == which:
            for d in range(3):
                triangles[found, d] = number[flat_parts[f, d]]
            found += 1
    return kept, triangles
