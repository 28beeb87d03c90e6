"""The stock of a lathe in columns: what a driven tool cuts, since a body of revolution cannot hold that.

All columns are exact: those along Z end where rings begin and end, those across Z on the circles of their disc. The
volume begins with that of the profile, whatever the grid, and falls by what is cut.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import log10, power
from gcodesim.material.field_kernels import Array, Columns, Grid
from gcodesim.material.lattice import Lattice, both_of, ensure_lattice, field_of
from gcodesim.material.revolved_kernels import columns_across, columns_along
from gcodesim.material.stock import BYTES_PER_COLUMN, Lines, Stock, cells_along, grid_of

if TYPE_CHECKING:
    from gcodesim.material.revolved import Profile


def in_columns(profile: Profile, radius: float, resolution: float, material: str = "") -> Stock:
    """The body of a profile within `radius` [m] in columns along three axes, at most `resolution` [m] apart."""
    low, high = np.array([-radius, -radius, profile.z]), np.array([radius, radius, profile.top])
    upright, grid = _upright(profile, low, high, resolution)
    stock = Stock(
        columns=upright,
        grid=grid,
        z_range=(float(low[2]), float(high[2])),
        resolution=resolution,
        material=material,
    )

    def exact(order: tuple[int, int, int]) -> Lines:
        if order == (0, 1, 2):
            return _upright(profile, low, high, resolution)
        corners = low[list(order)], high[list(order)]
        at, shape = grid_of(*corners, resolution)
        flat = 0 if order[0] == 2 else 1  # where z is among the two axes of the grid
        z = _centres(at, shape, flat)
        across = _centres(at, shape, 1 - flat)
        lo, hi, number = columns_across(profile.lo, profile.hi, profile.number, profile.z, profile.dz, across, z)
        if flat == 0:
            lo, hi, number = lo.transpose(1, 0, 2), hi.transpose(1, 0, 2), number.T
        return Columns(*map(np.ascontiguousarray, (lo, hi, number))), at

    stock.exact = exact
    ensure_lattice(stock).offset += profile.volume - stock.volume
    return stock


def within(stock: Stock, profile: Profile, radius: float) -> Stock:
    """What of a stock in columns lies in the body of a profile as well; what it is like at the start is that body."""
    fresh = in_columns(profile, radius, stock.resolution, stock.material)
    own, lattice = ensure_lattice(stock), ensure_lattice(fresh)
    upright, _ = both_of((stock.field.columns, stock.field.grid), (fresh.field.columns, fresh.field.grid))
    x, y = (
        field_of(*both_of((old.columns, old.grid), (new.columns, new.grid)))
        for old, new in zip(own.fields, lattice.fields, strict=True)
    )
    kept = Stock(
        columns=upright,
        grid=fresh.field.grid,
        z_range=fresh.z_range,
        resolution=stock.resolution,
        material=stock.material,
        original=fresh.original,
    )
    kept.lattice = Lattice((x, y), lattice.start, lattice.offset)
    kept.exact = fresh.exact
    return kept


def memory_of_columns(size: Sequence[float], resolution: float) -> int:
    """Bytes that the columns of a bar in a box of `size` (x, y, z) take at `resolution` [m]: along three axes."""
    x, y, z = (cells_along(side, resolution) for side in size)
    return (x * y + y * z + z * x) * BYTES_PER_COLUMN


def finest_columns(size: Sequence[float], budget: int) -> float:
    """The finest resolution [m], two digits, at which these columns fit into `budget` bytes."""
    x, y, z = size
    fit = float(np.sqrt((x * y + y * z + z * x) * BYTES_PER_COLUMN / budget))
    step = power(10.0, np.floor(log10(fit) - 1.0))
    wanted = float(np.ceil(fit / step) * step)
    while memory_of_columns(size, wanted) > budget:
        wanted += step
    return wanted


def _upright(profile: Profile, low: Array, high: Array, resolution: float) -> Lines:
    """Columns along Z. Many stand at the same distance from the axis; each such distance is looked at once."""
    grid, shape = grid_of(low, high, resolution)
    x, y = _centres(grid, shape, 0), _centres(grid, shape, 1)
    square = np.round((x[:, None] * x[:, None] + y[None, :] * y[None, :]) * 1e15)
    radii, which = np.unique(square, return_inverse=True)
    begins = _first_of_runs(profile)
    lo, hi, number = columns_along(
        np.sqrt(radii * 1e-15), profile.lo[begins], profile.hi[begins], profile.number[begins], profile.heights(begins)
    )
    which = which.reshape(shape)
    k = max(1, int(number.max(initial=0)))
    return Columns(*map(np.ascontiguousarray, (lo[which, :k], hi[which, :k], number[which]))), grid


def _first_of_runs(profile: Profile) -> NDArray[np.int64]:
    """The first disc of each run of equal discs."""
    lo, hi, number = profile.lo, profile.hi, profile.number
    used = np.arange(lo.shape[1])[None, :] < number[:, None]
    lo, hi = np.where(used, lo, 0.0), np.where(used, hi, 0.0)
    other = (np.diff(lo, axis=0) != 0.0).any(axis=1) | (np.diff(hi, axis=0) != 0.0).any(axis=1) | (np.diff(number) != 0)
    begins: NDArray[np.int64] = np.concatenate([[0], np.flatnonzero(other) + 1])
    return begins


def _centres(grid: Grid, shape: tuple[int, int], axis: int) -> Array:
    """Where columns stand along the first or the second axis of a grid."""
    origin, step = (grid.x, grid.dx) if axis == 0 else (grid.y, grid.dy)
    centres: Array = np.asarray(origin + (np.arange(shape[axis]) + 0.5) * step, dtype=float)
    return centres
