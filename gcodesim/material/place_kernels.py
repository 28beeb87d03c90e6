"""How full a stock is at many places at once, as needed for the forces of a cutter.

Places are counted in columns: whole numbers are the centres of columns. So the loops over them have no branches, and
several places go at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Field, Grid
from gcodesim.material.query_kernels import occupancy, surrounding

Array = NDArray[np.float64]

ELSEWHERE = -1.0  # not a share: the place has to be asked separately
OUTSIDE = 1.0e-6  # columns beyond the outermost from which on there is none, however a place is rounded


class ToColumns(NamedTuple):
    """From u, l [m] about a point to places in columns: (i0 + i_u u + i_l l, j0 + j_u u + j_l l).

    And the columns (nx, ny): the ends of all intervals in one row.
    """

    i0: float
    j0: float
    i_u: float
    i_l: float
    j_u: float
    j_l: float
    lo: Array
    hi: Array
    nx: int
    ny: int


class Places(NamedTuple):
    """Places (n,) in units of columns, `us` along x and `vs` along y, and how far above given heights to ask [m]."""

    us: Array
    vs: Array
    ups: Array


@kernel(lean=True, inlined=True)
def to_columns(field: Field, point: Array, ux: float, uy: float) -> ToColumns:
    """u points along the unit vector (ux, uy), l to its left; both begin above `point`."""
    (lo, hi, count), grid = field.columns, field.grid
    to_x, to_y = 1.0 / grid.dx, 1.0 / grid.dy
    return ToColumns(
        (point[0] - grid.x) * to_x - 0.5, (point[1] - grid.y) * to_y - 0.5, ux * to_x, -uy * to_x, uy * to_y, ux * to_y,
        lo.reshape(lo.size), hi.reshape(hi.size), count.shape[0], count.shape[1],
    )  # fmt: skip


@kernel(lean=True, inlined=True)
def share_between(field: Field, x: float, y: float, z0: float, z1: float) -> float:
    """`occupancy`, but quicker where each of the columns around (x, y) has one interval, as is common."""
    i, j, wx, wy = surrounding(field.grid, x, y)
    lo, hi, count = field.columns
    if i < 0 or j < 0 or i + 1 >= count.shape[0] or j + 1 >= count.shape[1]:
        return float(occupancy(field, x, y, z0, z1))
    if count[i, j] * count[i + 1, j] * count[i, j + 1] * count[i + 1, j + 1] != 1:
        return float(occupancy(field, x, y, z0, z1))
    a = max(min(hi[i, j, 0], z1) - max(lo[i, j, 0], z0), 0.0)
    b = max(min(hi[i + 1, j, 0], z1) - max(lo[i + 1, j, 0], z0), 0.0)
    c = max(min(hi[i, j + 1, 0], z1) - max(lo[i, j + 1, 0], z0), 0.0)
    d = max(min(hi[i + 1, j + 1, 0], z1) - max(lo[i + 1, j + 1, 0], z0), 0.0)
    return float(((1.0 - wy) * ((1.0 - wx) * a + wx * b) + wy * ((1.0 - wx) * c + wx * d)) / (z1 - z0))


@kernel(lean=True)
def read_single(
    lo: Array, hi: Array, nx: int, ny: int, places: Places, bottom: float, top: float, share: Array
) -> None:
    """`ask_places` for columns with one interval each."""
    us, vs, ups = places
    last_i, last_j, row = np.float64(nx - 2), np.float64(ny - 2), np.uint64(ny)
    before, beyond_i, beyond_j = -1.0 - OUTSIDE, nx + OUTSIDE, ny + OUTSIDE
    scale = 1.0 / (top - bottom)
    for k in range(share.shape[0]):
        u, v = min(max(us[k], 0.0), last_i), min(max(vs[k], 0.0), last_j)
        # truncation equals the floor here; unsigned indices save the check for negative ones
        i, j = np.uint64(u), np.uint64(v)
        a = i * row + j
        b = a + row
        z0, z1 = bottom + ups[k], top + ups[k]
        wx, wy = u - np.float64(i), v - np.float64(j)
        near = (1.0 - wx) * max(min(hi[a], z1) - max(lo[a], z0), 0.0)
        near += wx * max(min(hi[b], z1) - max(lo[b], z0), 0.0)
        a += np.uint64(1)
        b += np.uint64(1)
        far = (1.0 - wx) * max(min(hi[a], z1) - max(lo[a], z0), 0.0)
        far += wx * max(min(hi[b], z1) - max(lo[b], z0), 0.0)
        full = scale * ((1.0 - wy) * near + wy * far)
        outside = (us[k] < before) | (us[k] > beyond_i) | (vs[k] < before) | (vs[k] > beyond_j)
        inside = (u == us[k]) & (v == vs[k])
        share[k] = full if inside else (0.0 if outside else ELSEWHERE)


@kernel(lean=True, inlined=True)
def ask_places(columns: ToColumns, places: Places, bottom: float, top: float, share: Array) -> None:
    """Share (n,) of bottom..top [m], raised by `ups`, that is material at places between column centres.

    ELSEWHERE at places that have some columns around them, but not four, and everywhere when columns have more than one
    interval or the stock is a single row.
    """
    nx, ny = columns.nx, columns.ny
    if columns.lo.size == nx * ny and nx > 1 and ny > 1:  # nearly always
        read_single(columns.lo, columns.hi, nx, ny, places, bottom, top, share)
    else:
        share[:] = ELSEWHERE


class Spots(NamedTuple):
    """Places (n,) x, y, and the heights there from bottom to top, all [m]."""

    xs: Array
    ys: Array
    bottoms: Array
    tops: Array


@kernel(lean=True)
def read_spots(lo: Array, hi: Array, nx: int, ny: int, grid: Grid, spots: Spots, share: Array) -> bool:
    """`ask_spots` for columns with one interval each."""
    xs, ys, bottoms, tops = spots
    gx, gy, dx, dy = grid
    last_i, last_j, row = np.float64(nx - 2), np.float64(ny - 2), np.uint64(ny)
    before, beyond_i, beyond_j = -1.0 - OUTSIDE, nx + OUTSIDE, ny + OUTSIDE
    unknown = np.uint8(0)
    for k in range(share.shape[0]):
        u, v = (xs[k] - gx) / dx - 0.5, (ys[k] - gy) / dy - 0.5
        near_u, near_v = min(max(u, 0.0), last_i), min(max(v, 0.0), last_j)
        i, j = np.uint64(near_u), np.uint64(near_v)
        wx, wy = near_u - np.float64(i), near_v - np.float64(j)
        a = i * row + j
        b = a + row
        c, d = a + np.uint64(1), b + np.uint64(1)
        z0, z1 = bottoms[k], tops[k]
        at_a = max(min(hi[a], z1) - max(lo[a], z0), 0.0)
        at_b = max(min(hi[b], z1) - max(lo[b], z0), 0.0)
        at_c = max(min(hi[c], z1) - max(lo[c], z0), 0.0)
        at_d = max(min(hi[d], z1) - max(lo[d], z0), 0.0)
        full = ((1.0 - wy) * ((1.0 - wx) * at_a + wx * at_b) + wy * ((1.0 - wx) * at_c + wx * at_d)) / (z1 - z0)
        known = np.uint8(u == near_u) & np.uint8(v == near_v)
        known &= np.uint8(hi[a] > lo[a]) & np.uint8(hi[b] > lo[b]) & np.uint8(hi[c] > lo[c]) & np.uint8(hi[d] > lo[d])
        outside = np.uint8(u < before) | np.uint8(u > beyond_i) | np.uint8(v < before) | np.uint8(v > beyond_j)
        share[k] = full if known else (0.0 if outside else ELSEWHERE)
        unknown |= np.uint8(1) - (known | outside)
    return bool(unknown > 0)


@kernel(lean=True, inlined=True)
def ask_spots(field: Field, spots: Spots, share: Array) -> bool:
    """`share_between` for many places (n,), to the bit; whether any is ELSEWHERE.

    It is where not each of the four columns around has one interval, and everywhere when columns have room for more.
    """
    lo, hi, count = field.columns
    nx, ny = count.shape
    if lo.size == nx * ny and nx > 1 and ny > 1:  # nearly always
        return read_spots(lo.reshape(lo.size), hi.reshape(hi.size), nx, ny, field.grid, spots, share)
    share[:] = ELSEWHERE
    return True
