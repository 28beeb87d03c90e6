"""The fastest way along a path of joints under limits of speed and acceleration; arrays in and out.

Reachability analysis: H. Pham and Q.-C. Pham, "A New Approach to Time-Optimal Path Parameterization Based on
Reachability Analysis", IEEE Transactions on Robotics 34(3), 2018, algorithm 1. With x = s'² and u = s'' the joints have
q'' = dq/ds u + d²q/ds² x; between two grid points u is constant, so x changes by 2 u ds. All joints may rest anywhere,
so that the set of controllable x is an interval from 0, and only its upper end is looked for.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column

FLAT = 1e-12  # of dq/ds, below which u does not move a joint
ROUNDS = 64  # of the search for the greatest x; it ends after three or four


class Bounds(NamedTuple):
    """At a grid point u is between -`above` - `slope` x and `above` - `slope` x, (2 j) of each.

    The second half of the lines are those of the next grid point, where x has changed by 2 u ds.
    """

    above: Column
    slope: Column


@kernel
def lines_at(
    first: Column, second: Column, limit: Column, point: int, step: float, half: int, lines: Bounds, most: float
) -> float:
    """Write the lines of joints at grid `point`, seen from `step` before it, into their `half`; the greatest x.

    There dq/ds u + d²q/ds² (x + 2 u step) is within the `limit` (j,) of acceleration.
    """
    count = first.shape[1]
    for j in range(count):
        bend = second[point, j]
        rate = first[point, j] + 2.0 * step * bend
        at = half * count + j
        if abs(rate) > FLAT:
            lines.above[at] = limit[j] / abs(rate)
            lines.slope[at] = bend / rate
        else:
            lines.above[at] = 1e300
            lines.slope[at] = 0.0
            if abs(bend) > FLAT:
                most = min(most, limit[j] / abs(bend))
    return most


@kernel
def greatest_speed(lines: Bounds, most: float, step: float, end: float) -> float:
    """The greatest x up to `most` from which some u within the lines leads to an x from 0 to `end` behind the `step`.

    The room between the upper and the lower lines is concave in x. Where it is negative, the two lines that make it so
    cross at a smaller x, behind which there is none either: steps of Newton from the right, which end at the root.
    """
    x = most
    for _ in range(ROUNDS):
        high, high_slope = (end - x) / (2.0 * step), -0.5 / step
        low, low_slope = -x / (2.0 * step), -0.5 / step
        for k in range(len(lines.above)):
            slope = lines.slope[k]
            top, bottom = lines.above[k] - slope * x, -lines.above[k] - slope * x
            if top < high:
                high, high_slope = top, -slope
            if bottom > low:
                low, low_slope = bottom, -slope
        room = high - low
        if room >= -1e-12 * (abs(high) + abs(low)):
            return x
        change = high_slope - low_slope
        if change >= 0.0:
            return 0.0
        x = max(x - room / change, 0.0)
    return x


@kernel
def fastest(place: Column, first: Column, second: Column, most: Column, limit: Column, reach: Column) -> None:
    """x = s'² (n,) into `reach`, from rest to rest along `place` s (n,) with dq/ds and d²q/ds² (n, j) there.

    x is at `most` (n,). The `limit` (j,) of the acceleration of joints is kept at both ends of each step between two
    grid points.
    """
    n, count = first.shape
    lines = Bounds(np.empty(2 * count), np.empty(2 * count))
    reach[n - 1] = 0.0
    for i in range(n - 2, -1, -1):
        step = place[i + 1] - place[i]
        top = lines_at(first, second, limit, i, 0.0, 0, lines, most[i])
        top = lines_at(first, second, limit, i + 1, step, 1, lines, top)
        reach[i] = greatest_speed(lines, top, step, reach[i + 1])
    x = 0.0
    for i in range(n - 1):
        reach[i] = x
        step = place[i + 1] - place[i]
        lines_at(first, second, limit, i, 0.0, 0, lines, 1e300)
        lines_at(first, second, limit, i + 1, step, 1, lines, 1e300)
        high = (reach[i + 1] - x) / (2.0 * step)
        for k in range(2 * count):
            high = min(high, lines.above[k] - lines.slope[k] * x)
        x = min(max(x + 2.0 * step * high, 0.0), reach[i + 1])
    reach[n - 1] = 0.0


@kernel
def seconds_along(place: Column, reach: Column, times: Column) -> None:
    """When each grid point is passed [s], into `times` (n,), with x (n,) there."""
    times[0] = 0.0
    for i in range(len(place) - 1):
        pace = math.sqrt(reach[i]) + math.sqrt(reach[i + 1])
        times[i + 1] = times[i] + 2.0 * (place[i + 1] - place[i]) / max(pace, 1e-12)
