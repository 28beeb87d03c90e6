"""How far the volume on the grid can be from the true one, read from columns and walls themselves.

Heights are exact at the centres of columns, so the volume is a sum over points in place of an integral. Two things
are lost, and both are told by the stock as it is:

*Walls* stand between columns, at places that are known (wall_kernels). A straight wall is exact; where it bends from
row to row, an arc is taken for its chords, and where it ends, less than a cell of it is open.

*Slopes and cusps* are sampled. The sum over points h apart differs from the integral by the waves in the heights of
length h (Poisson's summation formula). Columns show waves of two cells and more. Those of a kink fall with the square
of the length, of a round edge with its power 1.5, of a step with its length; and a single one may be nought by chance.
So the mean of waves of 2 to 5 cells is compared with that of 6 to 8 cells: by the root of the share by which it has
fallen, up to a limit, the waves are taken to fall once more to those of one cell; that is what closed forms say. Rows
of cusps are waves of a single length: where one of two cells stands out, it says itself how high that of one cell,
its overtone, may be.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.material.field_kernels import Columns, Field
from gcodesim.material.query_kernels import difference
from gcodesim.material.wall_kernels import HEIGHT, LOWER, Singles

Array = NDArray[np.float64]

BEND = 0.1  # of a cell's area by the change of a wall's direction [cells a row]; an arc and its chords: 1 / 24
END = 0.1  # of a cell's area where a wall ends
TWICE = 0.05  # of a cell's area by the height of a wall's further place, which stands for all but the nearest
SINGLE = 3.0e-7  # of a cell's area: places are numbers of single precision
ROUNDING = 1.0e-12  # of what was changed
NOWHERE = 1.0e9

PHASES = 24  # rows of sums; waves are PHASES / n cells long
LONG, SHORT, LONE, NUMBERS = 3, 5, 11, 13  # n of waves from 8, from 5 and of about 2 cells, and their end
MOST_FALL = 0.45  # from waves of two to five cells to those of one
MARGIN = 1.25  # over the mean; of 1700 domes, cones, grooves and round slots one needed 1.03
STANDS_OUT = 3.0  # over the mean of other short waves: a row of cusps
OVERTONE = 1.5  # of a wave of two cells, of which the columns may show less than there is
DIRECTIONS = 4  # along x, along y, and both diagonals

_QUARTER = (
    1.0, 0.25 * (math.sqrt(6.0) + math.sqrt(2.0)), 0.5 * math.sqrt(3.0), math.sqrt(0.5), 0.5,
    0.25 * (math.sqrt(6.0) - math.sqrt(2.0)), 0.0,
)  # fmt: skip
_HALF = (*_QUARTER, *(-value for value in _QUARTER[-2::-1]))
COSINE = np.array((*_HALF, *_HALF[-2:0:-1]))
"""Cosines of multiples of 15 degrees, of square roots: the same bits on every processor."""


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
def wall_error(walls: Singles, axis: int, i: int, j: int) -> float:
    """Length [m], by a cell's area a volume, by which what a wall of known place takes may be wrong."""
    height, lower = float(walls[HEIGHT + axis, i, j]), float(walls[LOWER + axis, i, j])
    row, rows = (j, walls.shape[2] - 2) if axis == 0 else (i, walls.shape[1] - 2)
    back, on = follows(walls, axis, i, j, -1), follows(walls, axis, i, j, 1)
    share = 0.0
    if back < NOWHERE and on < NOWHERE:
        share = BEND * min(abs(back + on), 1.0)
    elif not (row == 0 and on < NOWHERE) and not (row == rows and back < NOWHERE) and not crossed(walls, axis, i, j):
        share = END
    return (share + SINGLE) * (height + lower) + TWICE * lower


@kernel
def count_wave(waves: Array, axis: int, i: int, j: int, step: float) -> None:
    """Add a step of the heights to the sums by phase: along its own axis, and along both diagonals."""
    waves[axis, (i if axis == 0 else j) % PHASES] += step
    if axis == 0:
        waves[2, (i + j) % PHASES] += step
        waves[3, (i - j) % PHASES] += step


@kernel
def wave(steps: Array, n: int) -> float:
    """Height [m] of the wave of PHASES / n cells in sums of which these (24,) are the steps by phase.

    It is twice its coefficient, over that of a step, 2 sin(pi n / PHASES); 4 sin^2 a = 2 - 2 cos 2 a.
    """
    along, across = 0.0, 0.0
    for phase in range(PHASES):
        turn = n * phase % PHASES
        along += steps[phase] * COSINE[turn]
        across += steps[phase] * COSINE[(turn + PHASES - PHASES // 4) % PHASES]
    return 2.0 * math.sqrt((along * along + across * across) / (2.0 - 2.0 * COSINE[n]))


@kernel
def highest_wave(steps: Array) -> float:
    """The most that the waves that columns show let expect of one of a cell [m, by a cell's area a volume]."""
    heights = np.zeros(NUMBERS)
    for n in range(LONG, NUMBERS):
        heights[n] = wave(steps, n)
    long = float(heights[LONG:SHORT].sum()) / (SHORT - LONG)
    short = float(heights[SHORT:].sum()) / (NUMBERS - SHORT)
    if short == 0.0:
        return 0.0
    fall = MOST_FALL if short >= MOST_FALL * MOST_FALL * long else math.sqrt(short / long)
    highest = MARGIN * fall * short
    lone = max(heights[LONE], heights[LONE + 1])
    if lone * (LONE - SHORT) > STANDS_OUT * float(heights[SHORT:LONE].sum()):
        highest = max(highest, OVERTONE * lone)
    return highest


@kernel
def error_bound(field: Field, change: Array) -> float:
    """Volume [m^3] by which changed material may be off: bends and ends of walls, and waves in the heights."""
    columns, grid, walls, _, _ = field
    nx, ny = columns.number.shape
    waves = np.zeros((DIRECTIONS, PHASES))  # steps between neighbours, without those of walls, by their phase
    total = 0.0
    for i in range(nx):
        row = 0.0
        for j in range(ny):
            for axis in range(2):
                a, b = (i + 1, j) if axis == 0 else (i, j + 1)
                if a >= nx or b >= ny:
                    continue
                step, wall = change[a, b] - change[i, j], float(walls[axis, a, b])
                if wall != 0.0:
                    row += wall_error(walls, axis, a, b)
                    height = float(walls[HEIGHT + axis, a, b]) + float(walls[LOWER + axis, a, b])
                    step -= height if wall > 0.0 else -height
                if step != 0.0:
                    count_wave(waves, axis, a, b, step)
        total += row
    highest = 0.0
    for way in range(DIRECTIONS):
        highest = max(highest, highest_wave(waves[way]))
    rounding = ROUNDING * float(change.sum())
    return (total + highest + rounding) * float(grid.dx * grid.dy)
