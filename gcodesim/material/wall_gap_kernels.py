"""How far outside an upright tool material begins, from where walls really are.

Along each line of column centres the place of a wall is known to the last digits, if an upright tool has left it: also
that of the front which the tool itself has just cut. So what stands at the rim and what stands a little ahead of it can
be told apart by far less than a cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Field, coarsest
from gcodesim.material.near_wall_kernels import LOWEST, UNKNOWN, crossing_of
from gcodesim.material.sweep_kernels import NUDGE_X, NUDGE_Y

Array = NDArray[np.float64]

LINES = 3  # columns along a line that are looked at, from the one in which the rim is: a diagonal of a cell and more
NOTHING = 1.0e9  # [m] no material stands there
BEHIND = -1000000  # no column: the place is behind the tool
AT_RIM = 1.0e-4  # [cells] by which single precision and rounding may set a front off the rim that has cut it


class Rim(NamedTuple):
    """The rim of an upright tool: a circle around (x, y) of this radius [m], going along the unit vector (ux, uy)."""

    x: float
    y: float
    radius: float
    ux: float
    uy: float


class WallGap(NamedTuple):
    """How far outside a rim material begins [m], and down to which height that holds [m]; in which column of a line."""

    size: float
    foot: float
    column: int


@kernel(lean=True, inlined=True)
def stands(field: Field, i: int, j: int, height: float) -> bool:
    """Whether column (i, j) of one interval has material at a height [m]."""
    nx, ny = field.columns.number.shape
    if i < 0 or j < 0 or i >= nx or j >= ny:
        return False
    return bool(field.columns.lo[i, j, 0] <= height < field.columns.hi[i, j, 0])


@kernel(lean=True, inlined=True)
def is_behind(rim: Rim, axis: int, along: float, across: float) -> bool:
    """Whether a place on a rim, so far along a line and across it from the axis [m], is behind: the tool was there."""
    return rim.ux * along + rim.uy * across < 0.0 if axis == 0 else rim.uy * along + rim.ux * across < 0.0


@kernel(lean=True, inlined=True)
def gap_on_line(field: Field, rim: Rim, axis: int, line: int, side: int, height: float) -> WallGap:
    """Where material begins outside a rim on a line of column centres, along x (axis 0) or y; at once if not known.

    `side` 1: where the rim is farthest along the line, -1: at its other end. NOTHING where none stands within reach, or
    where the rim does not meet the line.
    """
    grid = field.grid
    if axis == 0:
        across = grid.y + (line + 0.5 + NUDGE_Y) * grid.dy - rim.y
        along, origin, size = rim.x, grid.x, grid.dx
    else:
        across = grid.x + (line + 0.5 + NUDGE_X) * grid.dx - rim.x
        along, origin, size = rim.y, grid.y, grid.dy
    square = rim.radius * rim.radius - across * across
    if square < 0.0:
        return WallGap(NOTHING, height, 0)
    half = side * np.sqrt(square)
    at_rim = (along + half - origin) / size - 0.5  # [cells] from the centre of the first column
    inside = int(np.floor(at_rim)) if side > 0 else int(np.ceil(at_rim))
    if is_behind(rim, axis, half, across):
        return WallGap(0.0, LOWEST, BEHIND)
    for k in range(LINES):
        column = inside + side * k
        i, j = (column, line) if axis == 0 else (line, column)
        if not stands(field, i, j, height):
            continue
        if k == 0:
            return WallGap(0.0, LOWEST, column)
        border = column if side > 0 else column + 1
        next_i, next_j = (border, line) if axis == 0 else (line, border)
        crossing = crossing_of(field, axis, next_i, next_j, side < 0, height)
        if crossing.place == UNKNOWN:
            return WallGap(0.0, LOWEST, column)
        at_wall = origin + (border - 0.5 + crossing.place) * size - along
        size = max(np.sqrt(at_wall * at_wall + across * across) - rim.radius, 0.0)
        return WallGap(size, crossing.foot, column)
    return WallGap(NOTHING, height, 0)


@kernel(lean=True, inlined=True)
def end_beside(field: Field, axis: int, line: int, step: int, column: int, height: float) -> float:
    """How far from a line [cells] its material ends towards the next one, which has none; all of it if not known."""
    next_line = line + 1 if step > 0 else line
    i, j = (column, next_line) if axis == 0 else (next_line, column)
    place = crossing_of(field, 1 - axis, i, j, step > 0, height).place
    if place == UNKNOWN:
        return 1.0
    return place if step > 0 else 1.0 - place


class LinePlace(NamedTuple):
    """A place on a rim between two lines of columns, along x (axis 0) or y: the first one, how far from it [cells].

    `side` 1: where the rim is farthest along the lines, -1: at their other end.
    """

    axis: int
    line: int
    part: float
    side: int


@kernel(lean=True, inlined=True)
def line_place(field: Field, rim: Rim, nx: float, ny: float) -> LinePlace:
    """The place on a rim in the direction of the unit vector (nx, ny), between lines that the rim crosses steeply."""
    grid = field.grid
    axis = 0 if abs(nx) * grid.dy >= abs(ny) * grid.dx else 1
    if axis == 0:
        place, side = (rim.y + rim.radius * ny - grid.y) / grid.dy - 0.5 - NUDGE_Y, 1 if nx > 0.0 else -1
    else:
        place, side = (rim.x + rim.radius * nx - grid.x) / grid.dx - 0.5 - NUDGE_X, 1 if ny > 0.0 else -1
    line = int(np.floor(place))
    return LinePlace(axis, line, place - line, side)


@kernel(lean=True, inlined=True)
def is_at_front(field: Field, axis: int, i: int, j: int, side: int, part: float, height: float, free: bool) -> bool:
    """Whether material is right at a rim that is `part` [cells] behind the centre of column (i, j), on its own line.

    At a height [m]; `free`: also where there is none within reach. See `gap_on_line`, which tells how far it is.
    """
    step_i, step_j = (side, 0) if axis == 0 else (0, side)
    if stands(field, i, j, height):
        return True
    if stands(field, i + step_i, j + step_j, height):
        border_i, border_j = (i + step_i, j + step_j) if side > 0 else (i, j)
        place = crossing_of(field, axis, border_i, border_j, side < 0, height).place
        if place == UNKNOWN:
            return True
        return bool((place if side > 0 else 1.0 - place) - part <= AT_RIM)
    for k in range(2, LINES):
        if stands(field, i + k * step_i, j + k * step_j, height):
            return False
    return free


@kernel(lean=True)
def first_away(field: Field, rim: Rim, directions: tuple[Array, Array], heights: tuple[Array, Array]) -> int:
    """The first of directions (n,) in which material is not right at a rim; n where it is in all of them.

    They are sines and cosines, from the left of the way of the rim on. heights (n,) [m]: where there is to be material,
    NaN: not asked; and where there may be none or such, too.
    """
    (sines, cosines), (lower, upper), grid = directions, heights, field.grid
    ux, uy = rim.ux, rim.uy
    per_x, per_y, square = 1.0 / grid.dx, 1.0 / grid.dy, rim.radius * rim.radius
    from_x, from_y = (rim.x - grid.x) * per_x - 0.5, (rim.y - grid.y) * per_y - 0.5  # [cells] from the first centres
    for k in range(lower.shape[0]):
        if np.isnan(lower[k]):
            continue
        nx, ny = ux * sines[k] - uy * cosines[k], uy * sines[k] + ux * cosines[k]
        axis = 0 if abs(nx) * grid.dy >= abs(ny) * grid.dx else 1
        if axis == 0:
            along, per_along, across, size, side = from_x, per_x, from_y - NUDGE_Y, grid.dy, 1 if nx > 0.0 else -1
            line = int(np.floor(across + rim.radius * ny * per_y))
        else:
            along, per_along, across, size, side = from_y, per_y, from_x - NUDGE_X, grid.dx, 1 if ny > 0.0 else -1
            line = int(np.floor(across + rim.radius * nx * per_x))
        for at_line in range(line, line + 2):
            off = (at_line - across) * size
            rest = square - off * off
            if rest < 0.0:  # beside the tool; the other line tells
                continue
            half = side * np.sqrt(rest)
            if is_behind(rim, axis, half, off):
                continue
            at_rim = along + half * per_along
            inside = int(np.floor(at_rim)) if side > 0 else int(np.ceil(at_rim))
            part = abs(at_rim - inside)
            i, j = (inside, at_line) if axis == 0 else (at_line, inside)
            if not is_at_front(field, axis, i, j, side, part, lower[k], False):
                return k
            if upper[k] > lower[k] and not is_at_front(field, axis, i, j, side, part, upper[k], True):
                return k
    return int(lower.shape[0])


@kernel(lean=True)
def gap_outside(field: Field, rim: Rim, nx: float, ny: float, height: float) -> WallGap:
    """Where material begins outside a rim at a height [m], in the direction of the unit vector (nx, ny).

    At once where that is not known; NOTHING where none stands within some two cells. Between the two lines of columns
    beside it the gap is linear: so it is exact for a front that the same tool has left. Where that front ends between
    them, at another wall or at nothing, the gap is below 0 before that place: minus the way to it.
    """
    grid = field.grid
    axis, line, part, side = line_place(field, rim, nx, ny)
    step, at_rim = 1, AT_RIM * coarsest(field)
    near = gap_on_line(field, rim, axis, line, side, height)
    far = gap_on_line(field, rim, axis, line + 1, side, height)
    if near.size > far.size:
        near, far, part, step, line = far, near, 1.0 - part, -1, line + 1
    if near.size == NOTHING or (near.column == BEHIND and far.size > at_rim):
        return near
    if far.size == NOTHING:
        beyond = part - end_beside(field, axis, line, step, near.column, height)
        beyond *= grid.dy if axis == 0 else grid.dx
        size = beyond if near.size <= at_rim else near.size + max(beyond, 0.0)
        return WallGap(size, near.foot, near.column)
    foot = max(near.foot, far.foot)
    if near.size > at_rim or far.size <= at_rim:
        return WallGap((1.0 - part) * near.size + part * far.size, foot, near.column)
    farther = gap_on_line(field, rim, axis, line + 2 * step, side, height)
    if farther.size == NOTHING or farther.size <= far.size:
        return near
    return WallGap(far.size - (1.0 - part) * (farther.size - far.size), foot, near.column)
