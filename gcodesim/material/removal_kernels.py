"""Cutting material away: subtract what an upright tool sweeps from the columns under it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field, Grid, patch_top
from gcodesim.material.floor_kernels import BLOCK, NONE, FloorLine, Sweep, find_floor, sweep_of
from gcodesim.material.sweep_kernels import (
    NUDGE_X,
    NUDGE_Y,
    Shape,
    columns_across_x,
    columns_across_y,
    piece_of,
    shape_in,
    strip_range,
    swept_interval,
    underside,
    x_of,
    y_of,
)
from gcodesim.material.wall_kernels import HUNG, Cut, Ends, forget, reckon_walls, shorten_walls

Array = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]


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


@kernel(lean=True, inlined=True)
def find_strips(
    grid: Grid, shape: tuple[int, int], sweep: Sweep, begin: int, end: int, first: Array, last: Array
) -> None:
    """Fill first and last (n,) with the first and last + 1 column that a sweep may meet in rows begin..end.

    -1 twice where it never is; see `strip_range` and `row_range`.
    """
    x0, y0, _, ux, uy, length, _ = sweep.piece
    radius, per_cell, columns = sweep.shape.radius, 1.0 / grid.dy, np.float64(shape[1])
    slowness = 1.0 / ux if ux != 0.0 else 0.0
    wide = radius * abs(slowness) if abs(ux) > 1.0e-9 else np.inf
    for block in range(begin, end, BLOCK):
        for k in range(BLOCK):
            offset = grid.x + (block + k + 0.5 + NUDGE_X) * grid.dx - x0
            a, b = (offset - radius) * slowness, (offset + radius) * slowness
            begins = max(min(a, b), 0.0) if ux != 0.0 else 0.0
            ends = min(max(a, b), length) if ux != 0.0 else length
            near = min(max(offset * slowness, begins), ends)
            half2 = radius * radius - (offset - ux * near) * (offset - ux * near)
            half = np.sqrt(max(half2, 0.0))
            middle = y0 + offset * uy * slowness
            least = max(min(y0 + uy * begins, y0 + uy * ends) - half, middle - wide)
            most = min(max(y0 + uy * begins, y0 + uy * ends) + half, middle + wide)
            met = (half2 >= 0.0) & (begins <= ends)
            low = np.floor((least - grid.y) * per_cell - 0.5 - NUDGE_Y) - 1.0
            high = np.ceil((most - grid.y) * per_cell - 0.5 - NUDGE_Y) + 2.0
            at = np.uint64(block) + np.uint64(k)
            first[at] = max(low, 0.0) if met else -1.0
            last[at] = min(high, columns) if met else -1.0


class Scratch(NamedTuple):
    """Room for the removal of pieces, made once by `scratch`."""

    line: FloorLine
    cut: Cut  # what was cut of all lines
    first: Array  # (n,) column at which a row may be met first,
    last: Array  # and last + 1
    marks: Ints  # (BLOCK,) of the columns at one place of all blocks


class ColumnBlocks(NamedTuple):
    """Blocks of columns that cover a strip: where the first one begins, how many, and where the last in a row may."""

    begin: int
    number: int
    last: int


class Beside(NamedTuple):
    """Walls at the borders of a row of columns: below and above each along x, and along y."""

    below_x: Singles
    above_x: Singles
    below_y: Singles
    above_y: Singles


class Strip(NamedTuple):
    """Columns first..last of row i that a tool may meet, at x from the start of the piece [m]."""

    i: int
    x: float
    first: int
    last: int


@kernel
def scratch(field: Field) -> Scratch:
    """Room for the removal of pieces from a field."""
    nx, ny = field.columns.number.shape
    ys = np.empty(ny)
    for j in range(ny):
        ys[j] = y_of(field.grid, j)
    n = max(nx, ny) + BLOCK
    line = FloorLine(ys, np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n))
    along_x = Ends(np.empty(ny), np.empty(ny), np.empty(ny), np.empty(ny))
    along_y = Ends(np.empty(nx), np.empty(nx), np.empty(nx), np.empty(nx))
    marks = np.empty(BLOCK, np.int64)
    return Scratch(line, Cut(along_x, along_y), np.empty(nx + BLOCK), np.empty(nx + BLOCK), marks)


# Marks of columns: one is met; one of these takes a closer look, one may have a wall; one in the strip, met or not, is
# taller than the underside of the tool.
SOME, ODD, WALLED, TALL = 1, 2, 4, 8


@kernel(lean=True, inlined=True)
def clear(marks: Ints) -> None:
    """Nothing is noted of a row yet."""
    for k in range(BLOCK):
        marks[k] = 0


@kernel(lean=True, inlined=True)
def all_of(marks: Ints) -> int:
    """The marks of any column of a row."""
    found = 0
    for k in range(BLOCK):
        found |= marks[k]
    return found


@kernel(lean=True, inlined=True)
def meet(
    lows: Array, highs: Array, row: int, sweep: Sweep, strip: Strip, blocks: ColumnBlocks, line: FloorLine, marks: Ints
) -> int:
    """Find the floors of columns lows[row:] and highs[row:] with one interval each; NONE where they stay as they are.

    Returns their marks.
    """
    begin, first, last, floor = np.uint64(row), np.uint64(strip.first), np.uint64(strip.last), line.floor
    clear(marks)
    for block in range(blocks.number):
        at = np.uint64(min(blocks.begin + block * BLOCK, blocks.last))
        find_floor(sweep, strip.x, line, at)
        for k in range(BLOCK):
            j = at + np.uint64(k)
            low, high, deep = lows[begin + j], highs[begin + j], floor[j]
            filled = high > low
            hit = filled & (deep < high) & (high > sweep.lowest)
            tall = filled & (high > sweep.cylinder) & (j >= first) & (j < last)
            odd = hit & ((high > sweep.top) | (deep <= low))
            marks[k] |= (SOME if hit else 0) | (ODD if odd else 0) | (TALL if tall else 0)
            floor[j] = deep if hit else NONE
    return all_of(marks)


@kernel(lean=True, inlined=True)
def lower(
    highs: Array, row: int, strip: Strip, blocks: ColumnBlocks, walls: Beside, line: FloorLine, ends: Ends, marks: Ints
) -> int:
    """Lower columns highs[row:] to the floors that `meet` has found; returns their marks."""
    floor, gone = line.floor, line.gone
    begin, before = np.uint64(row), np.float64(strip.i)
    clear(marks)
    for block in range(blocks.number):
        fresh = blocks.begin + block * BLOCK  # the last block may begin earlier, with columns that are done
        at = min(fresh, blocks.last)
        for k in range(BLOCK):
            j = np.uint64(at) + np.uint64(k)
            high, new = highs[begin + j], at + k >= fresh
            hit = (floor[j] < NONE) & new
            taken = high - floor[j] if hit else 0.0
            gone[j] = taken if new else gone[j]
            highs[begin + j] = floor[j] if hit else high
            begun = ends.first[j] >= 0.0
            ends.first_gone[j] = ends.first_gone[j] if begun else taken
            ends.first[j] = before if hit & (not begun) else ends.first[j]
            ends.last[j] = before if hit else ends.last[j]
            ends.last_gone[j] = taken if hit else ends.last_gone[j]
            walled = (walls.below_x[j] < 0.0) | (walls.above_x[j] > 0.0)
            walled |= (walls.below_y[j] < 0.0) | (walls.above_y[j] > 0.0)
            marks[k] |= WALLED if walled & hit else 0
    return all_of(marks)


@kernel(lean=True, inlined=True)
def blocks_of(strip: Strip, ny: int) -> ColumnBlocks:
    """The blocks of a strip in a row of at least BLOCK columns."""
    number = (strip.last - strip.first + BLOCK - 1) // BLOCK
    return ColumnBlocks(max(min(strip.first, ny - number * BLOCK), 0), number, ny - BLOCK)


@kernel(lean=True, inlined=True)
def cut_column(columns: Columns, i: int, j: int, bottom: float, top: float) -> float:
    """The same as `subtract`, quicker where the highest interval is lowered, as nearly always."""
    lo, hi, count = columns
    n = count[i, j]
    low, end = lo[i, j, 0], hi[i, j, n - 1]
    if n > 1 or end > top:
        return subtract(columns, i, j, bottom, top)
    if bottom > low:
        hi[i, j, 0] = bottom
        return float(end - bottom)
    count[i, j] = 0
    hi[i, j, 0] = low  # an empty column ends where it begins
    return float(end - low)


@kernel(lean=True, inlined=True)
def interval_over(sweep: Sweep, strip: Strip, y: float, end: float) -> tuple[float, float]:
    """What is swept over a column that ends at `end` [m], (1, 0) if that is above it; y from where the piece begins."""
    shape, piece = sweep.shape, sweep.piece
    along, across = strip.x * piece.ux + y * piece.uy, y * piece.ux - strip.x * piece.uy
    c2 = across * across
    if end < sweep.cylinder:
        # no deeper than the underside of the shape at the nearest point, at the piece's lowest tip
        near = min(max(0.0, -along), piece.length - along)
        rho2 = c2 + near * near
        if rho2 > shape.radius * shape.radius or sweep.lowest + underside(shape, np.sqrt(rho2)) >= end:
            return 1.0, 0.0
    bottom, top = swept_interval(shape, piece, c2, along, sweep.low_tip, sweep.high_tip)
    return (bottom, top) if bottom <= top and bottom < end else (1.0, 0.0)


@kernel(lean=True)
def cut_columns(field: Field, sweep: Sweep, strip: Strip, line: FloorLine, ends: Ends, known: bool) -> bool:
    """Cut the columns of a strip one by one; whether there was room. Known: `meet` has found their floors."""
    columns, i = field.columns, strip.i
    _, hi, count = columns
    line.gone[strip.first : strip.last] = 0.0
    for j in range(strip.first, strip.last):
        n = count[i, j]
        end = hi[i, j, max(n - 1, 0)]
        if n == 0 or end <= sweep.lowest or (known and line.floor[j] == NONE):
            continue
        if known and end <= sweep.top:
            bottom, top = line.floor[j], sweep.top
        else:
            bottom, top = interval_over(sweep, strip, line.ys[j] - sweep.piece.y, end)
        gone = cut_column(columns, i, j, bottom, top) if bottom <= top else 0.0
        if gone < 0.0:
            return False
        if gone > 0.0:
            line.gone[j] = gone
            if ends.first[j] < 0.0:
                ends.first[j], ends.first_gone[j] = i, gone
            ends.last[j], ends.last_gone[j] = i, gone
    return True


@kernel(lean=True, inlined=True)
def settle_strip(field: Field, strip: Strip, walled: bool, spare: Scratch, total: float) -> float:
    """What follows for the columns of a strip being cut; `total` [m] with what is gone of them."""
    i, _, first, last = strip
    gone, ends = spare.line.gone, spare.cut.y
    while first < last and gone[first] == 0.0:
        first += 1
    while first < last and gone[last - 1] == 0.0:
        last -= 1
    if first == last:
        return total
    for j in range(first, last):
        total += gone[j] + shorten_walls(field.walls, i, j, gone[j]) if walled and gone[j] > 0.0 else gone[j]
    ends.first[i], ends.first_gone[i] = first, gone[first]
    ends.last[i], ends.last_gone[i] = last - 1, gone[last - 1]
    for patch in range(first >> PATCH_SHIFT, ((last - 1) >> PATCH_SHIFT) + 1):
        if field.dirty[i >> PATCH_SHIFT, patch] == 0:
            for j in range(max(first, patch << PATCH_SHIFT), min(last, (patch + 1) << PATCH_SHIFT)):
                if gone[j] > 0.0:
                    field.dirty[i >> PATCH_SHIFT, patch] = 1
    return total


@kernel(lean=True, inlined=True)
def stands_tall(columns: Columns, strip: Strip, height: float) -> bool:
    """Whether any column of a strip ends above `height` [m]."""
    _, hi, count = columns
    tall = False
    for j in range(strip.first, strip.last):
        tall |= count[strip.i, j] > 0 and hi[strip.i, j, count[strip.i, j] - 1] > height
    return tall


@kernel(lean=True)
def remove_piece(field: Field, start: Array, end: Array, shape: Shape, spare: Scratch) -> tuple[float, bool]:
    """Remove what `shape` sweeps from tip `start` to `end` (3,) [m]; (volume [m^3], ok). spare: `scratch`.

    The volume counts walls where they are, not where the grid shows them (see wall_kernels); it is never negative.
    ok is False when a column had no room for one more interval: what was done stays done, and doing the piece
    again after growing the arrays removes the rest.
    """
    columns, grid, walls, _, _ = field
    nx, ny = columns.number.shape
    piece, radius = piece_of(start, end), shape.radius
    low_tip, high_tip = min(start[2], end[2]), max(start[2], end[2])
    sweep = sweep_of(shape, piece, low_tip, high_tip)
    x0, y0, x1, y1 = piece.x, piece.y, piece.x + piece.ux * piece.length, piece.y + piece.uy * piece.length
    first_i, last_i = columns_across_x(grid, nx, min(x0, x1) - radius, max(x0, x1) + radius)
    first_j, last_j = columns_across_y(grid, ny, min(y0, y1) - radius, max(y0, y1) + radius)
    if first_i >= last_i or first_j >= last_j:
        return 0.0, True
    forget(spare.cut.x, first_j, last_j)
    forget(spare.cut.y, first_i, last_i)
    lows, highs = columns.lo.reshape(columns.lo.size), columns.hi.reshape(columns.hi.size)
    known = columns.lo.shape[2] == 1 and ny >= BLOCK  # nearly always
    total, tall = 0.0, False
    find_strips(grid, columns.number.shape, sweep, first_i, last_i, spare.first, spare.last)
    for i in range(first_i, last_i):
        strip = Strip(i, x_of(grid, i) - x0, int(spare.first[i]), int(spare.last[i]))
        if strip.first >= strip.last:
            if strip.first < 0 and not tall:  # a wall in the row beside the tool, which the tool may move a little
                least, most = strip_range(x_of(grid, i), radius + grid.dx, piece)
                if least <= most:
                    first, last = columns_across_y(grid, ny, least, most)
                    tall = stands_tall(columns, Strip(i, 0.0, first, last), sweep.cylinder)
            continue
        marks = ODD
        if known:
            blocks = blocks_of(strip, ny)
            marks = meet(lows, highs, i * ny, sweep, strip, blocks, spare.line, spare.marks)
            tall = tall or marks & TALL > 0
            if marks & SOME == 0:
                continue
        else:
            tall = tall or stands_tall(columns, strip, sweep.cylinder)
        if marks & ODD > 0:
            marks, ok = WALLED, cut_columns(field, sweep, strip, spare.line, spare.cut.x, known)
        else:
            beside = Beside(walls[0, i], walls[0, i + 1], walls[1, i], walls[1, i, 1:])
            marks, ok = lower(highs, i * ny, strip, blocks, beside, spare.line, spare.cut.x, spare.marks), True
        total = settle_strip(field, strip, marks & WALLED > 0 or walls.shape[0] > HUNG, spare, total)
        if not ok:
            return total * grid.dx * grid.dy, False
    # a tool that goes down leaves walls beside itself although no column under it is tall any more
    if tall or (total > 0.0 and high_tip - low_tip > piece.length):
        total += reckon_walls(field, sweep, spare.cut, spare.line)
    return total * grid.dx * grid.dy, True


@kernel(lean=True)
def touch_piece(field: Field, start: Array, end: Array, shape: Shape) -> tuple[float, float]:
    """Material that `shape` would run through from tip `start` to `end`: (volume [m^3], depth [m]); none is removed.

    depth: the greatest of the columns' depths, each the lesser of overlap in height and distance inside the radius, in
    a steep cone inside its flank.
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
                        inside = radius - np.sqrt(c2 + near * near)
                        if shape.rise > 1.0:  # a steep cone is left sideways sooner than downwards
                            inside = min(inside, shared / shape.rise)
                        depth = max(depth, min(shared, inside))
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
            shared, depth = touch_piece(field, starts[p], ends[p], shape_in(bodies, b))
            found.body_volume[p] += shared
            found.body_depth[p] = max(found.body_depth[p], depth)
    return pieces
