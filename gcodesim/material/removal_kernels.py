"""Cutting material away: subtract what an upright tool sweeps from the columns under it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field, patch_top
from gcodesim.material.sweep_kernels import (
    BALL,
    Piece,
    Shape,
    columns_across_x,
    columns_across_y,
    piece_of,
    strip_range,
    swept_interval,
    underside,
    x_of,
    y_of,
)
from gcodesim.material.wall_kernels import FIRST, FIRST_GONE, LAST, LAST_GONE, Cut, reckon_walls, shorten_walls

Array = NDArray[np.float64]

NONE = np.inf  # floor of a column from which nothing is swept


@kernel(lean=True)
def subtract(columns: Columns, i: int, j: int, bottom: float, top: float) -> float:
    """Take [bottom, top] out of column (i, j); returns the removed length [m], or -1 when there is no room to split.

    On -1 the column is as it was.
    """
    lo, hi, count = columns
    n = count[i, j]
    if n == 0 or bottom >= top:
        return 0.0
    if n == lo.shape[2]:  # is there an interval that would be cut in two?
        for k in range(n):
            if lo[i, j, k] < bottom and top < hi[i, j, k]:
                return -1.0
    removed = 0.0
    kept = 0
    k = 0
    while k < n:
        low, high = lo[i, j, k], hi[i, j, k]
        if high <= bottom or low >= top:
            lo[i, j, kept], hi[i, j, kept] = low, high
            kept += 1
        elif low < bottom and top < high:
            for later in range(n, k + 1, -1):
                lo[i, j, later], hi[i, j, later] = lo[i, j, later - 1], hi[i, j, later - 1]
            hi[i, j, k] = bottom
            lo[i, j, k + 1], hi[i, j, k + 1] = top, high
            count[i, j] = n + 1
            return top - bottom
        else:
            removed += min(high, top) - max(low, bottom)
            if low < bottom:
                lo[i, j, kept], hi[i, j, kept] = low, bottom
                kept += 1
            elif top < high:
                lo[i, j, kept], hi[i, j, kept] = top, high
                kept += 1
        k += 1
    count[i, j] = kept
    if kept == 0:
        hi[i, j, 0] = lo[i, j, 0]  # an empty column ends where it begins
    return removed


@kernel(lean=True)
def overlap(columns: Columns, i: int, j: int, bottom: float, top: float) -> float:
    """Length [m] of material of column (i, j) inside [bottom, top]."""
    lo, hi, count = columns
    total = 0.0
    for k in range(count[i, j]):
        low, high = max(lo[i, j, k], bottom), min(hi[i, j, k], top)
        if high > low:
            total += high - low
    return total


@kernel(lean=True)
def mark_tall(low: Array, high: Array, height: float) -> bool:
    """Whether any of the columns low..high (n,) [m] ends above `height` [m]."""
    tall = np.uint8(0)
    for j in range(low.shape[0]):
        tall |= np.uint8(high[j] > height) & np.uint8(high[j] > low[j])
    return bool(tall > 0)


@kernel(lean=True)
def any_tall(columns: Columns, i: int, first: int, last: int, height: float) -> bool:
    """The same for columns first..last of row i, whatever they contain."""
    _, hi, count = columns
    tall = False
    for j in range(first, last):
        tall |= count[i, j] > 0 and hi[i, j, count[i, j] - 1] > height
    return tall


@kernel(lean=True)
def floor_of_disc(
    low: Array, high: Array, x: float, y: Array, piece: Piece, radius2: float, bottom: float, floor: Array
) -> bool:
    """Fill `floor` (n,): `bottom` [m] for columns of a row that a disc sweeps over and that end above it, else NONE.

    Returns whether there is any. Columns stand at x, y (n,) from the start of the piece and reach from low to high
    (n,) [m].
    """
    ux, uy, length = piece.ux, piece.uy, piece.length
    found = np.uint8(0)
    for j in range(low.shape[0]):
        along = x * ux + y[j] * uy
        across = y[j] * ux - x * uy
        near = min(max(0.0, -along), length - along)
        hit = np.uint8(across * across + near * near <= radius2) & np.uint8(high[j] > bottom)
        hit &= np.uint8(high[j] > low[j])
        floor[j] = bottom if hit else NONE
        found |= hit
    return bool(found > 0)


@kernel(lean=True)
def floor_of_ball(
    low: Array, high: Array, x: float, y: Array, piece: Piece, radius2: float, middle: float, floor: Array
) -> bool:
    """The same for a ball, with the floor of its sweep; middle: its height at the start of the piece [m]."""
    ux, uy, length, slope = piece.ux, piece.uy, piece.length, piece.slope
    lean = slope / np.sqrt(1.0 + slope * slope)
    found = np.uint8(0)
    for j in range(low.shape[0]):
        along = x * ux + y[j] * uy
        across = y[j] * ux - x * uy
        room2 = radius2 - across * across
        u = min(max(-lean * np.sqrt(max(room2, 0.0)), -along), length - along)
        depth2 = room2 - u * u
        deep = middle + slope * (along + u) - np.sqrt(max(depth2, 0.0))
        hit = np.uint8(depth2 >= 0.0) & np.uint8(deep < high[j]) & np.uint8(high[j] > low[j])
        floor[j] = deep if hit else NONE
        found |= hit
    return bool(found > 0)


@kernel
def scratch(field: Field) -> Array:
    """Room (10, n) for what `remove_piece` notes of lines of columns: y, floor, and twice what was cut of them."""
    nx, ny = field.columns.number.shape
    return np.empty((10, max(nx, ny)))


@kernel(lean=True)
def remove_piece(field: Field, start: Array, end: Array, shape: Shape, spare: Array) -> tuple[float, bool]:
    """Remove what `shape` sweeps from tip `start` to `end` (3,) [m]; (volume [m^3], ok). spare: `scratch`.

    The volume counts walls where they are, not where the grid shows them (see wall_kernels); it is never negative.
    ok is False when a column had no room for one more interval: what was done stays done, and doing the piece
    again after growing the arrays removes the rest.
    """
    columns, grid, walls, dirty, _ = field
    lo, hi, count = columns
    nx, ny = count.shape
    piece = piece_of(start, end)
    x0, y0, _, ux, uy, length, slope = piece
    low_z, high_z = min(start[2], end[2]), max(start[2], end[2])
    radius = shape.radius
    radius2 = radius * radius
    bottom_least = low_z + shape.bottom
    ball = shape.kind == BALL
    profile = underside(shape, radius)
    middle = (start[2] if slope != 0.0 else low_z) + shape.bottom + radius
    single = lo.shape[2] == 1  # nearly always
    total, tall, tall_from, top_least = 0.0, False, bottom_least + profile, low_z + shape.top
    first_i, last_i = columns_across_x(grid, nx, min(x0, x0 + ux * length) - radius, max(x0, x0 + ux * length) + radius)
    least, most = min(y0, y0 + uy * length) - radius, max(y0, y0 + uy * length) + radius
    first_j, last_j = columns_across_y(grid, ny, least, most)
    if first_i >= last_i or first_j >= last_j:
        return 0.0, True
    ys, floor, cut_x, cut_y = spare[0], spare[1], spare[2:6], spare[6:10]
    lows, highs = lo.reshape(lo.size), hi.reshape(hi.size)
    for j in range(first_j, last_j):
        ys[j - first_j] = y_of(grid, j) - y0
        cut_x[FIRST, j], cut_x[LAST, j] = -1.0, -1.0
    begin_j = first_j
    for i in range(first_i, last_i):
        cut_y[FIRST, i], cut_y[LAST, i] = -1.0, -1.0
        x = x_of(grid, i)
        least, most = strip_range(x, radius, piece)
        if least > most:
            if not tall:  # a wall in the row beside the tool, which the tool may move by less than a cell
                least, most = strip_range(x, radius + grid.dx, piece)
                if least <= most:
                    first_j, last_j = columns_across_y(grid, ny, least, most)
                    tall = any_tall(columns, i, first_j, last_j, tall_from)
            continue
        first_j, last_j = columns_across_y(grid, ny, least, most)
        if first_j >= last_j:
            continue
        if single:  # the loops in these have no branches, so that several columns are processed at a time
            low, high = lows[i * ny + first_j : i * ny + last_j], highs[i * ny + first_j : i * ny + last_j]
            tall = tall or mark_tall(low, high, tall_from)
            y = ys[first_j - begin_j : last_j - begin_j]
            if ball:
                found = floor_of_ball(low, high, x - x0, y, piece, radius2, middle, floor)
            else:
                found = floor_of_disc(low, high, x - x0, y, piece, radius2, bottom_least, floor)
            if not found:
                continue
        last_cut, last_gone = -1, 0.0
        for j in range(first_j, last_j):
            if single and floor[j - first_j] == NONE:
                continue
            n = count[i, j]
            if n == 0:
                continue
            end = hi[i, j, n - 1]
            if end <= bottom_least:
                continue
            if single and ball and end <= top_least:
                bottom, top = floor[j - first_j], top_least
            else:
                tall = tall or end > tall_from
                along = (x - x0) * ux + ys[j - begin_j] * uy
                across = ys[j - begin_j] * ux - (x - x0) * uy
                c2 = across * across
                if end < tall_from:
                    # no deeper than the underside of the shape at the nearest point, at the piece's lowest tip
                    near = min(max(0.0, -along), length - along)
                    rho2 = c2 + near * near
                    if rho2 > radius2 or bottom_least + underside(shape, np.sqrt(rho2)) >= end:
                        continue
                bottom, top = swept_interval(shape, piece, c2, along, low_z, high_z)
                if bottom > top or bottom >= end:
                    continue
            if n == 1 and end <= top:
                low = lo[i, j, 0]
                if bottom > low:
                    hi[i, j, 0] = bottom
                    gone = end - bottom
                else:
                    count[i, j] = 0
                    hi[i, j, 0] = low  # an empty column ends where it begins
                    gone = end - low
            else:
                gone = subtract(columns, i, j, bottom, top)
                if gone < 0.0:
                    return total * grid.dx * grid.dy, False
                if gone == 0.0:
                    continue
            total += gone + shorten_walls(walls, i, j, gone)
            if cut_x[FIRST, j] < 0.0:
                cut_x[FIRST, j], cut_x[FIRST_GONE, j] = i, gone
            cut_x[LAST, j], cut_x[LAST_GONE, j] = i, gone
            if last_cut < 0:
                cut_y[FIRST, i], cut_y[FIRST_GONE, i] = j, gone
            last_cut, last_gone = j, gone
            dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1
        if last_cut >= 0:
            cut_y[LAST, i], cut_y[LAST_GONE, i] = last_cut, last_gone
    # a tool that goes down leaves walls beside itself although no column under it is tall any more
    if tall or (total > 0.0 and high_z - low_z > length):
        total += reckon_walls(field, piece, radius, low_z, shape.bottom + profile, Cut(cut_x, cut_y), spare[0:2])
    return total * grid.dx * grid.dy, True


@kernel(lean=True)
def touch_piece(field: Field, start: Array, end: Array, shape: Shape) -> tuple[float, float]:
    """Material that `shape` would run through from tip `start` to `end`: (volume [m^3], depth [m]); none is removed.

    depth: the greatest of the columns' depths, each the lesser of overlap in height and distance inside the radius.
    `tops` of patches are upper bounds of the material's height; they are tightened where they are in the way.
    """
    columns, grid, tops = field.columns, field.grid, field.tops
    _, hi, count = columns
    nx, ny = count.shape
    piece = piece_of(start, end)
    x0, y0, _, ux, uy, length, _ = piece
    low_z, high_z = min(start[2], end[2]), max(start[2], end[2])
    radius = shape.radius
    x1, y1 = x0 + ux * length, y0 + uy * length
    first_i, last_i = columns_across_x(grid, nx, min(x0, x1) - radius, max(x0, x1) + radius)
    first_j, last_j = columns_across_y(grid, ny, min(y0, y1) - radius, max(y0, y1) + radius)
    volume, depth = 0.0, 0.0
    if first_i >= last_i or first_j >= last_j:
        return volume, depth
    least = low_z + shape.bottom
    for pi in range(first_i >> PATCH_SHIFT, ((last_i - 1) >> PATCH_SHIFT) + 1):
        for pj in range(first_j >> PATCH_SHIFT, ((last_j - 1) >> PATCH_SHIFT) + 1):
            if tops[pi, pj] <= least:
                continue
            tops[pi, pj] = patch_top(columns, pi, pj)
            if tops[pi, pj] <= least:
                continue
            for i in range(max(first_i, pi << PATCH_SHIFT), min(last_i, (pi + 1) << PATCH_SHIFT)):
                x = x_of(grid, i)
                for j in range(max(first_j, pj << PATCH_SHIFT), min(last_j, (pj + 1) << PATCH_SHIFT)):
                    n = count[i, j]
                    if n == 0 or hi[i, j, n - 1] <= least:
                        continue
                    y = y_of(grid, j)
                    along = (x - x0) * ux + (y - y0) * uy
                    across = (y - y0) * ux - (x - x0) * uy
                    c2 = across * across
                    bottom, top = swept_interval(shape, piece, c2, along, low_z, high_z)
                    if bottom >= top:
                        continue
                    shared = overlap(columns, i, j, bottom, top)
                    if shared > 0.0:
                        volume += shared
                        near = min(max(0.0, -along), length - along)
                        depth = max(depth, min(shared, radius - np.sqrt(c2 + near * near)))
    return volume * grid.dx * grid.dy, depth


class Found(NamedTuple):
    """What happened along c pieces, each (c,): volume that was removed [m^3], and how much material [m^3] and how
    deep [m], the other bodies ran through."""

    volume: Array
    body_volume: Array
    body_depth: Array


@kernel
def remove(field: Field, starts: Array, ends: Array, cutter: Shape, bodies: Array, first: int, found: Found) -> int:
    """Remove pieces `first`... in order; returns the index of the piece that found no room, or their number.

    starts, ends (c, 3): tip positions in S [m]; cutter: the part that cuts; bodies (b, 7): shapes that must stay out
    of the material (shank, holder), looked at after each piece. What is `found` is added to or raised.
    To go on after a stop, give the columns more room and call again with `first` set to the returned index.
    """
    pieces = len(starts)
    spare = scratch(field)
    for p in range(first, pieces):
        gone, ok = remove_piece(field, starts[p], ends[p], cutter, spare)
        found.volume[p] += gone
        if not ok:
            return p
        for b in range(bodies.shape[0]):
            body = bodies[b]
            shape = Shape(body[0], body[1], body[2], body[3], body[4], body[5], body[6])
            shared, depth = touch_piece(field, starts[p], ends[p], shape)
            found.body_volume[p] += shared
            found.body_depth[p] = max(found.body_depth[p], depth)
    return pieces
