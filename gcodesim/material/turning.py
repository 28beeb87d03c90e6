"""A stock set down on another side: its columns are rebuilt along another axis of the part.

Tools cut stock whose Z is up. A part that lies on its back or on an edge keeps
its frame S; only the columns stand along another axis, in a frame that
`Stock.turn` (3, 3) places in S. Turning a part over (Z to −Z) is exact. Laying it on an edge
samples every old row of columns at the middle of the new ones: floors that are
between them move by up to half a cell, walls stay where the tool left them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import determinant, multiplied
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.stock import Stock, cells_along

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Flags = NDArray[np.bool_]

_QUARTER = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # y becomes x
_ON_EDGE = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])  # x becomes z


def turn_for(up: Array) -> Array:
    """The axes turn (3, 3) that brings the axis of S nearest to `up` (3,) to Z; the identity when that is Z itself."""
    axis = int(np.argmax(np.abs(up) + np.array([0.0, 0.0, 1e-9])))
    if axis == 2:
        return np.eye(3) if up[2] > 0.0 else np.diag([1.0, -1.0, -1.0])
    to_z: Array = multiplied(_ON_EDGE, np.eye(3) if axis == 0 else _QUARTER)
    over: Array = multiplied(np.diag([1.0, -1.0, -1.0]), to_z)
    return to_z if up[axis] > 0.0 else over


def turned(stock: Stock, R: Array) -> Stock:
    """The same material with columns along another axis: points p of its grid's frame become R p.

    `R` (3, 3) turns axes onto axes, ValueError otherwise. `turn` of the result
    keeps the part's frame S; the present state counts as the state at the start.
    """
    whole = np.round(R)
    if np.abs(R - whole).max() > 1e-9 or determinant(whole) < 0.5 or (np.abs(whole).sum(axis=0) != 1.0).any():
        raise ValueError("a stock can only be turned by quarter turns about its axes")
    done, rest = stock, whole
    if rest[2, 1] != 0.0:
        done, rest = _flat(done, _QUARTER), multiplied(rest, _QUARTER.T)
    if rest[2, 0] != 0.0:
        done, rest = on_edge(done), multiplied(rest, _ON_EDGE.T)
    done = _flat(done, rest)
    done.turn = multiplied(stock.turn, whole.T)
    return done


def _flat(stock: Stock, R: Array) -> Stock:
    """Turned so that Z stays or becomes −Z; exact."""
    (lo, hi, count), walls, grid = stock.field.columns, stock.field.walls, np.array(stock.field.grid)
    z_range = stock.z_range
    if R[0, 0] == 0.0:  # x and y change places
        lo, hi, count = lo.transpose(1, 0, 2), hi.transpose(1, 0, 2), count.T
        walls, grid = walls[[1, 0, 3, 2, 5, 4, 7, 6]].transpose(0, 2, 1), grid[[1, 0, 3, 2]]
    signs = R.sum(axis=1)
    for axis in range(2):
        if signs[axis] < 0.0:
            lo, hi, count = np.flip(lo, axis), np.flip(hi, axis), np.flip(count, axis)
            walls = _mirrored(walls, axis)
            grid[axis] = -(grid[axis] + count.shape[axis] * grid[2 + axis])
    if signs[2] < 0.0:
        lo, hi = _upside_down(lo, hi, count)
        z_range = (-z_range[1], -z_range[0])
    made = _like(stock, Columns(lo, hi, count), grid, z_range, walls)
    made.hung = _beyond_each(walls) if signs[2] < 0.0 else None
    return made


def _like(
    stock: Stock,
    columns: Columns,
    grid: Array,
    z_range: tuple[float, float],
    walls: Singles | None = None,
) -> Stock:
    made = Stock(
        columns=Columns(*map(np.ascontiguousarray, columns)),
        grid=Grid(*map(float, grid)),
        z_range=z_range,
        resolution=stock.resolution,
        material=stock.material,
    )
    if walls is not None:
        made.field.walls[:] = walls
    return made


def _beyond_each(walls: Singles) -> Array:
    """What walls take of each column less what they leave of it [m], (nx, ny): the parts of `beyond_columns`."""
    from gcodesim.material.wall_kernels import HEIGHT, LOWER, PLACE, SECOND

    place, height, second, lower = (walls[plane : plane + 2].astype(float) for plane in (PLACE, HEIGHT, SECOND, LOWER))
    beyond = np.abs(place) - 2.0
    taken = np.maximum(beyond, 0.0) * height + np.maximum(second, 0.0) * lower
    left = np.maximum(-beyond, 0.0) * height + np.maximum(-second, 0.0) * lower
    above, below = place < 0.0, place > 0.0  # which column of a border stands
    found: Array = _greatest(taken, above, below) - _greatest(left, below, above)
    return found


def _greatest(length: Array, of_next: Flags, of_last: Flags) -> Array:
    """The greatest of what a column's four borders say, (nx, ny): those before it count where `of_next`, those behind
    it where `of_last`."""
    before, behind = np.where(of_next, length, 0.0), np.where(of_last, length, 0.0)
    sides = before[0, :-1, :-1], before[1, :-1, :-1], behind[0, 1:, :-1], behind[1, :-1, 1:]
    found: Array = np.maximum.reduce(sides)
    return found


def _mirrored(walls: Singles, axis: int) -> Singles:
    """Walls of a stock mirrored along x (0) or y (1): the order of borders and the standing sides are reversed."""
    out = np.zeros_like(walls)
    cells = walls.shape[1 + axis] - 1
    for kind in range(len(walls)):
        across = kind % 2 == axis  # borders along the mirrored direction: one more than columns
        flipped = np.flip(walls[kind], axis)
        if across:
            out[kind] = -flipped if kind < 2 else flipped
        elif axis == 0:
            out[kind, :cells] = flipped[1:]
        else:
            out[kind, :, :cells] = flipped[:, 1:]
    return out


def _upside_down(lo: Array, hi: Array, count: NDArray[np.int32]) -> tuple[Array, Array]:
    """Intervals of −Z in rising order."""
    k = lo.shape[2]
    order = np.clip(count[:, :, None] - 1 - np.arange(k)[None, None, :], 0, k - 1)
    used = np.arange(k)[None, None, :] < count[:, :, None]
    low = np.where(used, -np.take_along_axis(hi, order, axis=2), 0.0)
    high = np.where(used, -np.take_along_axis(lo, order, axis=2), 0.0)
    return low, high


def quarter_turned(stock: Stock) -> Stock:
    """Turned so that y becomes x and x becomes −y; exact."""
    return _flat(stock, _QUARTER)


def on_edge(stock: Stock) -> Stock:
    """Laid so that x points up and z to −x: rows along x become columns."""
    (old_lo, old_hi, old_count), old_grid = stock.field.columns, stock.field.grid
    nx, ny = old_count.shape
    low, high = stock.z_range
    slices = cells_along(high - low, stock.resolution)
    step = (high - low) / slices
    begins: list[NDArray[np.intp]] = []
    ends: list[NDArray[np.intp]] = []
    most = 1
    used = np.arange(old_lo.shape[2])[None, None, :] < old_count[:, :, None]
    for s in range(slices):
        z = high - (s + 0.5) * step
        full = (used & (old_lo <= z) & (z < old_hi)).any(axis=2)
        change = np.diff(full.astype(np.int8), axis=0, prepend=0, append=0)
        begins.append(np.argwhere(change.T == 1))  # (row j, border i), sorted by row
        ends.append(np.argwhere(change.T == -1))
        most = max(most, int(np.bincount(begins[-1][:, 0], minlength=1).max(initial=0)))
    lo, hi = np.zeros((slices, ny, most)), np.zeros((slices, ny, most))
    count = np.zeros((slices, ny), dtype=np.int32)
    wall = stock.field.walls[0]
    origin, width = old_grid.x, old_grid.dx
    for s in range(slices):
        rows = np.bincount(begins[s][:, 0], minlength=ny)
        count[s] = rows
        place = np.arange(len(begins[s])) - np.repeat(np.cumsum(rows) - rows, rows)
        for borders, into, side in ((begins[s], lo, -1.0), (ends[s], hi, 1.0)):
            j, i = borders[:, 0], borders[:, 1]
            held = wall[i, j] * side
            beyond = np.where(held > 0.0, held - 2.0, 0.0)
            into[s, j, place] = origin + (i - side * beyond) * width
    grid = np.array([-high, old_grid.y, step, old_grid.dy])
    return _like(stock, Columns(lo, hi, count), grid, (origin, origin + nx * width))
