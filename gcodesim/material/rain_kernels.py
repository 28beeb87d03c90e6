"""Particles that fly along rays from a nozzle and stay where they strike first."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.bead_kernels import unite
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field, Grid
from gcodesim.material.strand_kernels import top_below

Array = NDArray[np.float64]

FUSE = 1.0e-9  # [m] up to which added material fuses with what is there
THIN = 1.0e-12  # [m]
ROLLS = 64  # columns that a particle rolls, at the most
NEAR_GROUND = 2.0  # widths of a column above the ground up to which a particle lies down
MOST_PARTS = 64  # into which a particle falls


class Rain(NamedTuple):
    """c rays: from `starts` (c, 3) [m] along unit vectors `ways` (c, 3), `far` [m] at the most, each with a particle of
    `volumes` (c,) [m³]."""

    starts: Array
    ways: Array
    volumes: Array
    far: float


class Fallen(NamedTuple):
    """What became of c particles: `volume` [m³] that is in the stock, 0 of those that struck nothing; and how far (c,)
    [m] they flew, infinite if they struck nothing."""

    volume: Array
    flight: Array


@kernel
def struck(columns: Columns, i: int, j: int, entry: float, leave: float) -> tuple[int, float, bool]:
    """The interval of a column that a ray strikes between the heights `entry` and `leave` [m]; -1: none.

    With it the height there, and whether the ray came in through the side.
    """
    lo, hi, count = columns
    for k in range(count[i, j]):
        if hi[i, j, k] - lo[i, j, k] > THIN and lo[i, j, k] < entry < hi[i, j, k]:
            return k, entry, True
    if leave <= entry:
        for k in range(count[i, j] - 1, -1, -1):
            if hi[i, j, k] - lo[i, j, k] > THIN and leave <= hi[i, j, k] <= entry:
                return k, hi[i, j, k], False
    else:
        for k in range(count[i, j]):
            if hi[i, j, k] - lo[i, j, k] > THIN and entry <= lo[i, j, k] <= leave:
                return k, lo[i, j, k], False
    return -1, 0.0, False


@kernel
def put_on(field: Field, i: int, j: int, bottom: float, thickness: float) -> float:
    """Add `thickness` [m] from `bottom` up to a column, on top of what is there already; -1: no interval is left."""
    columns = field.columns
    lo, hi, count = columns
    added, left = 0.0, thickness
    for _ in range(64):
        grown = unite(columns, i, j, bottom, bottom + left, FUSE)
        if grown < 0.0:
            return -1.0 if added == 0.0 else added
        added += grown
        left -= grown
        if left <= THIN:
            break
        bottom += grown
        for k in range(count[i, j]):
            if lo[i, j, k] <= bottom + FUSE and hi[i, j, k] >= bottom - FUSE:
                bottom = hi[i, j, k]
    field.dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
    top = field.tops[i >> PATCH_SHIFT, j >> PATCH_SHIFT]
    field.tops[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = max(top, bottom + max(left, 0.0) + added)
    return added


@kernel
def settled(columns: Columns, grid: Grid, i: int, j: int, height: float) -> tuple[int, int, float]:
    """Where a particle that strikes a column from above at `height` [m] comes to rest: it rolls down what is steeper
    than 45 degrees. Indices, and the height there."""
    nx, ny = columns.number.shape
    for _ in range(ROLLS):
        best_i, best_j, best, steepest = i, j, height, 1.0
        for a in range(max(i - 1, 0), min(i + 2, nx)):
            for b in range(max(j - 1, 0), min(j + 2, ny)):
                if a == i and b == j:
                    continue
                low = top_below(columns, a, b, height, FUSE)
                away = math.sqrt((a - i) * (a - i) * grid.dx * grid.dx + (b - j) * (b - j) * grid.dy * grid.dy)
                slope = (height - low) / away
                if steepest + 1.0e-9 < slope < math.inf:
                    best_i, best_j, best, steepest = a, b, low, slope
        if best_i == i and best_j == j:
            break
        i, j, height = best_i, best_j, best
    return i, j, height


@kernel
def heap_up(field: Field, i: int, j: int, height: float, thickness: float) -> float:
    """Put a particle that strikes a column from above at `height` [m] where it comes to rest; see `put_on`.

    One that would stand higher than half a column is wide falls apart.
    """
    parts = min(max(math.ceil(thickness / (0.5 * min(field.grid.dx, field.grid.dy))), 1), MOST_PARTS)
    added = 0.0
    for _ in range(parts):
        at_i, at_j, top = settled(field.columns, field.grid, i, j, height)
        grown = put_on(field, at_i, at_j, top, thickness / parts)
        if grown < 0.0:
            return -1.0 if added == 0.0 else added
        added += grown
        height = top_below(field.columns, i, j, max(height, top) + 2.0 * thickness, FUSE)
    return added


@kernel
def stick(field: Field, i: int, j: int, height: float, thickness: float) -> float:
    """Put a particle that strikes a wall at `height` [m] into the column before it: it stays there, or lies down where
    the ground is near; see `put_on`."""
    grain = min(field.grid.dx, field.grid.dy)
    ground = top_below(field.columns, i, j, height, FUSE)
    if height - ground <= NEAR_GROUND * grain:
        return heap_up(field, i, j, ground, thickness)
    return put_on(field, i, j, height - 0.5 * min(thickness, grain), thickness)


@kernel
def drop_along(field: Field, rain: Rain, p: int) -> tuple[float, float]:
    """Follow one ray and leave its particle; volume [m³], -1 if its column has no interval left, and the flight [m]."""
    columns, grid = field.columns, field.grid
    nx, ny = columns.number.shape
    x, y, z = rain.starts[p]
    dx, dy, dz = rain.ways[p]
    area = grid.dx * grid.dy
    thickness = rain.volumes[p] / area
    begin, end = 0.0, rain.far
    for axis in range(2):
        at, d = (x, dx) if axis == 0 else (y, dy)
        low = grid.x if axis == 0 else grid.y
        high = low + (grid.dx * nx if axis == 0 else grid.dy * ny)
        if abs(d) < THIN:
            if at < low or at >= high:
                return 0.0, math.inf
            continue
        one, other = (low - at) / d, (high - at) / d
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
    if begin >= end:
        return 0.0, math.inf
    i = min(max(math.floor((x + dx * begin - grid.x) / grid.dx), 0), nx - 1)
    j = min(max(math.floor((y + dy * begin - grid.y) / grid.dy), 0), ny - 1)
    before_i, before_j, t = -1, -1, begin
    for _ in range(nx + ny + 2):
        next_x, next_y = math.inf, math.inf
        if abs(dx) >= THIN:
            next_x = (grid.x + grid.dx * (i + (1 if dx > 0.0 else 0)) - x) / dx
        if abs(dy) >= THIN:
            next_y = (grid.y + grid.dy * (j + (1 if dy > 0.0 else 0)) - y) / dy
        after = min(next_x, next_y, end)
        k, height, side = struck(columns, i, j, z + dz * t, z + dz * after)
        if k >= 0:
            flight = t if side or dz == 0.0 else (height - z) / dz
            if side and before_i >= 0:
                added = stick(field, before_i, before_j, height, thickness)
            elif side and begin > 0.0:  # a wall at the border, beside which there is no column to stay in
                return 0.0, flight
            elif side or dz <= 0.0:
                added = heap_up(field, i, j, columns.hi[i, j, k], thickness)
            else:
                added = put_on(field, i, j, columns.lo[i, j, k] - thickness, thickness)
            return (added * area if added >= 0.0 else -1.0), flight
        if after >= end:
            break
        before_i, before_j, t = i, j, after
        if next_x <= next_y:
            i += 1 if dx > 0.0 else -1
        else:
            j += 1 if dy > 0.0 else -1
        if i < 0 or j < 0 or i >= nx or j >= ny:
            break
    return 0.0, math.inf


@kernel
def rain_down(field: Field, rain: Rain, first: int, fallen: Fallen) -> int:
    """Let the particles `first`… fly in order; the index of the one whose column has no interval left, or their number.

    To go on after a stop, give the columns more room and call again.
    """
    for p in range(first, len(rain.volumes)):
        added, flight = drop_along(field, rain, p)
        if added < 0.0:
            return p
        fallen.volume[p], fallen.flight[p] = added, flight
    return len(rain.volumes)
