"""How fast the planner of a printer, or of grbl, passes the corners of its moves; arrays in and out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.arithmetic.atan_kernels import acos
from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column

SHORT = 1.0e-3  # [m] moves below this also pass blunt corners as if they were an arc through them (Marlin)
STRAIGHT = 0.999999  # cosine from which two moves count as one line


class Moves(NamedTuple):
    """n moves: `begin` and `end` (n, 4) are the directions at their ends, filament as a fourth axis for each metre of
    way; `length`, `speed` and `acceleration` (n,) hold along them.
    """

    begin: Column
    end: Column
    length: Column
    speed: Column
    acceleration: Column


class JunctionLimits(NamedTuple):
    """What rules the corner behind each move, as in `MotionLimits`: `jerk` (n, 4); the others (n,), `plain` as 0 or 1.

    `axes` (3,) [m/s²] are the accelerations of the machine's X, Y and Z.
    """

    jerk: Column
    deviation: Column
    corner: Column
    plain: Column
    axes: Column


@kernel
def step_factor(before: Column, after: Column, jerk: Column, speed: float) -> float:
    """By how much [-] a common speed has to be reduced so that no axis changes its own by more than `jerk` (4,).

    Marlin's `planner.cpp`, classic jerk: an axis that turns back counts with the greater of its two speeds.
    """
    factor = 1.0
    for axis in range(4):
        out, into = before[axis] * speed * factor, after[axis] * speed * factor
        if out * into >= 0.0:
            step = abs(out - into)
        else:
            step = max(abs(out), abs(into))
        if step > jerk[axis]:
            factor *= jerk[axis] / step
    return factor


@kernel
def across_corner(moves: Moves, k: int, axes: Column) -> float:
    """The greatest acceleration [m/s²] from the direction of move k to that of the next that no axis exceeds.

    axes (3,) [m/s²]; so grbl has it.
    """
    size = 0.0
    for axis in range(3):
        step = moves.begin[k + 1, axis] - moves.end[k, axis]
        size += step * step
    size, least = math.sqrt(size), np.inf
    for axis in range(3):
        share = abs(moves.begin[k + 1, axis] - moves.end[k, axis])
        if share > 0.0:
            least = min(least, axes[axis] * size / share)
    return least


@kernel
def corner_speed(moves: Moves, k: int, deviation: float, is_klipper: bool, corners: JunctionLimits) -> float:
    """The greatest speed in the corner between moves k and k + 1 by junction deviation [m].

    The corner is passed on a circle that stays `deviation` away from it: v² = a d s / (1 - s) with s the sine of half
    the angle between the moves (Jeon 2011; grbl's `planner.c`, Marlin's `planner.cpp`, Klipper's `toolhead.py`).
    Klipper also keeps v² below a L tan / 2 of both moves, Marlin, but not the plain law of grbl, below a times the
    radius that short moves of a curve have.
    """
    cosine = 0.0
    for axis in range(3):
        cosine -= moves.end[k, axis] * moves.begin[k + 1, axis]
    if cosine < -STRAIGHT:
        return np.inf
    is_plain = corners.plain[k + 1] > 0.0
    if is_plain and cosine > STRAIGHT:  # it turns back
        return 0.0
    cosine = min(cosine, STRAIGHT)
    a = min(moves.acceleration[k], moves.acceleration[k + 1])
    if is_plain:
        a = across_corner(moves, k, corners.axes)
    sine = math.sqrt(0.5 * (1.0 - cosine))
    square = a * deviation * sine / (1.0 - sine)
    if is_klipper:
        tangent = sine / math.sqrt(max(0.5 * (1.0 + cosine), 1e-12))
        square = min(
            square,
            0.5
            * tangent
            * min(moves.length[k] * moves.acceleration[k], moves.length[k + 1] * moves.acceleration[k + 1]),
        )
    elif not is_plain and moves.length[k + 1] < SHORT and cosine < -math.sqrt(0.5):
        turn = acos(-cosine)
        square = min(square, moves.length[k + 1] / turn * a)
    return math.sqrt(square)


@kernel(short=True)
def junctions(rest: Column, moves: Moves, corners: JunctionLimits) -> Column:
    """The greatest speed (n,) [m/s] at the end of each move, 0 where `rest` (n,) says that it ends at rest."""
    n = len(rest)
    out = np.zeros(n)
    for k in range(n - 1):
        if rest[k]:
            continue
        speed = min(moves.speed[k], moves.speed[k + 1])
        corner, deviation = corners.corner[k + 1], corners.deviation[k + 1]
        jerk = corners.jerk[k + 1]
        if corner > 0.0:
            a = min(moves.acceleration[k], moves.acceleration[k + 1])
            deviation = corner * corner * (math.sqrt(2.0) - 1.0) / a
        if deviation > 0.0:
            speed = min(speed, corner_speed(moves, k, deviation, corner > 0.0, corners))
            change = abs(moves.end[k, 3] - moves.begin[k + 1, 3])
            if change * speed > jerk[3]:
                speed = jerk[3] / change
        else:
            speed *= step_factor(moves.end[k], moves.begin[k + 1], jerk, speed)
        out[k] = speed
    return out


@kernel(short=True)
def within_buffer(length: Column, acceleration: Column, junction: Column, buffer: Column) -> Column:
    """Speeds (n,) at the ends of moves from which the moves in the planner's buffer are enough to come to rest.

    `buffer` (n,) counts moves, the running one included: what follows the last of them is not known yet.
    """
    n = len(length)
    out = np.empty(n)
    for k in range(n):
        last = k + buffer[k] - 1
        square = 0.0
        if last >= n:
            out[k] = junction[k]
            continue
        for j in range(last, k, -1):
            square = square + 2.0 * acceleration[j] * length[j]
            if j - 1 > k:
                square = min(square, junction[j - 1] * junction[j - 1])
        out[k] = min(junction[k], math.sqrt(square))
    return out
