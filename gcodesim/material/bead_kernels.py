"""Laying a bead: the cross-section of an extruded strand swept along straight pieces and added to the columns.

The cross-section is a rectangle with half-round sides: width w, height h, area (w - h) h + pi h^2 / 4. Over a column
it is averaged across one cell, so that the volume on the grid is the volume of the path, and it takes the free room
of its layer [tip - h, tip]: where there is a neighbouring bead already, the rest of the layer fills up.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.atan_kernels import asin
from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import PATCH_SHIFT, Columns, Field
from gcodesim.material.removal_kernels import overlap
from gcodesim.material.sweep_kernels import columns_across_x, columns_across_y, piece_of, strip_range, x_of, y_of

Array = NDArray[np.float64]

FULL = 1.0 - 1.0e-9  # a layer filled to this share counts as full
TREMBLE = 1.0e-6  # [m] pieces up to this long have no direction: a nozzle that stands on an arm trembles
SHARPEST = -0.6  # cosine of the turn (127 degrees) up to which the outside of a corner is a mitre


class Bead(NamedTuple):
    """The section of a strand: its `width` and `height`; it fuses with material nearer than `fuse` [m]."""

    width: float
    height: float
    fuse: float


class Strand(NamedTuple):
    """A piece of a strand with its neighbours (3,) [m]: where the piece before it begins, where it begins and ends
    itself, and where the piece after it ends. Without neighbours `previous` is `start`, `following` is `end`; pieces
    that only tremble are none."""

    previous: Array
    start: Array
    end: Array
    following: Array


@kernel
def unite(columns: Columns, i: int, j: int, bottom: float, top: float, fuse: float) -> float:
    """Add [bottom, top] to column (i, j), fused with material nearer than `fuse`; added length [m], -1: no room.

    On -1 the column is as it was.
    """
    lo, hi, count = columns
    n = count[i, j]
    low, high = bottom, top
    first = n  # from above: what is laid is mostly near the top
    while first > 0 and hi[i, j, first - 1] >= bottom - fuse:
        first -= 1
    last = first
    before = 0.0
    while last < n and lo[i, j, last] <= top + fuse:
        low, high = min(low, lo[i, j, last]), max(high, hi[i, j, last])
        before += hi[i, j, last] - lo[i, j, last]
        last += 1
    if last == first:
        if n == lo.shape[2]:
            return -1.0
        for k in range(n, first, -1):
            lo[i, j, k], hi[i, j, k] = lo[i, j, k - 1], hi[i, j, k - 1]
        count[i, j] = n + 1
    else:
        gone = last - first - 1
        if gone > 0:
            for k in range(last, n):
                lo[i, j, k - gone], hi[i, j, k - gone] = lo[i, j, k], hi[i, j, k]
            count[i, j] = n - gone
    lo[i, j, first], hi[i, j, first] = low, high
    return high - low - before


@kernel
def bead_area_to(c: float, width: float, height: float) -> float:
    """Area [m^2] of the cross-section between its middle and the distance c [m]; odd in c."""
    r = 0.5 * height
    straight = 0.5 * width - r
    across = abs(c)
    area = height * min(across, straight)
    if across > straight:
        e = min(across - straight, r)
        area += e * np.sqrt(max(r * r - e * e, 0.0)) + r * r * asin(e / r)
    return area if c >= 0.0 else -area


@kernel
def bead_thickness(c: float, cell: float, width: float, height: float) -> float:
    """Thickness [m] of the cross-section at distance c [m] from its middle, averaged over a cell of that width."""
    inner, outer = c - 0.5 * cell, c + 0.5 * cell
    if inner >= 0.5 * width or outer <= -0.5 * width:
        return 0.0
    return (bead_area_to(outer, width, height) - bead_area_to(inner, width, height)) / cell


@kernel
def fill_layer(columns: Columns, i: int, j: int, tip: float, thickness: float, bead: Bead) -> float:
    """Put `thickness` [m] of material into the free room of the layer below `tip`; added length [m], -1: no room."""
    height, fuse = bead.height, bead.fuse
    bottom = tip - height
    held = overlap(columns, i, j, bottom, tip)
    if held >= height * FULL:
        return 0.0
    if held + thickness >= height * FULL:
        return unite(columns, i, j, bottom, tip, fuse)
    middle = tip - 0.5 * height
    spread = thickness
    if held > 0.0:
        # the height around the middle such that its union with the existing material contains both
        wanted = held + thickness
        least, most = thickness, height
        for _ in range(45):
            spread = 0.5 * (least + most)
            inside = overlap(columns, i, j, middle - 0.5 * spread, middle + 0.5 * spread)
            if spread + held - inside < wanted:
                least = spread
            else:
                most = spread
    return unite(columns, i, j, middle - 0.5 * spread, middle + 0.5 * spread, fuse)


@kernel
def add_piece(field: Field, strand: Strand, bead: Bead, trial: bool) -> float:
    """Lay a bead along a piece of the nozzle tip's way; added volume [m^3], -1 when a column has no room.

    Ends are flat, so pieces in line abut. What the previous piece has laid is not laid twice. The outside of the corner
    to the following piece is filled by a mitre, which makes up for the overlap on its inside; where the strand
    turns back, by a round sector. With `trial` nothing is added; it only tests whether there is room.
    """
    columns, grid, _, dirty, tops = field
    lo, _, count = columns
    nx, ny = count.shape
    previous, start, end, following = strand
    width, height = bead.width, bead.height
    piece = piece_of(start, end)
    x0, y0, z0, ux, uy, length, slope = piece
    if length <= 0.0:
        return 0.0
    _, _, _, vx, vy, next_length, _ = piece_of(end, following)
    corner = min(length, next_length) > TREMBLE
    bend = ux * vx + uy * vy
    mitre = corner and bend >= SHARPEST
    wx0, wy0, _, wx, wy, before_length, _ = piece_of(previous, start)
    before_cell = abs(wy) * grid.dx + abs(wx) * grid.dy
    cell = abs(uy) * grid.dx + abs(ux) * grid.dy
    reach = 0.5 * width + 0.5 * (grid.dx + grid.dy)
    if mitre:
        reach /= np.sqrt(0.5 * (1.0 + bend))
    total = 0.0
    first_i, last_i = columns_across_x(grid, nx, min(x0, x0 + ux * length) - reach, max(x0, x0 + ux * length) + reach)
    for i in range(first_i, last_i):
        x = x_of(grid, i)
        least, most = strip_range(x, reach, piece)
        if least > most:
            continue
        first_j, last_j = columns_across_y(grid, ny, least, most)
        for j in range(first_j, last_j):
            y = y_of(grid, j)
            along = (x - x0) * ux + (y - y0) * uy
            if along < 0.0:
                continue
            if along < length:
                thickness = bead_thickness((y - y0) * ux - (x - x0) * uy, cell, width, height)
                tip = z0 + slope * along
                before = (x - wx0) * wx + (y - wy0) * wy
                if 0.0 <= before < before_length:
                    thickness -= bead_thickness((y - wy0) * wx - (x - wx0) * wy, before_cell, width, height)
            else:
                ex, ey = x - end[0], y - end[1]
                if not corner or ex * vx + ey * vy >= 0.0:
                    continue
                if mitre:
                    across, next_across = ey * ux - ex * uy, ey * vx - ex * vy
                    far = abs(next_across) > abs(across)
                    wide = abs(vy) * grid.dx + abs(vx) * grid.dy if far else cell
                    thickness = bead_thickness(max(abs(across), abs(next_across)), wide, width, height)
                else:
                    away = np.sqrt(ex * ex + ey * ey)
                    wide = cell if away == 0.0 else (abs(ex) * grid.dx + abs(ey) * grid.dy) / away
                    thickness = bead_thickness(away, wide, width, height)
                tip = end[2]
            if thickness <= 0.0:
                continue
            if trial:
                # the round side of a bead is a piece of its own also where its layer reaches into what is there
                if count[i, j] == lo.shape[2] and overlap(columns, i, j, tip - height, tip) < height * FULL:
                    return -1.0
                continue
            added = fill_layer(columns, i, j, tip, thickness, bead)
            if added > 0.0:
                total += added
                pi, pj = i >> PATCH_SHIFT, j >> PATCH_SHIFT
                dirty[pi, pj] = 1
                tops[pi, pj] = max(tops[pi, pj], tip)
    return total * float(grid.dx * grid.dy)


@kernel
def add_bead(field: Field, starts: Array, ends: Array, bead: Bead, first: int, volume: Array) -> int:
    """Lay pieces `first`... of a bead in order; returns the index of the piece that found no room, or their number.

    starts, ends (c, 3): nozzle tips in S [m]; a piece that starts where the one before ended goes round the corner.
    `volume` (c,) receives what was added [m^3]. To go on after a stop, give the columns more room and call again.
    """
    pieces = len(starts)
    for p in range(first, pieces):
        previous, following = starts[p], ends[p]
        k = p
        while k > 0 and np.max(np.abs(starts[k] - ends[k - 1])) < bead.fuse:
            k -= 1
            previous = starts[k]
            if np.max(np.abs(previous - starts[p])) > TREMBLE:
                break
        k = p
        while k + 1 < pieces and np.max(np.abs(starts[k + 1] - ends[k])) < bead.fuse:
            k += 1
            following = ends[k]
            if np.max(np.abs(following - ends[p])) > TREMBLE:
                break
        for trial in (True, False):
            added = add_piece(field, Strand(previous, starts[p], ends[p], following), bead, trial)
            if added < 0.0:
                return p
            volume[p] += added
    return pieces
