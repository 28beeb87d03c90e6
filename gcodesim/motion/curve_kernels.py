"""Points and tangents of curves; arrays and scalars in and out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.ramp_kernels import peak_speed, ramp_time, soft_travel

STRAIGHT = 0
ROUND = 1
TIMED = 2  # every axis runs as fast as it can from rest to rest; the parameter is time [s]
OWN = 3  # a law of its own, such as a move in joint space; the parameter is time [s], points are nominal: on a line

SPEED, ACCELERATION, JERK = 0, 1, 2  # rows of a table of axis limits (3, 6)
NO_JERK = 1e29  # from which on a limit of jerk is none


class CurveColumns(NamedTuple):
    """The columns of `curves.Curves`, which says what they mean."""

    kind: Column
    start: Column
    end: Column
    center: Column
    radial: Column
    sideways: Column
    lift: Column
    sweep: Column
    growth: Column
    length: Column


@kernel
def axis_time(distance: float, speed: float, acceleration: float, jerk: float) -> float:
    """How long the shortest move from rest to rest over `distance` >= 0 takes."""
    if jerk < NO_JERK and distance > 0.0:
        peak = peak_speed(distance, speed, acceleration, jerk)
        return distance / peak + ramp_time(peak, acceleration, jerk)
    if distance >= speed * speed / acceleration:
        return distance / speed + speed / acceleration
    return 2.0 * math.sqrt(distance / acceleration)  # never reaches full speed


@kernel(short=True)
def longest_times(distance: Column, axis_limits: Column) -> Column:
    """How long the slowest axis takes from rest to rest for each row of `distance` (n, 6)."""
    out = np.zeros(len(distance))
    for i in range(len(distance)):
        for k in range(6):
            speed, acceleration = axis_limits[SPEED, k], axis_limits[ACCELERATION, k]
            out[i] = max(out[i], axis_time(distance[i, k], speed, acceleration, axis_limits[JERK, k]))
    return out


@kernel
def axis_travel(distance: float, speed: float, acceleration: float, jerk: float, t: float) -> tuple[float, float]:
    """Distance and speed at time `t` of the shortest move from rest to rest over `distance` >= 0."""
    if distance <= 0.0:
        return 0.0, 0.0
    if jerk < NO_JERK:
        return soft_travel(distance, speed, acceleration, jerk, t)
    ramp = speed / acceleration
    if speed * ramp >= distance:  # never reaches full speed
        ramp = math.sqrt(distance / acceleration)
        total = 2.0 * ramp
    else:
        total = distance / speed + ramp
    if t >= total:
        return distance, 0.0
    if t < ramp:
        return 0.5 * acceleration * t * t, acceleration * t
    left = total - t
    if left < ramp:
        return distance - 0.5 * acceleration * left * left, acceleration * left
    return acceleration * ramp * (t - 0.5 * ramp), acceleration * ramp


@kernel
def curve_point(i: int, s: float, curves: CurveColumns, axis_limits: Column, position: Column, tangent: Column) -> None:
    """Write position (6,) and derivative by s (6,) of curve `i` at `s` into the last two arguments."""
    kind, start, end, center, radial, sideways, lift, sweep, growth, length = curves
    if kind[i] == TIMED:
        for k in range(6):
            step = end[i, k] - start[i, k]
            limit = axis_limits[:, k]
            done, speed = axis_travel(abs(step), limit[SPEED], limit[ACCELERATION], limit[JERK], s)
            sign = 1.0 if step >= 0.0 else -1.0
            position[k] = start[i, k] + sign * done
            tangent[k] = sign * speed
        return
    u = s / length[i]
    per = 1.0 / length[i]
    first = 0
    if kind[i] == ROUND:
        first = 3
        angle = sweep[i] * u
        c, sn = cos_sin(angle)
        size = 1.0 + growth[i] * u
        for k in range(3):
            out = c * radial[i, k] + sn * sideways[i, k]
            along = -sn * radial[i, k] + c * sideways[i, k]
            position[k] = center[i, k] + size * out + u * lift[i, k]
            tangent[k] = per * (sweep[i] * size * along + growth[i] * out + lift[i, k])
    for k in range(first, 6):
        position[k] = start[i, k] + u * (end[i, k] - start[i, k])
        tangent[k] = per * (end[i, k] - start[i, k])
