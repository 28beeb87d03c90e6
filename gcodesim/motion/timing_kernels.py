"""The time law along segments; arrays in and out."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column

MOMENT: Final = 0.01  # [s] in which LinuxCNC does not speed up and slow down again (`ARC_BLEND_RAMP_FREQ`, 100 Hz)


class PhaseColumns(NamedTuple):
    """Those columns of `trajectory.Phases` that say how it moves."""

    time: Column
    duration: Column
    piece: Column
    s: Column
    speed: Column
    acceleration: Column
    jerk: Column


@kernel(short=True)
def end_speeds(
    length: Column, speed: Column, acceleration: Column, junction: Column, ratio: Column, fixed: Column
) -> tuple[Column, Column]:
    """Greatest speeds (k,), (k,) at the start and end of every segment, from rest to rest.

    Backwards, what each segment can still be slowed down from; then forwards,
    what it can reach. The next segment starts with `ratio` times the end speed.
    A `fixed` segment begins and ends at rest.
    """
    n = len(length)
    start = np.zeros(n)
    end = np.zeros(n)
    after = 0.0
    for k in range(n - 1, -1, -1):
        if fixed[k]:
            after = 0.0
            continue
        v = min(min(junction[k], speed[k]), after / ratio[k])
        end[k] = v
        after = min(speed[k], math.sqrt(v * v + 2.0 * acceleration[k] * length[k]))
        start[k] = after
    before = 0.0
    for k in range(n):
        if fixed[k]:
            before = 0.0
            continue
        v = min(start[k], before)
        start[k] = v
        v = min(end[k], math.sqrt(v * v + 2.0 * acceleration[k] * length[k]))
        end[k] = v
        before = v * ratio[k]
    return start, end


@kernel(short=True)
def trapezoids(
    length: Column, speed: Column, acceleration: Column, start: Column, end: Column, fixed: Column, ramped: Column
) -> tuple[Column, Column, Column, Column, Column]:
    """Phases of constant acceleration: segment, duration, place in the segment, speed, acceleration (each (p,)).

    A `ramped` segment has one only if it takes less than `MOMENT` in that.
    """
    n = len(length)
    segment = np.empty(3 * n, dtype=np.int64)
    duration = np.empty(3 * n)
    place = np.empty(3 * n)
    v_start = np.empty(3 * n)
    a_phase = np.empty(3 * n)
    p = 0
    for k in range(n):
        v0, v1, a, s = start[k], end[k], acceleration[k], length[k]
        if fixed[k] or a * s <= 1e-12 * (v0 + v1) * (v0 + v1):  # too short, or not allowed, to change speed
            v = 1.0 if fixed[k] else 0.5 * (v0 + v1)
            segment[p], duration[p], place[p], v_start[p], a_phase[p] = k, s / v, 0.0, v, 0.0
            p += 1
            continue
        if ramped[k] and v1 > 0.0 and 2.0 * s < MOMENT * (v0 + v1):
            segment[p], duration[p], place[p], v_start[p] = k, 2.0 * s / (v0 + v1), 0.0, v0
            a_phase[p] = 0.5 * (v1 - v0) * (v1 + v0) / s
            p += 1
            continue
        peak = math.sqrt(0.5 * (v0 * v0 + v1 * v1) + a * s)
        top = max(min(peak, speed[k]), max(v0, v1))
        up = (top - v0) / a
        down = (top - v1) / a
        s_up = 0.5 * (v0 + top) * up
        s_down = 0.5 * (v1 + top) * down
        flat = max(s - s_up - s_down, 0.0) / top
        if up > 0.0:
            segment[p], duration[p], place[p], v_start[p], a_phase[p] = k, up, 0.0, v0, a
            p += 1
        if flat > 0.0:
            segment[p], duration[p], place[p], v_start[p], a_phase[p] = k, flat, s_up, top, 0.0
            p += 1
        if down > 0.0:
            segment[p], duration[p], place[p], v_start[p], a_phase[p] = k, down, s - s_down, top, -a
            p += 1
    return segment[:p].copy(), duration[:p].copy(), place[:p].copy(), v_start[:p].copy(), a_phase[:p].copy()


@kernel
def time_to(way: float, speed: float, change: float, jerk: float, duration: float) -> float:
    """When, within `duration`, a motion that goes only forwards has gone `way`; by bisection."""
    low, high = 0.0, duration
    for _ in range(80):
        t = 0.5 * (low + high)
        if t <= low or t >= high:
            break
        if t * (speed + t * (0.5 * change + jerk * t / 6.0)) < way:
            low = t
        else:
            high = t
    return high


@kernel(short=True)
def times_at(boundary_piece: Column, boundary_s: Column, phases: PhaseColumns) -> Column:
    """Times (b,) at which places (piece, s), given in order of motion, are reached; s infinite: the piece's end."""
    phase_time, phase_duration, phase_piece, phase_s, phase_speed, phase_acceleration, phase_jerk = phases
    out = np.empty(len(boundary_s))
    p = 0
    n = len(phase_piece)
    for b in range(len(boundary_s)):
        piece, s = boundary_piece[b], boundary_s[b]
        while p + 1 < n and (phase_piece[p + 1] < piece or (phase_piece[p + 1] == piece and phase_s[p + 1] <= s)):
            p += 1
        if phase_piece[p] < piece or s == np.inf:  # the piece has no phase, so it takes no time; or its end is asked
            out[b] = phase_time[p] + phase_duration[p]
            continue
        way = max(s - phase_s[p], 0.0)
        v, a = phase_speed[p], phase_acceleration[p]
        if phase_jerk[p] != 0.0:
            out[b] = phase_time[p] + time_to(way, v, a, phase_jerk[p], phase_duration[p])
            continue
        root = math.sqrt(max(v * v + 2.0 * a * way, 0.0))
        t = 2.0 * way / (v + root) if v + root > 0.0 else 0.0
        out[b] = phase_time[p] + min(t, phase_duration[p])
    return out
