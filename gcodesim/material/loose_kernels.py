"""Pieces of a stock that hang together: numbered in its columns, and taken out of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH, PATCH_SHIFT, Bytes, Columns, Field, Grid, Singles
from gcodesim.material.wall_kernels import shorten_walls

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Longs = NDArray[np.int64]

TOUCHING = 1.0e-9
"""Height [m] over which intervals of neighbours have to overlap to hang together."""


class PieceSizes(NamedTuple):
    """Of each piece: `length` of its intervals [m], by a cell's area its volume; its number of `intervals`; the box of
    its columns and heights, `low` and `high` (m, 3): two indices and a height [m]."""

    length: Array
    intervals: Array
    low: Array
    high: Array


class PatchCopies(NamedTuple):
    """A copy of m patches: which ones, `patch` (m, 2), and of each the columns and the walls at their borders.

    lo, hi (m, 16, 16, k); number (m, 16, 16); walls (m, 8, 17, 17).
    """

    patch: Longs
    lo: Array
    hi: Array
    number: Ints
    walls: Singles


class BodyWays(NamedTuple):
    """Straight ways of a tool's tip from `starts` to `ends` (c, 3), and how far its body reaches beside the tip.

    `low`, `high` (c, 2): along x and y [m].
    """

    starts: Array
    ends: Array
    low: Array
    high: Array


@kernel
def mark_patches(grid: Grid, ways: BodyWays, within: Bytes) -> None:
    """Mark all patches (px, py) above or below which a body may be on its ways."""
    for c in range(len(ways.starts)):
        wx, wy = ways.ends[c, 0] - ways.starts[c, 0], ways.ends[c, 1] - ways.starts[c, 1]
        parts = int(max(abs(wx) / (PATCH * grid.dx), abs(wy) / (PATCH * grid.dy))) + 1
        for n in range(parts):
            x, y = ways.starts[c, 0] + wx * n / parts, ways.starts[c, 1] + wy * n / parts
            left, right = min(x, x + wx / parts) + ways.low[c, 0], max(x, x + wx / parts) + ways.high[c, 0]
            front, back = min(y, y + wy / parts) + ways.low[c, 1], max(y, y + wy / parts) + ways.high[c, 1]
            first_i = max(int(np.floor((left - grid.x) / (grid.dx * PATCH))), 0)
            last_i = min(int(np.floor((right - grid.x) / (grid.dx * PATCH))), within.shape[0] - 1)
            first_j = max(int(np.floor((front - grid.y) / (grid.dy * PATCH))), 0)
            last_j = min(int(np.floor((back - grid.y) / (grid.dy * PATCH))), within.shape[1] - 1)
            for i in range(first_i, last_i + 1):
                for j in range(first_j, last_j + 1):
                    within[i, j] = 1


@kernel
def exchange(field: Field, blocks: PatchCopies) -> None:
    """Put the blocks in place of their patches, and these into the blocks."""
    lo, hi, count = field.columns
    for m in range(len(blocks.patch)):
        i0, j0 = blocks.patch[m, 0] << PATCH_SHIFT, blocks.patch[m, 1] << PATCH_SHIFT
        for a in range(min(PATCH, lo.shape[0] - i0)):
            for b in range(min(PATCH, lo.shape[1] - j0)):
                for k in range(lo.shape[2]):
                    low, high = lo[i0 + a, j0 + b, k], hi[i0 + a, j0 + b, k]
                    lo[i0 + a, j0 + b, k], hi[i0 + a, j0 + b, k] = blocks.lo[m, a, b, k], blocks.hi[m, a, b, k]
                    blocks.lo[m, a, b, k], blocks.hi[m, a, b, k] = low, high
                number = count[i0 + a, j0 + b]
                count[i0 + a, j0 + b] = blocks.number[m, a, b]
                blocks.number[m, a, b] = number


@kernel
def copy_blocks(field: Field, blocks: PatchCopies, back: int) -> None:
    """Fill the blocks from their patches; with `back` put them into their patches again."""
    lo, hi, count = field.columns
    walls = field.walls
    for m in range(len(blocks.patch)):
        i0, j0 = blocks.patch[m, 0] << PATCH_SHIFT, blocks.patch[m, 1] << PATCH_SHIFT
        for a in range(min(PATCH, lo.shape[0] - i0)):
            for b in range(min(PATCH, lo.shape[1] - j0)):
                for k in range(lo.shape[2]):
                    if back:
                        lo[i0 + a, j0 + b, k], hi[i0 + a, j0 + b, k] = blocks.lo[m, a, b, k], blocks.hi[m, a, b, k]
                    else:
                        blocks.lo[m, a, b, k], blocks.hi[m, a, b, k] = lo[i0 + a, j0 + b, k], hi[i0 + a, j0 + b, k]
                if back:
                    count[i0 + a, j0 + b] = blocks.number[m, a, b]
                else:
                    blocks.number[m, a, b] = count[i0 + a, j0 + b]
        for plane in range(walls.shape[0]):
            for a in range(min(PATCH + 1, walls.shape[1] - i0)):
                for b in range(min(PATCH + 1, walls.shape[2] - j0)):
                    if back:
                        walls[plane, i0 + a, j0 + b] = blocks.walls[m, plane, a, b]
                    else:
                        blocks.walls[m, plane, a, b] = walls[plane, i0 + a, j0 + b]


@kernel
def count_links(columns: Columns, within: Bytes, sums: Longs) -> None:
    """What tells of a change in which intervals hang together, in the marked patches: add it to `sums` (2,).

    It is a number for the intervals and one for the sides across which they touch, each weighted by its place, so that
    what is lost here is not made up for there.
    """
    lo, hi, count = columns
    nx, ny, _ = lo.shape
    for pi in range(within.shape[0]):
        for pj in range(within.shape[1]):
            if within[pi, pj] == 0:
                continue
            for i in range(pi << PATCH_SHIFT, min((pi + 1) << PATCH_SHIFT, nx)):
                for j in range(pj << PATCH_SHIFT, min((pj + 1) << PATCH_SHIFT, ny)):
                    weight = (i * 7919 + j * 104729) % 1000003 + 1
                    sums[0] += count[i, j] * weight
                    links = 0
                    for side in range(2):
                        a, b = (i + 1, j) if side == 0 else (i, j + 1)
                        if a >= nx or b >= ny:
                            continue
                        for k in range(count[i, j]):
                            for c in range(count[a, b]):
                                if lo[a, b, c] < hi[i, j, k] - TOUCHING and hi[a, b, c] > lo[i, j, k] + TOUCHING:
                                    links += 1 + side
                    sums[1] += links * weight


@kernel
def number_pieces(columns: Columns, within: Bytes, label: Ints, waiting: Longs) -> int:
    """Number the pieces in which intervals hang together across the sides of columns; how many there are.

    Only columns of marked patches count. label (nx, ny, k) gets numbers from 1 on where it was 0; `waiting` has room
    for all intervals.
    """
    pieces = 0
    for pi in range(within.shape[0]):
        for pj in range(within.shape[1]):
            if within[pi, pj] != 0:
                pieces = _number_from(columns, within, label, waiting, (pi, pj, pieces))
    return pieces


@kernel
def _number_from(columns: Columns, within: Bytes, label: Ints, waiting: Longs, at: tuple[int, int, int]) -> int:
    """The same for pieces that begin in the patch `at` (its numbers, and that of the pieces so far)."""
    lo, hi, count = columns
    nx, ny, room = lo.shape
    pi, pj, pieces = at
    for i0 in range(pi << PATCH_SHIFT, min((pi + 1) << PATCH_SHIFT, nx)):
        for j0 in range(pj << PATCH_SHIFT, min((pj + 1) << PATCH_SHIFT, ny)):
            for k0 in range(count[i0, j0]):
                if label[i0, j0, k0] > 0:
                    continue
                pieces += 1
                label[i0, j0, k0] = pieces
                waiting[0] = (i0 * ny + j0) * room + k0
                number = 1
                while number > 0:
                    number -= 1
                    k = waiting[number] % room
                    j = waiting[number] // room % ny
                    i = waiting[number] // room // ny
                    low, high = lo[i, j, k] + TOUCHING, hi[i, j, k] - TOUCHING
                    for side in range(4):
                        a = i + (1 if side == 0 else -1 if side == 1 else 0)
                        b = j + (1 if side == 2 else -1 if side == 3 else 0)
                        if a < 0 or b < 0 or a >= nx or b >= ny or within[a >> PATCH_SHIFT, b >> PATCH_SHIFT] == 0:
                            continue
                        for c in range(count[a, b]):
                            if label[a, b, c] == 0 and lo[a, b, c] < high and hi[a, b, c] > low:
                                label[a, b, c] = pieces
                                waiting[number] = (a * ny + b) * room + c
                                number += 1
    return pieces


@kernel
def find_parents(columns: Columns, label: Ints, blocks: PatchCopies, before: Ints, parent: Ints) -> None:
    """The number (pieces,) in `before`, when `blocks` were there, of each piece or of that of which it is a part.

    Pieces that have nothing in these patches keep 0.
    """
    lo, hi, count = columns
    for m in range(len(blocks.patch)):
        i0, j0 = blocks.patch[m, 0] << PATCH_SHIFT, blocks.patch[m, 1] << PATCH_SHIFT
        for a in range(min(PATCH, lo.shape[0] - i0)):
            for b in range(min(PATCH, lo.shape[1] - j0)):
                for k in range(count[i0 + a, j0 + b]):
                    middle = 0.5 * (lo[i0 + a, j0 + b, k] + hi[i0 + a, j0 + b, k])
                    for c in range(blocks.number[m, a, b]):
                        if blocks.lo[m, a, b, c] <= middle <= blocks.hi[m, a, b, c]:
                            parent[label[i0 + a, j0 + b, k] - 1] = before[i0 + a, j0 + b, c]


@kernel
def measure_pieces(columns: Columns, within: Bytes, label: Ints, sizes: PieceSizes) -> None:
    """Add up the `sizes` of all pieces in the marked patches; lows begin at infinity, highs at minus infinity."""
    lo, hi, count = columns
    for i in range(lo.shape[0]):
        for j in range(lo.shape[1]):
            if within[i >> PATCH_SHIFT, j >> PATCH_SHIFT] == 0:
                continue
            for k in range(count[i, j]):
                p = label[i, j, k] - 1
                sizes.length[p] += hi[i, j, k] - lo[i, j, k]
                sizes.intervals[p] += 1.0
                for axis in range(3):
                    least = float(i) if axis == 0 else float(j) if axis == 1 else lo[i, j, k]
                    most = float(i) if axis == 0 else float(j) if axis == 1 else hi[i, j, k]
                    sizes.low[p, axis] = min(sizes.low[p, axis], least)
                    sizes.high[p, axis] = max(sizes.high[p, axis], most)


@kernel
def take_pieces(field: Field, label: Ints, goes: NDArray[np.uint8]) -> None:
    """Take the pieces that `goes` names, by their number less one, out of the columns; walls go with them."""
    columns = field.columns
    lo, hi, count = columns
    for i in range(lo.shape[0]):
        for j in range(lo.shape[1]):
            kept, gone = 0, 0.0
            for k in range(count[i, j]):
                if goes[label[i, j, k] - 1] == 0:
                    lo[i, j, kept], hi[i, j, kept] = lo[i, j, k], hi[i, j, k]
                    kept += 1
                else:
                    gone += hi[i, j, k] - lo[i, j, k]
            if kept == count[i, j]:
                continue
            count[i, j] = kept
            if kept == 0:
                hi[i, j, 0] = lo[i, j, 0]
            shorten_walls(field.walls, i, j, gone)
            field.dirty[i >> PATCH_SHIFT, j >> PATCH_SHIFT] = 1


@kernel
def take_across(field: Field, along: int, upright: Columns, grid: Grid, gone: Ints) -> None:
    """Take pieces out of columns along x (`along` 0) or y (1): intervals that lie mostly in what is gone.

    `upright` are the columns along z with all pieces still in them, on `grid`; gone (nx, ny, k) is 1 where an interval
    of theirs goes.
    """
    lo, hi, count = field.columns
    own = field.grid
    origin, step = (grid.x, grid.dx) if along == 0 else (grid.y, grid.dy)
    for a in range(lo.shape[0]):
        for b in range(lo.shape[1]):
            z = own.y + (b + 0.5) * own.dy if along == 0 else own.x + (a + 0.5) * own.dx
            kept = 0
            for k in range(count[a, b]):
                going, staying = 0, 0
                first = max(int(np.floor((lo[a, b, k] - origin) / step)), 0)
                last = min(int(np.floor((hi[a, b, k] - origin) / step)), upright.lo.shape[along] - 1)
                for n in range(first, last + 1):
                    i, j = (n, a) if along == 0 else (b, n)
                    for c in range(upright.number[i, j]):
                        if upright.lo[i, j, c] <= z <= upright.hi[i, j, c]:
                            going += gone[i, j, c]
                            staying += 1 - gone[i, j, c]
                if going <= staying:
                    lo[a, b, kept], hi[a, b, kept] = lo[a, b, k], hi[a, b, k]
                    kept += 1
            count[a, b] = kept
            if kept == 0:
                hi[a, b, 0] = lo[a, b, 0]


@kernel
def mark_gone(label: Ints, count: Ints, goes: NDArray[np.uint8], gone: Ints) -> None:
    """`gone` (nx, ny, k) becomes 1 for the intervals of the pieces that `goes` names, by their number less one."""
    for i in range(label.shape[0]):
        for j in range(label.shape[1]):
            for k in range(count[i, j]):
                gone[i, j, k] = goes[label[i, j, k] - 1]
