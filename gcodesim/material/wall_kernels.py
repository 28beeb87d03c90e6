"""Where walls really stand: what the grid cannot show of a straight wall is kept as a volume at the border of columns.

A column belongs to the cut when its centre does, so a wall appears at the border between two columns although it
stands up to half a cell beside it. When an upright tool leaves a wall, the strip between border and wall is
reckoned along the row of columns that crosses it (along x, and along y) and the two are weighted by the squares of
the wall's normal, which add up to one.

`walls` (4, nx + 1, ny + 1) f4 holds, for the borders below column (i, j) in x and in y: [0], [1] how far the tool
came, in cells beyond the border, -1/2..1/2, plus 2 when the column below the border is the one left standing, minus
2 when it is the one above, 0 without a wall; [2], [3] the strip as a length [m], to be multiplied by the area of a
cell. A positive strip: more is gone than the columns show.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.sweep_kernels import NUDGE_X, NUDGE_Y, row_range

Array = NDArray[np.float64]
Ints = NDArray[np.int32]
Singles = NDArray[np.float32]

SAME_PLACE = 1.0e-5  # walls nearer than this part of a cell are the same wall, cut again


@kernel(lean=True)
def forget_walls(walls: Singles, i: int, j: int) -> float:
    """Drop the walls of column (i, j), because it was cut itself; returns the strips they held [m]."""
    held = 0.0
    for axis in range(2):
        if walls[axis, i, j] < 0.0:
            held += walls[2 + axis, i, j]
            walls[axis, i, j], walls[2 + axis, i, j] = 0.0, 0.0
        bi, bj = (i + 1, j) if axis == 0 else (i, j + 1)
        if walls[axis, bi, bj] > 0.0:
            held += walls[2 + axis, bi, bj]
            walls[axis, bi, bj], walls[2 + axis, bi, bj] = 0.0, 0.0
    return held


@kernel(lean=True)
def rim(side: int, offset: float, uf: float, um: float, length: float, radius: float) -> tuple[float, float, float]:
    """Rim of a swept disc on a line that crosses it: (position [m], weight, place along the piece [m]).

    The line keeps its first coordinate `offset` from the piece's start and runs along the second; (uf, um) is the
    direction of the piece in these. `side` -1: the lower rim, +1: the upper one. A negative weight: never reached.
    """
    if uf == 0.0:
        s = length if side * um > 0.0 else 0.0
    else:
        sign = side if uf > 0.0 else -side
        s = min(max((offset + radius * um * sign) / uf, 0.0), length)
    miss = offset - uf * s
    half2 = radius * radius - miss * miss
    if half2 < 0.0:
        return 0.0, -1.0, 0.0
    return um * s + side * np.sqrt(half2), half2 / (radius * radius), s


@kernel(lean=True)
def renew(walls: Singles, axis: int, i: int, j: int, side: int, beyond: float, strip: float) -> float:
    """Keep a wall that is new, goes further than the one that is held, or as far and deeper; returns the gain [m].

    side: +1 when the column below the border is left standing, -1 when the one above is.
    """
    place = float(walls[axis, i, j])
    held = float(walls[2 + axis, i, j])
    if place * side > 0.0:
        further = beyond - (place * side - 2.0)
        if further < -SAME_PLACE or (further <= SAME_PLACE and abs(strip) <= abs(held)):
            return 0.0  # another pass has taken more, or the same wall from further down
    walls[axis, i, j] = side * (beyond + 2.0)
    walls[2 + axis, i, j] = strip
    return float(walls[2 + axis, i, j]) - held


@kernel(lean=True)
def material_above(lo: Array, hi: Array, count: Ints, i: int, j: int, bottom: float) -> float:
    """Length [m] of material of column (i, j) above `bottom`."""
    total = 0.0
    for k in range(count[i, j]):
        if hi[i, j, k] > bottom:
            total += hi[i, j, k] - max(lo[i, j, k], bottom)
    return total


@kernel(lean=True)
def reckon_walls(
    lo: Array,
    hi: Array,
    count: Ints,
    grid: Array,
    walls: Singles,
    x0: float,
    y0: float,
    ux: float,
    uy: float,
    length: float,
    radius: float,
    low_z: float,
    z0: float,
    slope: float,
    bottom: float,
) -> float:
    """Reckon the walls that an upright tool has left along a piece; returns the gain over what was held [m].

    The piece as `piece_line` gives it, `low_z` its lowest tip; bottom: the height over the tip [m] from which on the
    tool is a cylinder.
    """
    nx, ny = count.shape
    gain = 0.0
    for axis in range(2):
        if axis == 0:  # rows along x, one for each j
            crossing, uf, um, lines, cells = y0, uy, ux, ny, nx
            line_origin, line_step, line_nudge = grid[1], grid[3], NUDGE_Y
            origin, step, nudge, begin = grid[0], grid[2], NUDGE_X, x0
        else:
            crossing, uf, um, lines, cells = x0, ux, uy, nx, ny
            line_origin, line_step, line_nudge = grid[0], grid[2], NUDGE_X
            origin, step, nudge, begin = grid[1], grid[3], NUDGE_Y, y0
        least = min(crossing, crossing + uf * length) - radius
        most = max(crossing, crossing + uf * length) + radius
        first, last = row_range(line_origin, line_step, line_nudge, lines, least, most)
        for line in range(first, last):
            offset = line_origin + (line + 0.5 + line_nudge) * line_step - crossing
            below, weight_below, s_below = rim(-1, offset, uf, um, length, radius)
            above, weight_above, s_above = rim(1, offset, uf, um, length, radius)
            if weight_below < 0.0 or weight_above < 0.0:
                continue
            below, above = begin + below, begin + above
            inner = int(np.ceil((below - origin) / step - 0.5 - nudge))  # the first column of the cut
            outer = int(np.floor((above - origin) / step - 0.5 - nudge)) + 1  # the first one behind it
            if inner >= outer:
                continue
            for side in (1, -1):
                # the lower rim leaves the column below the border standing, the upper one the column above
                border = inner if side == 1 else outer
                if not (0 < border < cells):
                    continue
                standing, gone = (border - 1, border) if side == 1 else (border, border - 1)
                s = s_below if side == 1 else s_above
                low = (z0 + slope * s if slope != 0.0 else low_z) + bottom
                i, j = (standing, line) if axis == 0 else (line, standing)
                n = count[i, j]
                if n == 0 or hi[i, j, n - 1] <= low:
                    continue
                gi, gj = (gone, line) if axis == 0 else (line, gone)
                height = material_above(lo, hi, count, i, j, low) - material_above(lo, hi, count, gi, gj, low)
                edge = origin + border * step
                beyond = (edge - below if side == 1 else above - edge) / step
                strip = beyond * (weight_below if side == 1 else weight_above) * max(height, 0.0)
                bi, bj = (border, line) if axis == 0 else (line, border)
                gain += renew(walls, axis, bi, bj, side, beyond, strip)
    return float(gain)
