"""Questions to a stock: how full a place is, how high, how much in all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.removal_kernels import overlap, patch_top

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]


@kernel(lean=True)
def surrounding(grid: Array, x: float, y: float) -> tuple[int, int, float, float]:
    """The four columns around (x, y): first index i, j and weights wx, wy of the second ones [-].

    Weights belong to (i, j): (1-wx)(1-wy), (i+1, j): wx (1-wy), (i, j+1): (1-wx) wy, (i+1, j+1): wx wy.
    Indices may lie outside the stock; there is no material there.
    """
    u = (x - grid[0]) / grid[2] - 0.5
    v = (y - grid[1]) / grid[3] - 0.5
    i, j = np.floor(u), np.floor(v)
    return int(i), int(j), u - i, v - j


@kernel(lean=True)
def occupancy(lo: Array, hi: Array, count: Ints, grid: Array, x: float, y: float, z0: float, z1: float) -> float:
    """Share [-] of the height z0..z1 (z0 < z1) [m] that is material at (x, y): bilinear between column centres.

    It changes continuously with x, y, z0 and z1, so that forces and deflections can be solved together.
    """
    nx, ny = count.shape
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
                total += weight * overlap(lo, hi, count, i + di, j + dj, z0, z1)
    return total / (z1 - z0)


@kernel(lean=True)
def fill_slices(
    lo: Array, hi: Array, count: Ints, grid: Array, x: float, y: float, z0: float, dz: float, out: Array
) -> float:
    """The same for `out.size` slices of height dz [m] above each other, the first from z0: their shares [-] into `out`.

    One look at the four columns serves all slices. Returns the sum of the shares (0: no material here).
    """
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
def highest(hi: Array, count: Ints, grid: Array, x: float, y: float) -> float:
    """Height [m] of the highest material in the column that holds (x, y); -inf when there is none."""
    nx, ny = count.shape
    i, j = int(np.floor((x - grid[0]) / grid[2])), int(np.floor((y - grid[1]) / grid[3]))
    if not (0 <= i < nx and 0 <= j < ny) or count[i, j] == 0:
        return -np.inf
    return float(hi[i, j, count[i, j] - 1])


@kernel(lean=True)
def is_material(lo: Array, hi: Array, count: Ints, grid: Array, x: float, y: float, z: float) -> bool:
    """Whether the point (x, y, z) [m] lies in material."""
    nx, ny = count.shape
    i, j = int(np.floor((x - grid[0]) / grid[2])), int(np.floor((y - grid[1]) / grid[3]))
    if not (0 <= i < nx and 0 <= j < ny):
        return False
    inside = False
    for k in range(count[i, j]):
        inside |= lo[i, j, k] <= z <= hi[i, j, k]
    return inside


@kernel(lean=True)
def highest_under(hi: Array, count: Ints, grid: Array, x: float, y: float, radius: float) -> float:
    """Height [m] of the highest material under a disc of `radius` around (x, y); -inf when there is none."""
    nx, ny = count.shape
    top = -np.inf
    first_i = max(int(np.floor((x - radius - grid[0]) / grid[2])), 0)
    last_i = min(int(np.floor((x + radius - grid[0]) / grid[2])) + 1, nx)
    first_j = max(int(np.floor((y - radius - grid[1]) / grid[3])), 0)
    last_j = min(int(np.floor((y + radius - grid[1]) / grid[3])) + 1, ny)
    for i in range(first_i, last_i):
        cx = grid[0] + (i + 0.5) * grid[2] - x
        for j in range(first_j, last_j):
            cy = grid[1] + (j + 0.5) * grid[3] - y
            n = count[i, j]
            if n > 0 and cx * cx + cy * cy <= radius * radius and hi[i, j, n - 1] > top:
                top = hi[i, j, n - 1]
    return top


@kernel(lean=True)
def volume_of(lo: Array, hi: Array, count: Ints, grid: Array) -> float:
    """Volume [m^3] of all material; summed row by row, so that the rounding of a large stock stays small."""
    nx, ny = count.shape
    total = 0.0
    for i in range(nx):
        row = 0.0
        for j in range(ny):
            for k in range(count[i, j]):
                row += hi[i, j, k] - lo[i, j, k]
        total += row
    return total * float(grid[2] * grid[3])


@kernel(lean=True)
def patch_tops(hi: Array, count: Ints, tops: Array) -> None:
    """Fill `tops` (patches) with the height [m] of the highest material of each patch."""
    for pi in range(tops.shape[0]):
        for pj in range(tops.shape[1]):
            tops[pi, pj] = patch_top(hi, count, pi, pj)


@kernel(lean=True)
def difference(
    lo_a: Array, hi_a: Array, count_a: Ints, ia: int, ja: int, lo_b: Array, hi_b: Array, count_b: Ints, ib: int, jb: int
) -> float:
    """Length [m] that is material in exactly one of column (ia, ja) of stock a and (ib, jb) of stock b."""
    a_all, b_all, both = 0.0, 0.0, 0.0
    for k in range(count_a[ia, ja]):
        a_all += hi_a[ia, ja, k] - lo_a[ia, ja, k]
        both += overlap(lo_b, hi_b, count_b, ib, jb, lo_a[ia, ja, k], hi_a[ia, ja, k])
    for k in range(count_b[ib, jb]):
        b_all += hi_b[ib, jb, k] - lo_b[ib, jb, k]
    return max(a_all + b_all - 2.0 * both, 0.0)
