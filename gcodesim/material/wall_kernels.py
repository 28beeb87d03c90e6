"""Where walls really are: the part of a straight wall's place that the grid cannot show, kept at borders of columns.

A column belongs to the cut when its centre does, so a wall appears at the border between two columns although it
is up to half a cell beside it. When an upright tool leaves a wall, its place is computed along the row of columns
that crosses it (along x, and along y).

`walls` (8, nx + 1, ny + 1) f4 holds, for the borders below column (i, j) in x and in y: [0], [1] how far the tool
came, in cells beyond the border, -1/2..1/2, plus 2 when the column below the border is the one left standing, minus
2 when it is the one above, 0 without a wall; [2], [3] down to which depth under its top the wall stands there [m];
[4], [5] how far the tool came below that, [6], [7] along which height more [m]. A wall that passes of different depth
left in more than two places has the two that come nearest to it.

**Volume.** Between the centres of a standing column and of a gone one, a wall beyond the border takes `beyond` of the
standing column, a wall before it leaves `-beyond` of the gone one. A slanted wall is seen at a border in x and at one
in y, and both see the same: so a standing column loses the most that any of its four borders takes, and a gone one
keeps the most that any of them leaves. The volume of the stock follows from columns and walls alone, whatever steps
led to them, and no cut can raise it: walls only go further; and of the height by which a column is cut no more than
half was taken by walls before, and no more than half is left behind walls afterwards. (Adding what is seen in x and in
y, weighted by the wall's normal, is more exact on arcs, by a fifth of a cell's area for each closed wall, but a normal
that turns can give volume back.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field
from gcodesim.material.sweep_kernels import NUDGE_X, NUDGE_Y, Piece, row_range

Array = NDArray[np.float64]
Singles = NDArray[np.float32]

SAME_PLACE = 1.0e-5  # walls closer than this share of a cell are the same wall, cut again
NEVER = 1.0e9  # a place [cells] that no stock has
SLIVER = 0.125  # a step lower than this share of the height above it is not a place of its own: the tip shakes
SAME_HEIGHT = 1.0e-8  # heights [m] closer than this are the same: rounding of single precision

# planes of `walls`, each for borders in x and, one further on, in y
PLACE, HEIGHT, SECOND, LOWER = 0, 2, 4, 6

FIRST, FIRST_GONE, LAST, LAST_GONE = 0, 1, 2, 3  # rows of `Cut`


class Cut(NamedTuple):
    """Which columns a piece has cut: of each line along x (4, ny), and along y (4, nx), the first and the last one.

    -1 where there is none; after each index comes by how much [m] that column was cut.
    """

    x: Array
    y: Array


@kernel(lean=True)
def taken(walls: Singles, axis: int, i: int, j: int) -> float:
    """What a wall takes of the standing column [m]: length, to be multiplied by the area of a cell."""
    total = max(abs(float(walls[axis, i, j])) - 2.0, 0.0) * float(walls[HEIGHT + axis, i, j])
    if walls[LOWER + axis, i, j] > 0.0:
        total += max(float(walls[SECOND + axis, i, j]), 0.0) * float(walls[LOWER + axis, i, j])
    return total


@kernel(lean=True)
def left(walls: Singles, axis: int, i: int, j: int) -> float:
    """What a wall leaves of the gone column [m]: length, to be multiplied by the area of a cell."""
    total = max(2.0 - abs(float(walls[axis, i, j])), 0.0) * float(walls[HEIGHT + axis, i, j])
    if walls[LOWER + axis, i, j] > 0.0:
        total += max(-float(walls[SECOND + axis, i, j]), 0.0) * float(walls[LOWER + axis, i, j])
    return total


@kernel(lean=True)
def most_taken(walls: Singles, i: int, j: int, but: int) -> float:
    """What its walls take of standing column (i, j) [m]; `but`: a border that does not count, see `set_wall`."""
    most = 0.0
    if walls[0, i, j] < 0.0 and but != 0:
        most = taken(walls, 0, i, j)
    if walls[1, i, j] < 0.0 and but != 1:
        most = max(most, taken(walls, 1, i, j))
    if walls[0, i + 1, j] > 0.0 and but != 2:
        most = max(most, taken(walls, 0, i + 1, j))
    if walls[1, i, j + 1] > 0.0 and but != 3:
        most = max(most, taken(walls, 1, i, j + 1))
    return most


@kernel(lean=True)
def most_left(walls: Singles, i: int, j: int, but: int) -> float:
    """What its walls leave of gone column (i, j) [m]; `but`: a border that does not count."""
    most = 0.0
    if walls[0, i, j] > 0.0 and but != 0:
        most = left(walls, 0, i, j)
    if walls[1, i, j] > 0.0 and but != 1:
        most = max(most, left(walls, 1, i, j))
    if walls[0, i + 1, j] < 0.0 and but != 2:
        most = max(most, left(walls, 0, i + 1, j))
    if walls[1, i, j + 1] < 0.0 and but != 3:
        most = max(most, left(walls, 1, i, j + 1))
    return most


@kernel
def beyond_columns(walls: Singles) -> float:
    """Sum of what walls take of columns less what they leave of gone ones [m, by the area of a cell a volume]."""
    total = 0.0
    for i in range(walls.shape[1] - 1):
        row = 0.0
        for j in range(walls.shape[2] - 1):
            row += most_taken(walls, i, j, -1) - most_left(walls, i, j, -1)
        total += row
    return total


@kernel(lean=True)
def set_wall(
    walls: Singles, axis: int, i: int, j: int, side: int, beyond: float, height: float, second: float, lower: float
) -> float:
    """Put a wall with one or two places at a border; returns how much more is gone than before [m].

    side: +1 when the column below the border is left standing, -1 when the one above is. No height: no wall.
    Of its two columns the border is number `axis` of the one above, 2 + `axis` of the one below.
    """
    taken_before, left_before = taken(walls, axis, i, j), left(walls, axis, i, j)
    walls[axis, i, j] = side * (beyond + 2.0) if height > 0.0 else 0.0
    walls[HEIGHT + axis, i, j] = height
    if lower > 0.0 or walls[LOWER + axis, i, j] > 0.0:  # few walls have a second place
        walls[SECOND + axis, i, j], walls[LOWER + axis, i, j] = second, lower
    taken_now, left_now = taken(walls, axis, i, j), left(walls, axis, i, j)
    below_i, below_j = (i - 1, j) if axis == 0 else (i, j - 1)
    gain = 0.0
    if taken_now != taken_before:
        if side > 0:
            others = most_taken(walls, below_i, below_j, 2 + axis)
        else:
            others = most_taken(walls, i, j, axis)
        gain += max(taken_now, others) - max(taken_before, others)
    if left_now != left_before:
        if side > 0:
            others = most_left(walls, i, j, axis)
        else:
            others = most_left(walls, below_i, below_j, 2 + axis)
        gain -= max(left_now, others) - max(left_before, others)
    return gain


@kernel(lean=True)
def shorten_wall(walls: Singles, axis: int, i: int, j: int, gone: float) -> float:
    """The standing column at a border was cut by `gone` [m], so its wall is lower; returns the gain [m]."""
    side = 1 if walls[axis, i, j] > 0.0 else -1
    beyond = abs(float(walls[axis, i, j])) - 2.0
    second = float(walls[SECOND + axis, i, j])
    height, lower = float(walls[HEIGHT + axis, i, j]) - gone, float(walls[LOWER + axis, i, j])
    if height <= SAME_HEIGHT:
        beyond, height = second, lower + height
        second, lower = 0.0, 0.0
        if height <= SAME_HEIGHT:
            beyond, height = 0.0, 0.0
    return set_wall(walls, axis, i, j, side, beyond, height, second, lower)


@kernel(lean=True)
def shorten_walls(walls: Singles, i: int, j: int, gone: float) -> float:
    """Column (i, j) was cut by `gone` [m], and its walls in that height are gone too; returns the gain [m]."""
    gain = 0.0
    for axis in range(2):
        if walls[axis, i, j] < 0.0:
            gain += shorten_wall(walls, axis, i, j, gone)
        bi, bj = (i + 1, j) if axis == 0 else (i, j + 1)
        if walls[axis, bi, bj] > 0.0:
            gain += shorten_wall(walls, axis, bi, bj, gone)
    return gain


@kernel(lean=True)
def place_on_rim(side: int, offset: float, uf: float, um: float, length: float, radius: float) -> float:
    """Where on a piece [m] the disc is whose rim is extreme on a line that crosses the piece.

    The line keeps its first coordinate `offset` from the piece's start and runs along the second; (uf, um) is the
    direction of the piece in these. `side` -1: the lower rim, +1: the upper one.
    """
    if uf == 0.0:
        return length if side * um > 0.0 else 0.0
    return min(max((offset + radius * um * (side if uf > 0.0 else -side)) / uf, 0.0), length)


@kernel(lean=True)
def find_rims(
    side: int, offset: float, spacing: float, uf: float, um: float, length: float, radius: float, begin: float,
    step: float, rims: Array,
) -> None:  # fmt: skip
    """Rim of a swept disc on n lines `spacing` apart, in cells [`step` m] from where the piece is at `begin` [m].

    The first line is at `offset`, the rest as in `place_on_rim`. If a line is never reached, it is on the wrong side.
    """
    slowness, shift = 0.0, length if side * um > 0.0 else 0.0
    if uf != 0.0:
        slowness = 1.0 / uf
        shift = radius * um * (side if uf > 0.0 else -side) * slowness
    per_cell = 1.0 / step
    radius2, never = radius * radius, -NEVER * side
    for k in range(rims.shape[0]):  # without branches, so that several lines are processed at a time
        across = offset + k * spacing
        s = min(max(across * slowness + shift, 0.0), length)
        miss = across - uf * s
        half2 = radius2 - miss * miss
        rim = (begin + um * s + side * np.sqrt(max(half2, 0.0))) * per_cell
        rims[k] = rim if half2 >= 0.0 else never


@kernel(lean=True)
def one_place(further: float, height: float, nearer: float, lower: float) -> float:
    """Place [cells] that replaces two heights [m] of a wall: with the same volume, or the further one.

    Beyond the border and before it count at different columns, so places on both sides of it have no mean.
    """
    if further * nearer < 0.0 or lower == 0.0:
        return further
    return (further * height + nearer * lower) / (height + lower)


@kernel(lean=True)
def advance_wall(
    walls: Singles, axis: int, i: int, j: int, side: int, beyond: float, height: float, fresh: float, dip: float
) -> float:
    """A tool came `beyond` [cells] a border along the upper `height` [m] of a wall; returns the gain [m].

    fresh: by how much the gone column has just been cut [m]. A step that was there before has no wall yet: it counts
    at the border until a tool comes beyond. dip: on a slope, how much higher or lower [m] a tool stands where it comes
    near the border than where it comes furthest; that much of the foot of a wall counts at the border.
    """
    place = float(walls[axis, i, j])
    if place == 0.0:
        if beyond <= 0.0:
            height = min(height, fresh)
        if height <= SAME_HEIGHT:
            return 0.0
        return set_wall(walls, axis, i, j, side, beyond, height, 0.0, 0.0)
    if place * side < 0.0:
        return 0.0  # an undercut: the wall of the other side goes with its column
    first, upper = abs(place) - 2.0, float(walls[HEIGHT + axis, i, j])
    lower = float(walls[LOWER + axis, i, j])
    second = float(walls[SECOND + axis, i, j]) if lower > 0.0 else first
    held = upper + lower
    more = height - held
    if beyond <= 0.0:
        more = min(more, fresh)
    if more <= SAME_HEIGHT:
        more = 0.0
    if abs(beyond - first) <= SAME_PLACE:
        beyond = first
    elif abs(beyond - second) <= SAME_PLACE:
        beyond = second
    if beyond <= second and (more == 0.0 or (beyond < second and more <= dip)):
        return 0.0  # other passes have taken more
    if height >= held - SAME_HEIGHT:  # all of the wall
        if beyond >= first:
            return set_wall(walls, axis, i, j, side, beyond, held + more, 0.0, 0.0)
        if beyond < second:
            first, upper, lower = one_place(first, upper, second, lower), held, 0.0
        return set_wall(walls, axis, i, j, side, first, upper, beyond, lower + more)
    rest = held - height
    if beyond >= first and height > upper - SAME_HEIGHT:
        return set_wall(walls, axis, i, j, side, beyond, height, second, rest)
    if height <= upper:
        if beyond <= first:
            return 0.0
        if lower == 0.0 and rest <= dip and first <= 0.0:
            return set_wall(walls, axis, i, j, side, beyond, height, 0.0, 0.0)
        if first * second < 0.0 and (0.5 - first) * (upper - height) < (first - second) * lower:
            return set_wall(walls, axis, i, j, side, beyond, upper, second, lower)
        second = one_place(first, upper - height, second, lower)
        return set_wall(walls, axis, i, j, side, beyond, height, second, rest)
    # between the two places: a third one, which counts with the nearer
    if rest <= dip and second <= 0.0:
        return set_wall(walls, axis, i, j, side, first, upper, beyond, height - upper)
    if rest < SLIVER * (height - upper):
        return set_wall(walls, axis, i, j, side, first, upper, beyond, lower)
    if 2.0 * beyond > first + second:
        return set_wall(walls, axis, i, j, side, first, height, second, rest)
    return 0.0


@kernel(lean=True)
def material_above(columns: Columns, i: int, j: int, bottom: float) -> float:
    """Length [m] of material of column (i, j) above `bottom`."""
    lo, hi, count = columns
    total = 0.0
    for k in range(count[i, j]):
        if hi[i, j, k] > bottom:
            total += hi[i, j, k] - max(lo[i, j, k], bottom)
    return total


@kernel(lean=True)
def reckon_walls(
    field: Field, piece: Piece, radius: float, low_z: float, bottom: float, cut: Cut, rims: Array
) -> float:
    """Compute the walls that an upright tool has left along a piece; returns the gain over the walls before [m].

    low_z: the lowest tip of the piece; bottom: the height over the tip [m] from which on the tool is a cylinder of
    `radius`; rims (2, n): scratch.
    """
    columns, grid, walls, _, _ = field
    _, hi, count = columns
    nx, ny = count.shape
    x0, y0, z0, ux, uy, length, slope = piece
    dip = abs(slope) * np.sqrt(2.0 * radius * max(grid.dx, grid.dy))
    gain = 0.0
    for axis in range(2):
        if axis == 0:  # rows along x, one for each j
            crossing, uf, um, lines, cells = y0, uy, ux, ny, nx
            line_origin, line_step, line_nudge = grid.y, grid.dy, NUDGE_Y
            origin, step, nudge, begin = grid.x, grid.dx, NUDGE_X, x0
        else:
            crossing, uf, um, lines, cells = x0, ux, uy, nx, ny
            line_origin, line_step, line_nudge = grid.x, grid.dx, NUDGE_X
            origin, step, nudge, begin = grid.y, grid.dy, NUDGE_Y, y0
        least = min(crossing, crossing + uf * length) - radius
        most = max(crossing, crossing + uf * length) + radius
        first, last = row_range(line_origin, line_step, line_nudge, lines, least, most)
        if first >= last:
            continue
        offset = line_origin + (first + 0.5 + line_nudge) * line_step - crossing
        lower, upper = rims[0, : last - first], rims[1, : last - first]
        find_rims(-1, offset, line_step, uf, um, length, radius, begin - origin, step, lower)
        find_rims(1, offset, line_step, uf, um, length, radius, begin - origin, step, upper)
        for line in range(first, last):
            below, above = float(lower[line - first]), float(upper[line - first])
            inner = int(np.ceil(below - 0.5 - nudge))  # the first column of the cut
            outer = int(np.floor(above - 0.5 - nudge)) + 1  # the first one after it
            if inner >= outer:
                continue
            for side in (1, -1):
                # the lower rim leaves the column below the border standing, the upper one the column above
                border = inner if side == 1 else outer
                if not (0 < border < cells):
                    continue
                standing, gone = (border - 1, border) if side == 1 else (border, border - 1)
                low = low_z + bottom
                if slope != 0.0:
                    across = offset + (line - first) * line_step
                    low = z0 + slope * place_on_rim(-side, across, uf, um, length, radius) + bottom
                i, j = (standing, line) if axis == 0 else (line, standing)
                n = count[i, j]
                if n == 0 or hi[i, j, n - 1] <= low:
                    continue
                gi, gj = (gone, line) if axis == 0 else (line, gone)
                height = material_above(columns, i, j, low) - material_above(columns, gi, gj, low)
                if height <= 0.0:
                    continue
                beyond = min(max(border - below if side == 1 else above - border, -0.5), 0.5)
                row = FIRST if side == 1 else LAST
                if axis == 0:
                    fresh = cut.x[row + 1, line] if cut.x[row, line] == gone else 0.0
                else:
                    fresh = cut.y[row + 1, line] if cut.y[row, line] == gone else 0.0
                bi, bj = (border, line) if axis == 0 else (line, border)
                gain += advance_wall(walls, axis, bi, bj, side, beyond, height, fresh, dip)
    return float(gain)
