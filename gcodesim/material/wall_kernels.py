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

**Other sides.** A stock that was turned over has walls that hang: they were cut from what is the lower side now. They
are kept as they were, in eight further planes in the same order, from `HUNG` on, and two more say how much of the
standing column is above them [m], from `ABOVE` on. What cuts from above goes into them only where it comes as deep.
A column loses the most that its standing walls take, and the most that its hanging walls take, which are in different
heights. Of a stock that was laid on an edge, floors and walls of before hang like that, too.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field, Grid, coarsest
from gcodesim.material.floor_kernels import BLOCK, FloorLine, Sweep
from gcodesim.material.sweep_kernels import NUDGE_X, NUDGE_Y, row_range, underside

Array = NDArray[np.float64]
Singles = NDArray[np.float32]

SAME_PLACE = 1.0e-5  # walls closer than this share of a cell are the same wall, cut again
NEVER = 1.0e9  # a place [cells] that no stock has
SLIVER = 0.125  # a step lower than this share of the height above it is not a place of its own: the tip shakes
SAME_HEIGHT = 1.0e-8  # heights [m] closer than this are the same: rounding of single precision

# planes of `walls`, each for borders in x and, one further on, in y
PLACE, HEIGHT, SECOND, LOWER = 0, 2, 4, 6
WALL_PLANES = HUNG = 8
ABOVE = 16
TURNED_PLANES = 18


class Ends(NamedTuple):
    """Which columns of lines (n,) a piece has cut first and last, -1 where none, and by how much each was cut [m]."""

    first: Array
    first_gone: Array
    last: Array
    last_gone: Array


class Cut(NamedTuple):
    """Ends of what a piece has cut of lines along x, and along y."""

    x: Ends
    y: Ends


@kernel(lean=True)
def forget(ends: Ends, first: int, last: int) -> None:
    """Of lines first..last nothing is cut yet."""
    for line in range(first, last):
        ends.first[line], ends.last[line] = -1.0, -1.0


@kernel(lean=True, inlined=True)
def fresh_cut(ends: Ends, line: int, side: int, column: int) -> float:
    """By how much a column was cut [m] that is the first of its line (side 1), or the last; 0 if it is not."""
    if side == 1:
        return ends.first_gone[line] if ends.first[line] == column else 0.0
    return ends.last_gone[line] if ends.last[line] == column else 0.0


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
def most_taken(walls: Singles, kind: int, i: int, j: int, but: int) -> float:
    """What walls of a kind, 0 or HUNG, take of standing column (i, j) [m]; `but`: a border that does not count, see
    `set_wall`."""
    most = 0.0
    if walls[kind, i, j] < 0.0 and but != 0:
        most = taken(walls, kind, i, j)
    if walls[kind + 1, i, j] < 0.0 and but != 1:
        most = max(most, taken(walls, kind + 1, i, j))
    if walls[kind, i + 1, j] > 0.0 and but != 2:
        most = max(most, taken(walls, kind, i + 1, j))
    if walls[kind + 1, i, j + 1] > 0.0 and but != 3:
        most = max(most, taken(walls, kind + 1, i, j + 1))
    return most


@kernel(lean=True)
def most_left(walls: Singles, kind: int, i: int, j: int, but: int) -> float:
    """What walls of a kind, 0 or HUNG, leave of gone column (i, j) [m]; `but`: a border that does not count."""
    most = 0.0
    if walls[kind, i, j] > 0.0 and but != 0:
        most = left(walls, kind, i, j)
    if walls[kind + 1, i, j] > 0.0 and but != 1:
        most = max(most, left(walls, kind + 1, i, j))
    if walls[kind, i + 1, j] < 0.0 and but != 2:
        most = max(most, left(walls, kind, i + 1, j))
    if walls[kind + 1, i, j + 1] < 0.0 and but != 3:
        most = max(most, left(walls, kind + 1, i, j + 1))
    return most


@kernel
def beyond_columns(walls: Singles) -> float:
    """Sum of what walls take of columns less what they leave of gone ones [m, by the area of a cell a volume]."""
    total = 0.0
    for i in range(walls.shape[1] - 1):
        row = 0.0
        for j in range(walls.shape[2] - 1):
            row += most_taken(walls, 0, i, j, -1) - most_left(walls, 0, i, j, -1)
            if walls.shape[0] > HUNG:
                row += most_taken(walls, HUNG, i, j, -1) - most_left(walls, HUNG, i, j, -1)
        total += row
    return total


@kernel(lean=True)
def set_wall(
    walls: Singles, axis: int, i: int, j: int, side: int, beyond: float, height: float, second: float, lower: float
) -> float:
    """Put a wall with one or two places at a border; returns how much more is gone than before [m].

    axis: 0 or 1, for a hanging wall HUNG or HUNG + 1.
    side: +1 when the column below the border is left standing, -1 when the one above is. No height: no wall.
    Of its two columns the border is number `axis` of the one above, 2 + `axis` of the one below.
    """
    kind, number = (HUNG, axis - HUNG) if axis >= HUNG else (0, axis)
    taken_before, left_before = taken(walls, axis, i, j), left(walls, axis, i, j)
    walls[axis, i, j] = side * (beyond + 2.0) if height > 0.0 else 0.0
    walls[HEIGHT + axis, i, j] = height
    if lower > 0.0 or walls[LOWER + axis, i, j] > 0.0:  # few walls have a second place
        walls[SECOND + axis, i, j], walls[LOWER + axis, i, j] = second, lower
    taken_now, left_now = taken(walls, axis, i, j), left(walls, axis, i, j)
    below_i, below_j = (i - 1, j) if number == 0 else (i, j - 1)
    gain = 0.0
    if taken_now != taken_before:
        if side > 0:
            others = most_taken(walls, kind, below_i, below_j, 2 + number)
        else:
            others = most_taken(walls, kind, i, j, number)
        gain += max(taken_now, others) - max(taken_before, others)
    if left_now != left_before:
        if side > 0:
            others = most_left(walls, kind, i, j, number)
        else:
            others = most_left(walls, kind, below_i, below_j, 2 + number)
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
def lower_hung(walls: Singles, axis: int, i: int, j: int, gone: float) -> float:
    """The standing column at a border was cut by `gone` [m]: its hanging wall ends lower if that comes as deep; returns
    the gain [m]."""
    above = float(walls[ABOVE + axis, i, j]) - gone
    walls[ABOVE + axis, i, j] = max(above, 0.0)
    if above >= -SAME_HEIGHT:
        return 0.0
    hung = HUNG + axis
    height, lower = float(walls[HEIGHT + hung, i, j]), float(walls[LOWER + hung, i, j]) + above
    if lower <= SAME_HEIGHT:
        height, lower = height + min(lower, 0.0), 0.0
    if height <= SAME_HEIGHT:
        height = 0.0
    side = 1 if walls[hung, i, j] > 0.0 else -1
    beyond, second = abs(float(walls[hung, i, j])) - 2.0, float(walls[SECOND + hung, i, j])
    return set_wall(walls, hung, i, j, side, beyond, height, second, lower)


@kernel(lean=True)
def shorten_walls(walls: Singles, i: int, j: int, gone: float) -> float:
    """Column (i, j) was cut by `gone` [m], and its walls in that height are gone too; returns the gain [m]."""
    gain = 0.0
    for axis in range(2):
        bi, bj = (i + 1, j) if axis == 0 else (i, j + 1)
        if walls[axis, i, j] < 0.0:
            gain += shorten_wall(walls, axis, i, j, gone)
        if walls[axis, bi, bj] > 0.0:
            gain += shorten_wall(walls, axis, bi, bj, gone)
        if walls.shape[0] > HUNG:
            if walls[HUNG + axis, i, j] < 0.0:
                gain += lower_hung(walls, axis, i, j, gone)
            if walls[HUNG + axis, bi, bj] > 0.0:
                gain += lower_hung(walls, axis, bi, bj, gone)
    return gain


@kernel(lean=True)
def own_height(walls: Singles, axis: int, i: int, j: int, beyond: float, height: float) -> float:
    """How deep [m] a cut that came `beyond` [cells] a border, along the upper `height` [m], has a wall of its own.

    Below that the wall that hangs there is as far or further.
    """
    hung, own = HUNG + axis, float(walls[ABOVE + axis, i, j])
    first, second = abs(float(walls[hung, i, j])) - 2.0, float(walls[SECOND + hung, i, j])
    lower = float(walls[LOWER + hung, i, j])
    if height <= own or (lower > 0.0 and beyond <= second + SAME_PLACE):
        return min(height, own)
    own += lower
    return min(height, own) if beyond <= first + SAME_PLACE else height


@kernel(lean=True)
def place_on_rim(side: int, offset: float, uf: float, um: float, length: float, radius: float) -> float:
    """Where on a piece [m] the disc is whose rim is extreme on a line that crosses the piece.

    The line keeps its first coordinate `offset` from the piece's start and runs along the second; (uf, um) is the
    direction of the piece in these. `side` -1: the lower rim, +1: the upper one.
    """
    if uf == 0.0:
        return length if side * um > 0.0 else 0.0
    return min(max((offset + radius * um * (side if uf > 0.0 else -side)) / uf, 0.0), length)


class CrossedRows(NamedTuple):
    """CrossedRows of columns that cross a piece: along x (axis 0) or along y, those from `first` to `last` - 1 of all.

    The first is at `offset` [m] from the start of the piece, where `begin` [m] along the rows is; (uf, um) is the
    direction of the piece across the rows and along them; columns are `step` [m] apart, `nudge` [cells] off the middle.
    """

    axis: int
    first: int
    last: int
    offset: float
    spacing: float
    uf: float
    um: float
    begin: float
    step: float
    nudge: float
    columns: int


@kernel(lean=True, inlined=True)
def rows_across(grid: Grid, shape: tuple[int, int], sweep: Sweep, axis: int) -> CrossedRows:
    """The rows along one axis that a sweep may cross."""
    (nx, ny), (x, y, dx, dy), (x0, y0, _, ux, uy, length, _) = shape, grid, sweep.piece
    if axis == 0:
        crossing, uf, um, lines, columns = y0, uy, ux, ny, nx
        line_origin, spacing, line_nudge, begin, step, nudge = y, dy, NUDGE_Y, x0 - x, dx, NUDGE_X
    else:
        crossing, uf, um, lines, columns = x0, ux, uy, nx, ny
        line_origin, spacing, line_nudge, begin, step, nudge = x, dx, NUDGE_X, y0 - y, dy, NUDGE_Y
    least = min(crossing, crossing + uf * length) - sweep.shape.radius
    most = max(crossing, crossing + uf * length) + sweep.shape.radius
    first, last = row_range(line_origin, spacing, line_nudge, lines, least, most)
    offset = line_origin + (first + 0.5 + line_nudge) * spacing - crossing
    return CrossedRows(axis, first, last, offset, spacing, uf, um, begin, step, nudge, columns)


@kernel(lean=True, inlined=True)
def find_rims(side: int, rows: CrossedRows, length: float, radius: float, rims: Array) -> None:
    """Rim of a swept disc in each row (n,) [cells], as in `place_on_rim`.

    A row that is never reached has it on the wrong side.
    """
    uf, um, offset, spacing, begin = rows.uf, rows.um, rows.offset, rows.spacing, rows.begin
    slowness, shift = 0.0, length if side * um > 0.0 else 0.0
    if uf != 0.0:
        slowness = 1.0 / uf
        shift = radius * um * (side if uf > 0.0 else -side) * slowness
    per_cell = 1.0 / rows.step
    radius2, never = radius * radius, -NEVER * side
    for block in range(0, rows.last - rows.first, BLOCK):
        for k in range(BLOCK):  # without branches, so that several rows are processed at a time
            across = offset + (block + k) * spacing
            s = min(max(across * slowness + shift, 0.0), length)
            miss = across - uf * s
            half2 = radius2 - miss * miss
            rim = (begin + um * s + side * np.sqrt(max(half2, 0.0))) * per_cell
            rims[np.uint64(block) + np.uint64(k)] = rim if half2 >= 0.0 else never


@kernel(lean=True, inlined=True)
def mark_walls(
    highs: Array, rows: CrossedRows, stride: int, low: float, lower: Array, upper: Array, marks: Array
) -> None:
    """Mark rows (n,) with a column beside a rim that ends above `low` [m]: +1 below the lower one, +2 above the upper.

    Columns have one interval each, all of them in one array; `stride`: from one row along x to the next.
    """
    across, along = (1, stride) if rows.axis == 0 else (stride, 1)
    most, last_row, beside = np.float64(rows.columns - 1), np.float64(rows.last - 1), 0.5 + rows.nudge
    for block in range(0, rows.last - rows.first, BLOCK):
        for k in range(BLOCK):
            row = np.uint64(min(np.float64(rows.first + block + k), last_row))
            inner = np.ceil(lower[np.uint64(block) + np.uint64(k)] - beside)
            outer = np.floor(upper[np.uint64(block) + np.uint64(k)] - beside) + 1.0
            cut = np.uint8(inner < outer)
            below = cut & np.uint8(inner > 0.0) & np.uint8(inner <= most)
            above = cut & np.uint8(outer > 0.0) & np.uint8(outer <= most)
            at_below = np.uint64(min(max(inner - 1.0, 0.0), most)) * np.uint64(along)
            at_above = np.uint64(min(max(outer, 0.0), most)) * np.uint64(along)
            below &= np.uint8(highs[at_below + row * np.uint64(across)] > low)
            above &= np.uint8(highs[at_above + row * np.uint64(across)] > low)
            marks[np.uint64(block) + np.uint64(k)] = (1.0 if below else 0.0) + (2.0 if above else 0.0)


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
            if first * second < 0.0 and second * beyond >= 0.0:  # only the lower two have a mean
                second = (second * lower + beyond * more) / (lower + more)
                return set_wall(walls, axis, i, j, side, first, upper, second, lower + more)
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


@kernel(lean=True, inlined=True)
def reckon_wall(
    field: Field, sweep: Sweep, rows: CrossedRows, row: int, side: int, border: int, rim: float, cut: Cut
) -> float:  # fmt: skip
    """Compute the wall that a rim has left at a border of a row; the gain over the one before [m].

    `side` 1: the lower rim leaves the column below the border standing, -1: the upper one the column above it.
    """
    _, _, z0, _, _, length, slope = sweep.piece
    radius, profile = sweep.shape.radius, sweep.shape.bottom + underside(sweep.shape, sweep.shape.radius)
    _, hi, count = field.columns
    standing, gone = (border - 1, border) if side == 1 else (border, border - 1)
    low, dip = sweep.low_tip + profile, 0.0
    if slope != 0.0:
        across = rows.offset + (row - rows.first) * rows.spacing
        low = z0 + slope * place_on_rim(-side, across, rows.uf, rows.um, length, radius) + profile
        dip = abs(slope) * np.sqrt(2.0 * radius * coarsest(field))
    i, j = (standing, row) if rows.axis == 0 else (row, standing)
    n = count[i, j]
    if n == 0 or hi[i, j, n - 1] <= low:
        return 0.0
    gi, gj = (gone, row) if rows.axis == 0 else (row, gone)
    height = material_above(field.columns, i, j, low) - material_above(field.columns, gi, gj, low)
    if height <= 0.0:
        return 0.0
    beyond = min(max(border - rim if side == 1 else rim - border, -0.5), 0.5)
    fresh = fresh_cut(cut.x if rows.axis == 0 else cut.y, row, side, gone)
    bi, bj = (border, row) if rows.axis == 0 else (row, border)
    gain, walls = 0.0, field.walls
    if walls.shape[0] > HUNG and float(walls[HUNG + rows.axis, bi, bj]) * side > 0.0:
        above = float(walls[ABOVE + rows.axis, bi, bj])
        height = own_height(walls, rows.axis, bi, bj, beyond, height)
        if height > above:
            gain = lower_hung(walls, rows.axis, bi, bj, height)
            walls[ABOVE + rows.axis, bi, bj] = height
            fresh += height - above
    return gain + advance_wall(walls, rows.axis, bi, bj, side, beyond, height, fresh, dip)


@kernel(lean=True)
def reckon_walls(field: Field, sweep: Sweep, cut: Cut, spare: FloorLine) -> float:
    """Compute the walls that an upright tool has left along a piece; returns the gain over the walls before [m]."""
    lo, hi, count = field.columns
    lower, upper, marks = spare.floor, spare.gone, spare.squares
    gain = 0.0
    for axis in range(2):
        rows = rows_across(field.grid, count.shape, sweep, axis)
        find_rims(-1, rows, sweep.piece.length, sweep.shape.radius, lower)
        find_rims(1, rows, sweep.piece.length, sweep.shape.radius, upper)
        if lo.shape[2] == 1:
            mark_walls(hi.reshape(hi.size), rows, count.shape[1], sweep.cylinder - SAME_HEIGHT, lower, upper, marks)
        for row in range(rows.first, rows.last):
            k = row - rows.first
            if lo.shape[2] == 1 and marks[k] == 0.0:  # nearly always
                continue
            inner = int(np.ceil(lower[k] - 0.5 - rows.nudge))  # the first column of the cut
            outer = int(np.floor(upper[k] - 0.5 - rows.nudge)) + 1  # the first one after it
            if inner >= outer:
                continue
            if 0 < inner < rows.columns:
                gain += reckon_wall(field, sweep, rows, row, 1, inner, lower[k], cut)
            if 0 < outer < rows.columns:
                gain += reckon_wall(field, sweep, rows, row, -1, outer, upper[k], cut)
    return float(gain)
