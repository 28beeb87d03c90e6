"""How far the volume on the grid can be from the true one, read from columns and walls themselves.

Heights are exact at the centres of columns, so the volume is a sum over points in place of an integral. What is lost is
told by the stock as it is; here it is a height, by a cell's area h^2 a volume:

*Walls* stand between columns, at places that are known (wall_kernels). A straight wall is exact. Where it bends from
row to row, an arc is taken for its chords: one way at a hollow wall, the other way at a boss. Around a hole or a boss,
of which rows in x and in y see 10 cells of bending, that is 0.165 h^2, and +-0.085 h^2 by where the grid lies (measured
on 700 of 2 to 40 cells). So bends count by what is left when both ways are set against each other, and each by itself.
Where a wall ends, less than a cell of it is open.

*Slopes beside walls.* The height of a wall is read half a cell off the border, at the centre of the standing column.
The wall is t cells beyond the border, and what it takes or leaves lies about t/2 beyond it. If the standing side rises
by b from cell to cell, that errs by t b (1/2 - t/2), whose mean over t from -1/2 to 1/2 is -b/24, along the whole wall.
The floor behind a wall that was cut again does the same, now and then.

*Borders.* A sum over the middles of cells up to a border errs by 1/24 of the step from cell to cell there (formula of
Euler and Maclaurin). A wall that leaves the stock aslant has its last part beyond the last row.

*Slopes and cusps* are sampled: see wave_kernels.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field
from gcodesim.material.query_kernels import difference
from gcodesim.material.wall_kernels import HEIGHT, LOWER, Singles
from gcodesim.material.wave_kernels import DIRECTIONS, count_step, highest_wave

Array = NDArray[np.float64]

BEND = 0.04  # of a cell's area by the change of a wall's direction [cells a row]
ONE_WAY = 0.02  # more, by what of it is left when hollow and round walls are set against each other
END = 0.1  # of a cell's area where a wall ends
ASLANT = 0.2  # of a cell's area by the direction [cells a row] in which a wall leaves the stock
SLOPE = 0.07  # by the slopes of the standing sides of walls, all together: 1 / 24 with half as much again
SLOPES = 0.02  # by each slope beside a wall: what depends on where the wall stands in its cell
TWICE = 0.05  # of a cell's area by the height of a wall's further place, which stands for all but the nearest
BORDER = 1.0 / 12.0  # by the step at a border: twice that of the formula
SINGLE = 3.0e-7  # of a cell's area: places are numbers of single precision
ROUNDING = 1.0e-12  # of what was changed
NOWHERE = 1.0e9


class Seen(NamedTuple):
    """What has been seen of a stock: sums over its walls, and steps of its heights.

    walls (2,): bends with their sign, and slopes of standing sides [m]; steps (4, n) [m]: those between neighbours that
    are no walls, by their place along x, y and both diagonals; borders (2, 2) [m]: those at the first and the last
    column in x, and in y.
    """

    walls: Array
    steps: Array
    borders: Array


@kernel
def changes(columns: Columns, before: Columns, change: Array) -> float:
    """Fill `change` (nx, ny) with the length [m] in which each column differs from before; returns the sum.

    The state before may be given as one column for all.
    """
    nx, ny = columns.number.shape
    one_x, one_y = before.number.shape[0] == 1, before.number.shape[1] == 1
    total = 0.0
    for i in range(nx):
        for j in range(ny):
            ib, jb = 0 if one_x else i, 0 if one_y else j
            change[i, j] = difference(columns, i, j, before, ib, jb)
            total += change[i, j]
    return total


@kernel
def place_of(walls: Singles, axis: int, i: int, j: int) -> float:
    """Where the upper part of a wall stands, in cells from the border with index 0."""
    wall = float(walls[axis, i, j])
    beyond = abs(wall) - 2.0
    index = i if axis == 0 else j
    return index - beyond if wall > 0.0 else index + beyond


@kernel
def follows(walls: Singles, axis: int, i: int, j: int, way: int) -> float:
    """By how much [cells] a wall goes aside to the next row, `way` 1 or -1; NOWHERE where it does not go on."""
    a, b = (i, j + way) if axis == 0 else (i + way, j)
    if a < 0 or b < 0 or a >= walls.shape[1] or b >= walls.shape[2]:
        return NOWHERE
    here, best = place_of(walls, axis, i, j), NOWHERE
    for aside in (0, 1, -1):
        p, q = (a + aside, b) if axis == 0 else (a, b + aside)
        if p < 0 or q < 0 or p >= walls.shape[1] or q >= walls.shape[2]:
            continue
        if float(walls[axis, p, q]) * float(walls[axis, i, j]) > 0.0:
            step = place_of(walls, axis, p, q) - here
            if abs(step) < abs(best):
                best = step
    return best


@kernel
def goes_on(walls: Singles, axis: int, i: int, j: int) -> bool:
    """Whether a wall goes on in both neighbouring rows."""
    if follows(walls, axis, i, j, -1) == NOWHERE:
        return False
    return bool(follows(walls, axis, i, j, 1) < NOWHERE)


@kernel
def crossed(walls: Singles, axis: int, i: int, j: int) -> bool:
    """Whether a wall of the other direction that goes on stands beside one of the two columns: then this one slants."""
    other = 1 - axis
    for side in range(2):
        a, b = (i - side, j) if axis == 0 else (i, j - side)
        if a < 0 or b < 0:
            continue
        c, d = (a, b + 1) if other == 1 else (a + 1, b)
        if walls[other, a, b] != 0.0 and goes_on(walls, other, a, b):
            return True
        if walls[other, c, d] != 0.0 and goes_on(walls, other, c, d):
            return True
    return False


@kernel
def slope_at(change: Array, walls: Singles, axis: int, i: int, j: int) -> float:
    """Step [m] of what is gone over the border below column (i, j); 0 beyond the stock and where a wall stands."""
    below_i, below_j = (i - 1, j) if axis == 0 else (i, j - 1)
    if below_i < 0 or below_j < 0 or i >= change.shape[0] or j >= change.shape[1] or walls[axis, i, j] != 0.0:
        return 0.0
    return float(change[i, j] - change[below_i, below_j])


@kernel
def wall_error(field: Field, change: Array, axis: int, i: int, j: int, seen: Seen) -> float:
    """Length [m], by a cell's area a volume, by which what a wall of known place takes may be wrong by itself."""
    walls = field.walls
    height, lower = float(walls[HEIGHT + axis, i, j]), float(walls[LOWER + axis, i, j])
    row, rows = (j, walls.shape[2] - 2) if axis == 0 else (i, walls.shape[1] - 2)
    back, on = follows(walls, axis, i, j, -1), follows(walls, axis, i, j, 1)
    share = 0.0
    if back < NOWHERE and on < NOWHERE:
        bend = max(min(back + on, 1.0), -1.0)
        seen.walls[0] += (bend if walls[axis, i, j] > 0.0 else -bend) * (height + lower)
        share = BEND * abs(bend)
    elif row == 0 and on < NOWHERE:
        share = ASLANT * min(abs(on), 1.0)
    elif row == rows and back < NOWHERE:
        share = ASLANT * min(abs(back), 1.0)
    elif not crossed(walls, axis, i, j):
        share = END
    below = slope_at(change, walls, axis, i - (axis == 0), j - (axis == 1))
    above = slope_at(change, walls, axis, i + (axis == 0), j + (axis == 1))
    seen.walls[1] += below if walls[axis, i, j] > 0.0 else -above
    return float((share + SINGLE) * (height + lower) + TWICE * lower + SLOPES * (abs(below) + abs(above)))


@kernel
def count_border(change: Array, axis: int, i: int, j: int, step: float, seen: Seen) -> None:
    """Add a step to those at the first or last column, if it is one."""
    at = i if axis == 0 else j
    if at == 1:
        seen.borders[axis, 0] += step
    if at == change.shape[axis] - 1:
        seen.borders[axis, 1] += step


@kernel
def error_bound(field: Field, change: Array) -> float:
    """Volume [m^3] by which changed material may be off: walls, slopes beside them and at borders, waves in heights."""
    nx, ny = change.shape
    seen = Seen(np.zeros(2), np.zeros((DIRECTIONS, 2 * (nx + ny))), np.zeros((2, 2)))
    total = 0.0
    for i in range(nx):
        row = 0.0
        for j in range(ny):
            for axis in range(2):
                a, b = (i + 1, j) if axis == 0 else (i, j + 1)
                if a >= nx or b >= ny:
                    continue
                step, wall = change[a, b] - change[i, j], float(field.walls[axis, a, b])
                if wall != 0.0:
                    row += wall_error(field, change, axis, a, b, seen)
                    height = float(field.walls[HEIGHT + axis, a, b]) + float(field.walls[LOWER + axis, a, b])
                    step -= height if wall > 0.0 else -height
                elif step != 0.0:
                    count_border(change, axis, a, b, step, seen)
                if step != 0.0:
                    count_step(seen.steps, axis, a, b, step)
        total += row
    highest = 0.0
    for way in range(DIRECTIONS):
        highest = max(highest, highest_wave(seen.steps[way]))
    total += ONE_WAY * abs(seen.walls[0]) + SLOPE * abs(seen.walls[1]) + BORDER * float(np.abs(seen.borders).sum())
    return float((total + highest + ROUNDING * float(change.sum())) * float(field.grid.dx * field.grid.dy))
