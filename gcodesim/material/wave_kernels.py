"""How high the waves in the heights of columns are, and what they let expect of one that is as long as a cell.

The sum over points h apart differs from the integral by the waves in the heights of length h (Poisson's summation
formula). Columns show only waves of two cells and more. Those of a kink fall with the square of the length, of a round
edge with its power 1.5, of a step with its length. A single one may be nought by chance: of three kinks a whole number
of its lengths apart. So many are looked at, of lengths that have no common multiple. The mean of those of 2 to 5 cells
has fallen from that of 5.5 to 9 cells by some share, and by this share it is taken to fall once more to the wave of one
cell. With the powers 2, 1.5 and 1 that is 2.0, 1.6 and 1.3 times as high as it really is, before any margin.

Rows of cusps are waves of a single length, which these means do not meet. If q rows, or some other number of them, are
as long as q cells, the wave of one cell is their overtone; of parabolas, of which cusps are made, the q-th is 1 / q^2
as high as the first.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel

Array = NDArray[np.float64]

DIRECTIONS = 4  # along x, along y, and both diagonals
GOLDEN = 0.6180339887498949  # multiples of it, less their whole part, lie evenly and nowhere twice
SHORTEST, SHORT, SHORTS = 0.5, 0.2, 48  # waves in a cell: those of 2 cells, of 5 cells, and how many between
LONG, LONGEST, LONGS = 1.0 / 5.5, 1.0 / 9.0, 16
MOST_FALL = 0.45  # from waves of two to five cells to those of one
MARGIN = 2.2  # over the mean; of 2000 forms that were drawn one needed 1.8
STANDS_OUT = 3.0  # over the mean of other short waves: a row of cusps
OVERTONE = 1.5  # of a wave of two cells, of which the columns may show less than there is; times 1 / q^2 of q cells
LONE = np.array([[1.0, 3.0], [1.0, 4.0], [1.0, 5.0], [2.0, 5.0], [1.0, 6.0]])
"""Waves in cells of which a whole number is as long as these: such rows meet a cell again."""


@kernel
def count_step(steps: Array, axis: int, i: int, j: int, step: float) -> None:
    """Add a step of the heights below column (i, j) to the sums (4, n): along its own axis, and both diagonals.

    Along a diagonal there is a step in x and one in y from each row to the next.
    """
    steps[axis, i if axis == 0 else j] += step
    steps[2, i + j] += 0.5 * step
    steps[3, steps.shape[1] // 2 + i - j] += 0.5 * step


@kernel
def wave(steps: Array, often: float) -> float:
    """Height [m] of the wave that fits `often` times in a cell, in sums of which these (n,) are the steps.

    It is twice its coefficient, over that of a step, 2 sin(pi often).
    """
    cosine, sine = cos_sin(2.0 * math.pi * often)
    along, across, c, s = 0.0, 0.0, 1.0, 0.0
    for k in range(steps.shape[0]):
        along += steps[k] * c
        across += steps[k] * s
        c, s = c * cosine - s * sine, s * cosine + c * sine
    return math.sqrt(along * along + across * across) / cos_sin(math.pi * often)[1]


@kernel
def mean_wave(steps: Array, least: float, most: float, number: int) -> float:
    """Mean height [m] of waves that fit `least` to `most` times in a cell."""
    total = 0.0
    for k in range(number):
        total += wave(steps, least + (most - least) * (GOLDEN * k - math.floor(GOLDEN * k)))
    return total / number


@kernel
def highest_wave(steps: Array) -> float:
    """The most that the waves that columns show let expect of one of a cell [m, by a cell's area a volume]."""
    short = mean_wave(steps, SHORT, SHORTEST, SHORTS)
    if short == 0.0:
        return 0.0
    long = mean_wave(steps, LONGEST, LONG, LONGS)
    highest = MARGIN * short * (MOST_FALL if short >= MOST_FALL * long else short / long)
    lone = wave(steps, SHORTEST)
    if lone > STANDS_OUT * short:
        highest = max(highest, OVERTONE * lone)
    for k in range(LONE.shape[0]):
        highest = max(highest, OVERTONE / (LONE[k, 1] * LONE[k, 1]) * wave(steps, LONE[k, 0] / LONE[k, 1]))
    return highest
