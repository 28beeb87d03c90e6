"""Moves of one axis from rest to rest, with bounded jerk; numbers in and out.

Ramps are S-curves with at most seven phases in a move (Biagiotti, Melchiorri: Trajectory Planning, 2008, section 3.4).
"""

from __future__ import annotations

import math

import numpy as np

from gcodesim.arithmetic.root_kernels import cube_root
from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column


@kernel
def ramp_time(peak: float, acceleration: float, jerk: float) -> float:
    """Time from rest to the speed `peak`."""
    if peak >= acceleration * acceleration / jerk:
        return peak / acceleration + acceleration / jerk
    return 2.0 * math.sqrt(peak / jerk)


@kernel
def peak_speed(distance: float, speed: float, acceleration: float, jerk: float) -> float:
    """The greatest speed that is reached over `distance`, no more than `speed`."""
    if speed * ramp_time(speed, acceleration, jerk) <= distance:
        return speed
    swell = acceleration * acceleration / jerk  # the least peak of ramps with a phase of even acceleration
    even = 0.5 * (math.sqrt(swell * swell + 4.0 * acceleration * distance) - swell)
    return even if even >= swell else cube_root(0.25 * jerk * distance * distance)


@kernel
def on_ramp(t: float, peak: float, acceleration: float, jerk: float) -> tuple[float, float, float]:
    """Way, speed and acceleration at time `t` of the ramp from rest to `peak`."""
    ramp = ramp_time(peak, acceleration, jerk)
    most = min(acceleration, math.sqrt(peak * jerk))
    rise = most / jerk
    left = ramp - t
    if t < rise:
        return jerk * t * t * t / 6.0, 0.5 * jerk * t * t, jerk * t
    if left < rise:
        way = 0.5 * peak * ramp - peak * left + jerk * left * left * left / 6.0
        return way, peak - 0.5 * jerk * left * left, jerk * left
    middle = t - rise
    swept = 0.5 * jerk * rise * rise
    return jerk * rise * rise * rise / 6.0 + swept * middle + 0.5 * most * middle * middle, swept + most * middle, most


@kernel
def ramp_at(t: Column, peak: float, acceleration: float, jerk: float) -> tuple[Column, Column, Column]:
    """`on_ramp` for times `t` (n,)."""
    way, speed, change = np.empty(len(t)), np.empty(len(t)), np.empty(len(t))
    for i in range(len(t)):
        way[i], speed[i], change[i] = on_ramp(t[i], peak, acceleration, jerk)
    return way, speed, change


@kernel
def soft_travel(distance: float, speed: float, acceleration: float, jerk: float, t: float) -> tuple[float, float]:
    """Distance and speed at time `t` of the shortest move from rest to rest over `distance` > 0."""
    peak = peak_speed(distance, speed, acceleration, jerk)
    ramp = ramp_time(peak, acceleration, jerk)
    total = distance / peak + ramp
    if t >= total:
        return distance, 0.0
    left = total - t
    if t < ramp:
        way, v, _ = on_ramp(t, peak, acceleration, jerk)
        return way, v
    if left < ramp:
        way, v, _ = on_ramp(left, peak, acceleration, jerk)
        return distance - way, v
    return peak * (t - 0.5 * ramp), peak
