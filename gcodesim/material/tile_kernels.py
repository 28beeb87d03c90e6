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
