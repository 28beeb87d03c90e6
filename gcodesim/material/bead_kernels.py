"""Laying a bead: the cross-section of an extruded strand swept along straight pieces and added to the columns.

The cross-section is a rectangle with half-round sides: width w, height h, area (w - h) h + pi h^2 / 4. Over a column
it is averaged across one cell, so that the volume on the grid is the volume of the path, and it takes the free room
of its layer [tip - h, tip]: where a neighbouring bead lies already, the rest of the layer fills up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.removal_kernels import PATCH_SHIFT, overlap
from gcodesim.material.sweep_kernels import NUDGE_X, NUDGE_Y, piece_line, row_range, strip_range

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Bytes = NDArray[np.uint8]

FULL = 1.0 - 1.0e-9  # a layer filled so far counts as full
SHARPEST = -0.6  # cosine of the turn (127 degrees) up to which the outside of a corner is a mitre


@kernel
def unite(lo: Array, hi: Array, count: Ints, i: int, j: int, bottom: float, top: float, fuse: float) -> float:
    """Add [bottom, top] to column (i, j) and fuse it with what is nearer than `fuse`; added length [m], -1: no room.

    On -1 the column is as it was.
    """
    n = count[i, j]
    low, high = bottom, top
    first = 0
    while first < n and hi[i, j, first] < bottom - fuse:
        first += 1
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
        area += e * np.sqrt(max(r * r - e * e, 0.0)) + r * r * np.arcsin(e / r)
    return area if c >= 0.0 else -area


@kernel
def bead_thickness(c: float, cell: float, width: float, height: float) -> float:
    """Thickness [m] of the cross-section at distance c [m] from its middle, averaged over a cell of that width."""
    inner, outer = c - 0.5 * cell, c + 0.5 * cell
    if inner >= 0.5 * width or outer <= -0.5 * width:
        return 0.0
    return (bead_area_to(outer, width, height) - bead_area_to(inner, width, height)) / cell


@kernel
def fill_layer(
    lo: Array, hi: Array, count: Ints, i: int, j: int, tip: float, height: float, thickness: float, fuse: float
) -> float:
    """Put `thickness` [m] of material into the free room of the layer below `tip`; added length [m], -1: no room."""
    bottom = tip - height
    held = overlap(lo, hi, count, i, j, bottom, tip)
    if held >= height * FULL:
        return 0.0
    if held + thickness >= height * FULL:
        return unite(lo, hi, count, i, j, bottom, tip, fuse)
    middle = tip - 0.5 * height
    spread = thickness
    if held > 0.0:
        # the spread around the middle whose union with what is there holds both
        wanted = held + thickness
        least, most = thickness, height
        for _ in range(45):
            spread = 0.5 * (least + most)
            inside = overlap(lo, hi, count, i, j, middle - 0.5 * spread, middle + 0.5 * spread)
            if spread + held - inside < wanted:
                least = spread
            else:
                most = spread
    return unite(lo, hi, count, i, j, middle - 0.5 * spread, middle + 0.5 * spread, fuse)


@kernel
def add_piece(
    lo: Array,
    hi: Array,
    count: Ints,
    grid: Array,
    dirty: Bytes,
    tops: Array,
    previous: Array,
    start: Array,
    end: Array,
    following: Array,
    width: float,
    height: float,
    fuse: float,
    trial: bool,
) -> float:
    """Lay a bead from nozzle tip `start` to `end` (3,) [m]; added volume [m^3], -1 when a column has no room.

    Ends are flat, so pieces in line abut. `previous` is where the strand's piece before began (`start`: none), what
    it laid is not laid twice; `following` is where the next one ends (`end`: none), and the outside of the corner to
    it is filled by a mitre, which holds what the overlap on its inside lacks; where the strand turns back, by a round
    sector. With `trial` nothing is added: it asks whether there is room.
    """
    nx, ny = count.shape
    x0, y0, z0, ux, uy, length, slope = piece_line(start, end)
    if length <= 0.0:
        return 0.0
    _, _, _, vx, vy, next_length, _ = piece_line(end, following)
    corner = next_length > 0.0
    bend = ux * vx + uy * vy
    mitre = corner and bend >= SHARPEST
    wx0, wy0, _, wx, wy, before_length, _ = piece_line(previous, start)
    before_cell = abs(wy) * grid[2] + abs(wx) * grid[3]
    cell = abs(uy) * grid[2] + abs(ux) * grid[3]
    reach = 0.5 * width + 0.5 * (grid[2] + grid[3])
    if mitre:
        reach /= np.sqrt(0.5 * (1.0 + bend))
    total = 0.0
    first_i, last_i = row_range(
        grid[0], grid[2], NUDGE_X, nx, min(x0, x0 + ux * length) - reach, max(x0, x0 + ux * length) + reach
    )
    for i in range(first_i, last_i):
        x = grid[0] + (i + 0.5 + NUDGE_X) * grid[2]
        least, most = strip_range(x, reach, x0, y0, ux, uy, length)
        if least > most:
            continue
        first_j, last_j = row_range(grid[1], grid[3], NUDGE_Y, ny, least, most)
        for j in range(first_j, last_j):
            y = grid[1] + (j + 0.5 + NUDGE_Y) * grid[3]
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
                    wide = abs(vy) * grid[2] + abs(vx) * grid[3] if far else cell
                    thickness = bead_thickness(max(abs(across), abs(next_across)), wide, width, height)
                else:
                    away = np.sqrt(ex * ex + ey * ey)
                    wide = cell if away == 0.0 else (abs(ex) * grid[2] + abs(ey) * grid[3]) / away
                    thickness = bead_thickness(away, wide, width, height)
                tip = end[2]
            if thickness <= 0.0:
                continue
            if trial:
                full = count[i, j] == lo.shape[2]
                if full and overlap(lo, hi, count, i, j, tip - height, tip) == 0.0:
                    return -1.0
                continue
            added = fill_layer(lo, hi, count, i, j, tip, height, thickness, fuse)
            if added > 0.0:
                total += added
                pi, pj = i >> PATCH_SHIFT, j >> PATCH_SHIFT
                dirty[pi, pj] = 1
                tops[pi, pj] = max(tops[pi, pj], tip)
    return total * float(grid[2] * grid[3])


@kernel
def add_bead(
    lo: Array,
    hi: Array,
    count: Ints,
    grid: Array,
    dirty: Bytes,
    tops: Array,
    starts: Array,
    ends: Array,
    width: float,
    height: float,
    fuse: float,
    first: int,
    volume: Array,
) -> int:
    """Lay pieces `first`... of a bead in order; returns the index of the piece that found no room, or their number.

    starts, ends (c, 3): nozzle tips in S [m]; a piece that starts where the one before ended goes round the corner.
    `volume` (c,) receives what was added [m^3]. To go on after a stop, grow `lo` and `hi` and call again.
    """
    pieces = len(starts)
    for p in range(first, pieces):
        previous, following = starts[p], ends[p]
        if p > 0 and np.max(np.abs(starts[p] - ends[p - 1])) < fuse:
            previous = starts[p - 1]
        if p + 1 < pieces and np.max(np.abs(starts[p + 1] - ends[p])) < fuse:
            following = ends[p + 1]
        for trial in (True, False):
            added = add_piece(
                lo, hi, count, grid, dirty, tops, previous, starts[p], ends[p], following, width, height, fuse, trial
            )
            if added < 0.0:
                return p
            volume[p] += added
    return pieces
