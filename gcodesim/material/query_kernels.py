"""Queries of a stock: how full a place is, and the total volume."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field, Grid
from gcodesim.material.removal_kernels import overlap

Array = NDArray[np.float64]


@kernel(lean=True)
def surrounding(grid: Grid, x: float, y: float) -> tuple[int, int, float, float]:
    """The four columns around (x, y): first index i, j and weights wx, wy of the second ones [-].

    Weights belong to (i, j): (1-wx)(1-wy), (i+1, j): wx (1-wy), (i, j+1): (1-wx) wy, (i+1, j+1): wx wy.
    Indices may lie outside the stock; there is no material there.
    """
    u = (x - grid.x) / grid.dx - 0.5
    v = (y - grid.y) / grid.dy - 0.5
    i, j = np.floor(u), np.floor(v)
    return int(i), int(j), u - i, v - j


@kernel(lean=True, inlined=True)
def occupancy(field: Field, x: float, y: float, z0: float, z1: float) -> float:
    """Share [-] of the height z0..z1 (z0 < z1) [m] that is material at (x, y): bilinear between column centres."""
    return occupancy_of(field.columns, field.grid, x, y, z0, z1)


@kernel(lean=True)
def occupancy_of(columns: Columns, grid: Grid, x: float, y: float, z0: float, z1: float) -> float:
    """Share [-] of the height z0..z1 (z0 < z1) [m] that is material at (x, y): bilinear between column centres.

    It changes continuously with x, y, z0 and z1, so that forces and deflections can be solved together.
    """
    nx, ny = columns.number.shape
    i, j, wx, wy = surrounding(grid, x, y)
    total = 0.0
    for di in range(2):
        if not (0 <= i + di < nx):
            continue
        weight_x = wx if di == 1 else 1.0 - wx
        for dj in range(2):
            if not (0 <= j + dj < ny):
                continue
            weight = weight_x * (wy if dj == 1 else 1.0 - wy)
            if weight > 0.0:
                total += weight * overlap(columns, i + di, j + dj, z0, z1)
    return total / (z1 - z0)


@kernel(lean=True, inlined=True)
def surface_around(field: Field, x: float, y: float) -> tuple[float, float]:
    """Height [m] of the top at (x, y), and by how much the four column centres differ between which that is.

    The height is bilinear; -inf, and differs without end, if any of the columns is empty.
    """
    (_, hi, count), (i, j, wx, wy) = field.columns, surrounding(field.grid, x, y)
    nx, ny = count.shape
    if i < 0 or j < 0 or i + 1 >= nx or j + 1 >= ny:
        return -np.inf, np.inf
    height, least, most = 0.0, np.inf, -np.inf
    for di in range(2):
        for dj in range(2):
            last = count[i + di, j + dj] - 1
            if last < 0:
                return -np.inf, np.inf
            top = hi[i + di, j + dj, last]
            least, most = min(least, top), max(most, top)
            height += (wx if di == 1 else 1.0 - wx) * (wy if dj == 1 else 1.0 - wy) * top
    return float(height), float(most - least)


@kernel(lean=True, inlined=True)
def highest_at(field: Field, i: int, j: int) -> float:
    """Height [m] of the top of column (i, j); -inf if it is empty or outside the stock."""
    _, hi, count = field.columns
    if i < 0 or j < 0 or i >= count.shape[0] or j >= count.shape[1] or count[i, j] == 0:
        return -np.inf
    return float(hi[i, j, count[i, j] - 1])


@kernel(lean=True, inlined=True)
def fill_slices(field: Field, x: float, y: float, z0: float, dz: float, out: Array) -> float:
    """`occupancy` of slices of height dz [m] above each other, the first from z0, into `out`; their sum."""
    return slices_of(field.columns, field.grid, x, y, z0, dz, out)


@kernel(lean=True)
def slices_of(columns: Columns, grid: Grid, x: float, y: float, z0: float, dz: float, out: Array) -> float:
    """The same for `out.size` slices of height dz [m] above each other, the first from z0: their shares [-] into `out`.

    One look at the four columns serves all slices. Returns the sum of the shares (0: no material here).
    """
    lo, hi, count = columns
    nx, ny = count.shape
    slices = out.shape[0]
    for s in range(slices):
        out[s] = 0.0
    i, j, wx, wy = surrounding(grid, x, y)
    z_end = z0 + dz * slices
    total = 0.0
    for di in range(2):
        if not (0 <= i + di < nx):
            continue
        weight_x = wx if di == 1 else 1.0 - wx
        for dj in range(2):
            if not (0 <= j + dj < ny):
                continue
            weight = weight_x * (wy if dj == 1 else 1.0 - wy)
            if weight <= 0.0:
                continue
            for k in range(count[i + di, j + dj]):
                low, high = max(lo[i + di, j + dj, k], z0), min(hi[i + di, j + dj, k], z_end)
                if high <= low:
                    continue
                a, b = (low - z0) / dz, (high - z0) / dz
                s_first, s_last = min(int(a), slices - 1), min(int(b), slices - 1)
                for s in range(s_first, s_last + 1):
                    share = weight * (min(b, s + 1.0) - max(a, float(s)))
                    out[s] += share
                    total += share
    return total


@kernel(lean=True)
def volume_of(field: Field) -> float:
    """Volume [m^3] of all material; summed row by row, so that the rounding of a large stock stays small."""
    (lo, hi, count), grid = field.columns, field.grid
    nx, ny = count.shape
    total = 0.0
    for i in range(nx):
        row = 0.0
        for j in range(ny):
            for k in range(count[i, j]):
                row += hi[i, j, k] - lo[i, j, k]
        total += row
    return total * float(grid.dx * grid.dy)


@kernel(lean=True)
def difference(a: Columns, ia: int, ja: int, b: Columns, ib: int, jb: int) -> float:
    """Length [m] that is material in exactly one of column (ia, ja) of `a` and (ib, jb) of `b`."""
    a_all, b_all, both = 0.0, 0.0, 0.0
    for k in range(a.number[ia, ja]):
        a_all += a.hi[ia, ja, k] - a.lo[ia, ja, k]
        both += overlap(b, ib, jb, a.lo[ia, ja, k], a.hi[ia, ja, k])
    for k in range(b.number[ib, jb]):
        b_all += b.hi[ib, jb, k] - b.lo[ib, jb, k]
    return max(a_all + b_all - 2.0 * both, 0.0)
