"""A stock set down on another side: its columns are rebuilt along another axis of the part.

Tools cut stock whose Z is up. A part that lies on its back or on an edge keeps
its frame S; only the columns stand along another axis, in a frame that
`Stock.turn` (3, 3) places in S. Turning a part over (Z to −Z) is exact, and so is any
turn of a stock that has columns in three directions. Otherwise, laying it on an edge
samples every old row of columns at the middle of the new ones: walls across
them stay where the tool left them, floors and other walls become walls between the new columns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import determinant, multiplied
from gcodesim.material.field_kernels import Columns, Grid
from gcodesim.material.stock import Lines, Stock, cells_along
from gcodesim.material.wall_kernels import ABOVE, HEIGHT, HUNG, LOWER, PLACE, TURNED_PLANES, WALL_PLANES

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
    if stock.lattice is not None:
        done = _turned_in_three(stock, whole)
        done.turn = multiplied(stock.turn, whole.T)
        return done
    done, rest = stock, whole
    if rest[2, 1] != 0.0:
        done, rest = _flat(done, _QUARTER), multiplied(rest, _QUARTER.T)
    if rest[2, 0] != 0.0:
        laid = on_edge(done)
        laid.begin_with(walls_on_edge(done, laid))
        done, rest = laid, multiplied(rest, _ON_EDGE.T)
    done = _flat(done, rest)
    done.turn = multiplied(stock.turn, whole.T)
    return done


def _turned_in_three(stock: Stock, R: Array) -> Stock:
    """A stock with columns along x, y and z: they change places, so nothing is sampled again."""
    from gcodesim.material.lattice import ORDERS, Lattice, field_of, own_columns

    assert stock.lattice is not None
    fields = (*stock.lattice.fields, stock.field)
    before = np.argmax(np.abs(R), axis=1)  # which axis each new one was
    signs = R.sum(axis=1)
    lines: list[Lines] = []
    for order in ORDERS:
        field, old = fields[before[order[2]]], ORDERS[before[order[2]]]
        swapped = before[order[0]] != old[0]
        lines.append(_turned_lines((field.columns, field.grid), swapped, signs[list(order)]))
    ends = np.sort([corner[before[2]] * signs[2] for corner in stock.bounds])
    made = _like(stock, *lines[2], (float(ends[0]), float(ends[1])))
    x, y = (field_of(*line) for line in lines[:2])
    made.lattice = Lattice((x, y), (own_columns(x), own_columns(y)), stock.lattice.offset)
    return made


def _turned_lines(lines: Lines, swapped: bool, signs: Array) -> Lines:
    """Columns whose first two axes change places, where `swapped`, and whose axes then run the other way where signs
    (3,) are negative."""
    (lo, hi, count), grid = lines[0], np.array(lines[1])
    if swapped:
        lo, hi, count, grid = lo.transpose(1, 0, 2), hi.transpose(1, 0, 2), count.T, grid[[1, 0, 3, 2]]
    for axis in range(2):
        if signs[axis] < 0.0:
            lo, hi, count = np.flip(lo, axis), np.flip(hi, axis), np.flip(count, axis)
            grid[axis] = -(grid[axis] + count.shape[axis] * grid[2 + axis])
    if signs[2] < 0.0:
        lo, hi = _upside_down(lo, hi, count)
    return Columns(lo, hi, count), Grid(*map(float, grid))


def _flat(stock: Stock, R: Array) -> Stock:
    """Turned so that Z stays or becomes −Z; exact."""
    walls, z_range, signs, swapped = stock.field.walls, stock.z_range, R.sum(axis=1), R[0, 0] == 0.0
    if swapped:
        walls = walls[np.arange(len(walls)) ^ 1].transpose(0, 2, 1)
    for axis in range(2):
        if signs[axis] < 0.0:
            walls = _mirrored(walls, axis)
    columns, grid = _turned_lines((stock.field.columns, stock.field.grid), swapped, signs)
    if signs[2] < 0.0:
        walls = _hung(walls, columns)
        z_range = (-z_range[1], -z_range[0])
    return _like(stock, columns, grid, z_range, walls)


def _like(
    stock: Stock,
    columns: Columns,
    grid: Grid,
    z_range: tuple[float, float],
    walls: Singles | None = None,
) -> Stock:
    made = Stock(
        columns=Columns(*map(np.ascontiguousarray, columns)),
        grid=grid,
        z_range=z_range,
        resolution=stock.resolution,
        material=stock.material,
    )
    if walls is not None:
        made.begin_with(walls)
    return made


def _hung(walls: Singles, columns: Columns) -> Singles:
    """Walls of a stock that is turned over: those that stood now hang, and those that hung stand.

    columns: those of the other side, on the same grid.
    """
    standing, hanging = walls[:HUNG], walls[HUNG:ABOVE]
    if not standing.any():
        return hanging if len(hanging) else standing
    made = np.zeros((TURNED_PLANES, *walls.shape[1:]), np.float32)
    made[: len(hanging)], made[HUNG:ABOVE] = hanging, standing
    lo, hi, number = columns
    used = np.arange(lo.shape[2]) < number[:, :, None]
    length = np.pad(np.where(used, hi - lo, 0.0).sum(axis=2), 1)
    before = length[:-1, 1:], length[1:, :-1]
    for axis in range(2):
        place = standing[PLACE + axis]
        stands = np.where(place > 0.0, before[axis], length[1:, 1:])
        above = stands - standing[HEIGHT + axis] - standing[LOWER + axis]
        made[ABOVE + axis] = np.where(place != 0.0, np.maximum(above, 0.0), 0.0)
    return made


def _mirrored(walls: Singles, axis: int) -> Singles:
    """Walls of a stock mirrored along x (0) or y (1): the order of borders and the standing sides are reversed."""
    out = np.zeros_like(walls)
    cells = walls.shape[1 + axis] - 1
    places = (PLACE, PLACE + 1, HUNG + PLACE, HUNG + PLACE + 1)
    for kind in range(len(walls)):
        across = kind % 2 == axis  # borders along the mirrored direction: one more than columns
        flipped = np.flip(walls[kind], axis)
        if across:
            out[kind] = -flipped if kind in places else flipped
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
    wall = stock.wall_places[0]
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
    grid = Grid(-float(high), old_grid.y, float(step), old_grid.dy)
    return _like(stock, Columns(lo, hi, count), grid, (origin, origin + nx * width))


def walls_on_edge(stock: Stock, laid: Stock) -> Singles:
    """The walls of a stock that was laid on an edge: floors, which lie between the new columns, and walls across y.

    Walls across x are where the new columns end. A wall of the old columns that slants is seen in x and in y, so of
    what is seen in y only the part counts that goes further.
    """
    (lo, hi, number), grid = stock.field.columns, stock.field.grid
    slices, ny = laid.field.columns.number.shape
    step = laid.field.grid.dx
    used = np.arange(lo.shape[2]) < number[:, :, None]
    place_x, place_y = stock.wall_places
    made = np.zeros((TURNED_PLANES, slices + 1, ny + 1), np.float32)
    before: Flags = np.zeros(number.shape, bool)
    floor_before = np.zeros(number.shape)
    for s in range(slices):
        z = stock.z_range[1] - (s + 0.5) * step
        in_it = used & (lo <= z) & (z < hi)
        full: Flags = np.asarray(in_it.any(axis=2))
        which = in_it.argmax(axis=2)[:, :, None]
        top, floor = (np.take_along_axis(ends, which, axis=2)[:, :, 0] for ends in (hi, lo))
        if s > 0:
            border = z + 0.5 * step
            beyond = np.where(full, border - top, floor_before - border) / step
            _record(made, 0, (s, slice(0, ny)), (before & ~full, before), (full & ~before, full), beyond, grid.dx)
        taken, left = _seen_along_x(full, place_x)
        low, high = full[:, :-1], full[:, 1:]
        beyond = np.abs(place_y[:-1, 1:-1]) - 2.0
        beyond = np.where(place_y[:-1, 1:-1] * np.where(low, 1.0, -1.0) > 0.0, beyond, 0.0)
        ahead = beyond - np.where(low, taken[:, :-1], taken[:, 1:])
        behind = -beyond - np.where(low, left[:, 1:], left[:, :-1])
        beyond = np.where(beyond > 0.0, np.maximum(ahead, 0.0), -np.maximum(behind, 0.0))
        _record(made, 1, (s, slice(1, ny)), (low & ~high, low), (high & ~low, high), beyond, grid.dx)
        before, floor_before = full, floor
    return made if made.any() else made[:WALL_PLANES]


def _seen_along_x(full: Flags, place: Singles) -> tuple[Array, Array]:
    """How much [cells] of columns that are `full` (nx, ny) walls across x take, and leave of those that are not."""
    taken, left = np.zeros((2, *full.shape))
    one, other = full[:-1], full[1:]
    border = place[1:-1, :-1]
    beyond = np.abs(border) - 2.0
    for stands, gone, told in (
        (slice(0, -1), slice(1, None), one & ~other & (border > 0.0)),
        (slice(1, None), slice(0, -1), other & ~one & (border < 0.0)),
    ):
        taken[stands] = np.maximum(taken[stands], np.where(told, beyond, 0.0))
        left[gone] = np.maximum(left[gone], np.where(told, -beyond, 0.0))
    return taken, left


def _record(
    walls: Singles,
    axis: int,
    at: tuple[int, slice],
    below: tuple[Flags, Flags],
    above: tuple[Flags, Flags],
    beyond: Array,
    length: float,
) -> None:
    """Put walls at a row of borders `at`, whose places are the mean of `beyond` (nx, m) [cells] along the columns.

    below: where (nx, m) the column below the border stands alone, and where it is material; above: the same of the
    other. Columns of both sides are `length` [m] an entry. The wall that matters more hangs, so that its height is
    kept, the other one stands.
    """
    sums = []
    for side, (told, full) in ((1.0, below), (-1.0, above)):
        number = told.sum(axis=0)
        total = np.where(told, np.clip(beyond, -0.5, 0.5), 0.0).sum(axis=0)
        last = len(told) - 1 - np.argmax(told[::-1], axis=0)
        over = full.sum(axis=0) - np.take_along_axis(full.cumsum(axis=0), last[None], axis=0)[0]
        sums.append((side, number, total, over))
    more = np.abs(sums[0][2]) >= np.abs(sums[1][2])
    for kind, first in ((HUNG, more), (0, ~more)):
        side, number, total, over = (np.where(first, one, other) for one, other in zip(*sums, strict=True))
        there = (number > 0) & (total != 0.0)
        row = walls[:, at[0], at[1]]
        row[kind + PLACE + axis] = np.where(there, side * (total / np.maximum(number, 1) + 2.0), 0.0)
        row[kind + HEIGHT + axis] = np.where(there, number * length, 0.0)
        if kind == HUNG:
            row[ABOVE + axis] = np.where(there, over * length, 0.0)
