"""The wall near a place, where it really is: what the columns around say, and the places that `wall_kernels` keeps.

Four column centres make a square. A straight wall that parts them crosses two sides of it, and of each crossing the
place is known: so is the line of the wall, at any angle to the grid (marching squares with known crossings).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field
from gcodesim.material.place_kernels import ToColumns
from gcodesim.material.query_kernels import surrounding
from gcodesim.material.wall_kernels import ABOVE, HEIGHT, HUNG, LOWER, SECOND

Array = NDArray[np.float64]
Singles = NDArray[np.float32]

DIFFERENT = 0.5  # of a height, by which columns differ on both sides of a wall
SHORTEST = 1.0e-3  # [cells] between two crossings that make a line
UNKNOWN = -1.0
LOWEST, UNSEEN = -1.0e9, 1.0e9  # heights [m]: of a foot that is below everything, of none
UNCUT = 0.5  # where material ends at the border of the stock
# A wall that the tool follows goes so many times farther along u than along l. Of one at 45 degrees, ripples would
# decide that from step to step.
NEARER = 1.02


class NearWall(NamedTuple):
    """A wall: whether there is one whose line is known, how far it is [m], its slope, and where material is.

    All along a direction l and across it, u: `slope` is the way to l for each way along u; down to the height `foot`.
    """

    known: bool
    aside: float
    slope: float
    foot: float


class WallCrossing(NamedTuple):
    """Where a wall crosses from the centre of a column to the next [cells], or UNKNOWN; down to which height [m]."""

    place: float
    foot: float


@kernel(lean=True, inlined=True)
def top_of(columns: Columns, i: int, j: int, low: float, high: float) -> float:
    """Where column (i, j) of one interval ends, between `low` and `high` [m]; `low` if it has nothing there."""
    nx, ny = columns.number.shape
    if i < 0 or j < 0 or i >= nx or j >= ny or columns.lo[i, j, 0] > low:
        return low
    return float(max(min(columns.hi[i, j, 0], high), low))


@kernel(lean=True, inlined=True)
def crossing_of(field: Field, axis: int, i: int, j: int, first_stands: bool, height: float) -> WallCrossing:
    """Where a wall crosses from the centre of a column to that of (i, j), the next one along an axis.

    UNKNOWN where no upright tool has left a wall of this height [m].
    """
    columns, _, walls, _, _ = field
    shape = columns.number.shape
    number, last = (i, shape[0]) if axis == 0 else (j, shape[1])
    if number == 0 or number == last:
        return WallCrossing(UNCUT, LOWEST)
    stands_i = i - 1 if first_stands and axis == 0 else i
    stands_j = j - 1 if first_stands and axis == 1 else j
    top = columns.hi[stands_i, stands_j, 0]
    place, foot = float(walls[axis, i, j]), LOWEST
    if place != 0.0 and (place > 0.0) == first_stands:
        beyond = abs(place) - 2.0
        foot = top - float(walls[HEIGHT + axis, i, j])
        if foot > height:
            foot -= float(walls[LOWER + axis, i, j])
            beyond = float(walls[SECOND + axis, i, j])
        if foot <= height:
            return WallCrossing(UNCUT - beyond if first_stands else UNCUT + beyond, foot)
    hung = float(walls[HUNG + axis, i, j]) if walls.shape[0] > HUNG else 0.0
    if hung != 0.0 and (hung > 0.0) == first_stands:
        beyond = float(walls[SECOND + HUNG + axis, i, j])
        head = top - float(walls[ABOVE + axis, i, j])
        middle = head - float(walls[LOWER + HUNG + axis, i, j])
        end = middle - float(walls[HEIGHT + HUNG + axis, i, j])
        if middle >= height:
            beyond = abs(hung) - 2.0
        if head >= height >= end:
            return WallCrossing(UNCUT - beyond if first_stands else UNCUT + beyond, end)
    return WallCrossing(UNKNOWN, foot)


@kernel(lean=True, inlined=True)
def has_wall(field: Field, i: int, j: int) -> bool:
    """Whether any side of the square (i, j) is crossed by a wall, or lies on the border of the stock."""
    nx, ny = field.columns.number.shape
    if i < -1 or j < -1 or i >= nx or j >= ny:
        return False
    if i < 0 or j < 0 or i + 1 >= nx or j + 1 >= ny:
        return True
    walls = field.walls
    for kind in range(0, min(walls.shape[0], ABOVE), HUNG):
        crossed_x = walls[kind, i + 1, j] != 0.0 or walls[kind, i + 1, j + 1] != 0.0
        if crossed_x or walls[kind + 1, i, j + 1] != 0.0 or walls[kind + 1, i + 1, j + 1] != 0.0:
            return True
    return False


@kernel(lean=True, inlined=True)
def walled_at(field: Field, columns: ToColumns, ahead: float, aside: float) -> bool:
    """Whether there may be a wall between the columns around a place, u and l [m] of `ToColumns`."""
    i0, j0, i_u, i_l, j_u, j_l, _, _, _, _ = columns
    i, j = i0 + i_u * ahead + i_l * aside, j0 + j_u * ahead + j_l * aside
    return bool(has_wall(field, int(np.floor(i)), int(np.floor(j))))


@kernel(lean=True, inlined=True)
def line_across(field: Field, i: int, j: int, low: float, high: float, line: Array) -> float:
    """Two points of the wall in the square (i, j), into `line` (4,) [cells from column i, j]; the height of its foot.

    UNSEEN without a line that is known along all of the wall between `low` and `high` [m].
    """
    columns = field.columns
    a, b = top_of(columns, i, j, low, high), top_of(columns, i + 1, j, low, high)
    c, d = top_of(columns, i, j + 1, low, high), top_of(columns, i + 1, j + 1, low, high)
    most, least = max(max(a, b), max(c, d)), min(min(a, b), min(c, d))
    if most - least <= DIFFERENT * (high - low):
        return UNSEEN
    height = 0.5 * (most + least)
    at_a, at_b, at_c, at_d = a > height, b > height, c > height, d > height
    found, foot = 0, LOWEST
    for across in range(4):  # between columns along x twice, then along y
        axis, side = across >> 1, across & 1
        if axis == 0:
            one, other = (at_a, at_b) if side == 0 else (at_c, at_d)
        else:
            one, other = (at_a, at_c) if side == 0 else (at_b, at_d)
        if one == other:
            continue
        next_i, next_j = (i + 1, j + side) if axis == 0 else (i + side, j + 1)
        crossing = crossing_of(field, axis, next_i, next_j, one, height)
        if found == 2 or crossing.place == UNKNOWN:  # two corners that touch, or no wall
            return UNSEEN
        line[2 * found], line[2 * found + 1] = crossing.place, float(side)
        if axis == 1:
            line[2 * found], line[2 * found + 1] = float(side), crossing.place
        found, foot = found + 1, max(foot, crossing.foot)
    return foot


@kernel(lean=True, inlined=True)
def wall_near(
    field: Field, x: float, y: float, z0: float, z1: float, ux: float, uy: float, line: Array
) -> NearWall:  # fmt: skip
    """The wall between the columns around (x, y) that stands in z0..z1 [m]; l is to the left of the unit vector u.

    Only one that is clearly nearer to u than to l: of others nothing is said. line (4,) is room.
    """
    nothing = NearWall(False, 0.0, 0.0, UNSEEN)
    grid = field.grid
    if field.columns.lo.shape[2] != 1:
        return nothing
    i, j, wx, wy = surrounding(grid, x, y)
    if not has_wall(field, i, j):  # nearly always
        return nothing
    foot = line_across(field, i, j, z0, z1, line)
    if foot == UNSEEN or abs(line[2] - line[0]) + abs(line[3] - line[1]) < SHORTEST:
        return nothing
    way_x, way_y = (line[2] - line[0]) * grid.dx, (line[3] - line[1]) * grid.dy
    along, across = way_x * ux + way_y * uy, way_y * ux - way_x * uy
    if abs(along) <= NEARER * abs(across):
        return nothing
    slope = across / along
    off_x, off_y = (line[0] - wx) * grid.dx, (line[1] - wy) * grid.dy
    aside = off_y * ux - off_x * uy - slope * (off_x * ux + off_y * uy)
    return NearWall(True, aside, slope, foot)
