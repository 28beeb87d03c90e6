"""The time law under jerk: arrays in and out.

Speeds along a trapezoid law, averaged over a window of time, change with bounded jerk: the average over T of a motion
s(t) has the acceleration (v(t) − v(t − T)) / T and the jerk (a(t) − a(t − T)) / T. Within the window the motion passes
places on both sides of where its average is; caps are therefore widened by as much as it can go in that time, so that
the average keeps every cap wherever it is. (A moving average as filter of trajectories: Biagiotti, Melchiorri: FIR
filters for online trajectory planning with time- and frequency-domain specifications, 2012.)
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.root_kernels import cube_root
from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column
from gcodesim.motion.timing_kernels import end_speeds, time_to, trapezoids

SHORTEST: Final = 1e-13  # [s, m] of a phase, or of a place beside a border, that counts
TRIES: Final = 8  # rounds in which tops are lowered
FLAT: Final = 1e-9  # [-] change of speed within a phase that is rounding: no slope
NO_CAP: Final = 1e30
PIECE, PLACE, SPEED, CHANGE, JERK, DURATION = 0, 1, 2, 3, 4, 5  # columns of phases


class SoftCaps(NamedTuple):
    """Columns (k,) of the caps of segments: `junction` is that of the speed at its end, `fixed` takes its own time.

    `calm` and `push` are jerk and acceleration allowed while its end is passed.
    """

    piece: Column
    begin: Column
    length: Column
    speed: Column
    acceleration: Column
    jerk: Column
    junction: Column
    calm: Column
    push: Column
    fixed: Column


class SpanLaw(NamedTuple):
    """A trapezoid law over one span: (p,) columns of its phases, in place, speed, acceleration and duration."""

    place: Column
    speed: Column
    acceleration: Column
    duration: Column


@kernel
def widest_window(caps: SoftCaps, first: int, end: int) -> float:
    """The window [s] of the span of segments from `first` up to `end`: as long as full acceleration takes to build up.

    Less where the span is too short, or too slow, to reach it.
    """
    way, build, jerk, top = 0.0, 0.0, 0.0, 0.0
    for k in range(first, end):
        length, j = caps.length[k], caps.jerk[k]
        way += length
        build += length * caps.acceleration[k] / j
        jerk += length * j
        top = max(top, caps.speed[k])
    if way <= 0.0 or build <= 0.0:
        return 1e-3
    jerk /= way
    return min(build / way, min(math.sqrt(top / jerk), cube_root(0.5 * way / jerk)))


@kernel
def free_cell(after: Column, cell: int) -> int:
    """The first cell from `cell` on that is not painted; paths in `after` are halved on the way."""
    while after[cell] != cell:
        after[cell] = after[after[cell]]
        cell = after[cell]
    return cell


@kernel
def least_caps(begin: Column, end: Column, cap: Column, knots: Column) -> Column:
    """The least `cap` of all zones from `begin` to `end` (z,), in every cell between sorted `knots`."""
    cells = len(knots) - 1
    out = np.full(cells, NO_CAP)
    after = np.arange(cells + 1)
    for z in np.argsort(cap):
        last = np.searchsorted(knots, end[z])
        cell = free_cell(after, np.searchsorted(knots, begin[z]))
        while cell < last:
            out[cell] = cap[z]
            after[cell] = cell + 1
            cell = free_cell(after, cell)
    return out


@kernel
def law_of(begin: Column, end: Column, speed: Column, acceleration: Column) -> SpanLaw:
    """The fastest trapezoid law from rest to rest under the caps of zones (z,), from their least place to the last."""
    both = np.sort(np.concatenate((begin, end)))
    kept = np.empty(len(both))
    n = 0
    for x in both:
        if n == 0 or x > kept[n - 1]:
            kept[n] = x
            n += 1
    knots = kept[:n].copy()
    v, a = least_caps(begin, end, speed, knots), least_caps(begin, end, acceleration, knots)
    length = np.diff(knots)
    none, ones, moving = np.full(n - 1, NO_CAP), np.ones(n - 1), np.zeros(n - 1, dtype=np.bool_)
    v0, v1 = end_speeds(length, v, a, none, ones, moving)
    cell, duration, place, rate, change = trapezoids(length, v, a, v0, v1, moving, moving)
    for p in range(len(cell)):
        place[p] += knots[cell[p]]
    return SpanLaw(place, rate, change, duration)


@kernel
def next_top(law: SpanLaw, p: int, window: float) -> tuple[int, int, float]:
    """From phase `p` on: phases before and behind the next top that is left again within the window, and its time.

    −1, −1: there is none.
    """
    up, even = -1, 0.0
    for k in range(p, len(law.place)):
        a = law.acceleration[k]
        if abs(a) * law.duration[k] <= FLAT * law.speed[k]:
            even += law.duration[k]
        elif a > 0.0:
            up, even = k, 0.0
        elif up >= 0:
            if even < window * (1.0 - 1e-9):
                return up, k, even
            up = -1
    return -1, -1, 0.0


@kernel
def lowered_tops(law: SpanLaw, window: float, zones: Column) -> int:
    """Zones (z, 3), from, to, speed, that keep the law even at its tops for as long as the window; their number."""
    count, p = 0, 0
    while True:
        up, down, even = next_top(law, p, window)
        if up < 0:
            return count
        a0, a1 = law.acceleration[up], -law.acceleration[down]
        top = law.speed[up] + a0 * law.duration[up]
        half = 0.5 / a0 + 0.5 / a1
        low = (math.sqrt(window * window + 4.0 * half * (half * top * top + even * top)) - window) / (2.0 * half)
        low = min(low, top)
        spare = top * top - low * low
        if count < len(zones):
            zones[count, 0] = law.place[down] - even * top - 0.5 * spare / a0
            zones[count, 1] = law.place[down] + 0.5 * spare / a1
            zones[count, 2] = low
            count += 1
        p = down


@kernel
def span_law(caps: SoftCaps, first: int, end: int, window: float, share: float, cycle: float) -> tuple[SpanLaw, bool]:
    """The trapezoid law of a span, whose average over `window` keeps all caps; whether its tops are long enough.

    Accelerations are at most what jerk builds up within `share` of the window. The average passes a border calmly if
    the law does so for the window, and the control cycles beside it in which the border is felt.
    """
    n = end - first
    begin, stop = np.empty(2 * n), np.empty(2 * n)
    speed, change = np.empty(2 * n), np.empty(2 * n)
    at = 0.0
    for k in range(n):
        v, j = caps.speed[first + k], caps.junction[first + k]
        begin[k], speed[k] = at - v * window, v
        change[k] = min(caps.acceleration[first + k], caps.jerk[first + k] * window * share)
        at += caps.length[first + k]
        stop[k] = at + v * window
        point = min(j, v) * (window + 2.0 * cycle)
        begin[n + k], stop[n + k] = at - point, at + point
        speed[n + k], change[n + k] = min(j, v), min(caps.push[first + k], caps.calm[first + k] * window * share)
    for z in range(2 * n):
        begin[z], stop[z] = min(max(begin[z], 0.0), at), min(max(stop[z], 0.0), at)
    speed[2 * n - 1] = NO_CAP  # the end is at rest anyway
    law = law_of(begin, stop, speed, change)
    if share < 1.0:
        return law, True
    found = np.empty((len(law.place) + 1, 3))
    for _ in range(TRIES):
        more = lowered_tops(law, window, found)
        if more == 0:
            return law, True
        begin = np.concatenate((begin, np.maximum(found[:more, 0], 0.0)))
        stop = np.concatenate((stop, np.minimum(found[:more, 1], at)))
        speed = np.concatenate((speed, found[:more, 2]))
        change = np.concatenate((change, np.full(more, NO_CAP)))
        law = law_of(begin, stop, speed, change)
        if len(found) <= len(law.place):
            found = np.empty((len(law.place) + 1, 3))
    return law, next_top(law, 0, window)[0] < 0


@kernel
def averaged(law: SpanLaw, window: float, caps: SoftCaps, first: int, end: int, out: Column, count: int) -> int:
    """Write the phases of the average of a law over `window` into `out` from `count` on, cut where pieces end.

    Returns how many there are then; −1: `out` has no room.
    """
    p = len(law.place)
    time = np.zeros(p + 1)
    for k in range(p):
        time[k + 1] = time[k] + law.duration[k]
    total = 0.0
    for k in range(first, end):
        total += caps.length[k]
    segment = first
    while segment + 1 < end and caps.piece[segment + 1] == caps.piece[first]:
        segment += 1
    border, begun = 0.0, -caps.begin[first]
    for k in range(first, segment + 1):
        border += caps.length[k]
    early, late, t, x = 0, -1, 0.0, 0.0  # the phases of t and of t - window; p: behind the last one
    while early < p or late < p:
        until = time[early + 1] if early < p else NO_CAP
        behind = time[late + 1] + window if late < p else NO_CAP
        then = min(until, behind)
        dt = then - t
        if dt > 0.0:
            s0, v0, a0 = total, 0.0, 0.0
            if early < p:
                tau, a0 = t - time[early], law.acceleration[early]
                s0 = law.place[early] + tau * (law.speed[early] + 0.5 * a0 * tau)
                v0 = law.speed[early] + a0 * tau
            s1, v1, a1 = 0.0, 0.0, 0.0
            if late >= 0:
                if late < p:
                    tau, a1 = t - window - time[late], law.acceleration[late]
                    s1 = law.place[late] + tau * (law.speed[late] + 0.5 * a1 * tau)
                    v1 = law.speed[late] + a1 * tau
                else:
                    s1 = total
            v, a, j = max((s0 - s1) / window, 0.0), (v0 - v1) / window, (a0 - a1) / window
            while dt > 0.0:
                piece = caps.piece[segment]
                gone = dt * (v + dt * (0.5 * a + j * dt / 6.0))
                part = dt
                last = segment + 1 >= end
                if not last and x + gone >= border:
                    part = time_to(border - x, v, a, j, dt)
                if part > SHORTEST:
                    if count >= len(out):
                        return -1
                    out[count, PIECE], out[count, PLACE] = piece, x - begun
                    out[count, SPEED], out[count, CHANGE], out[count, JERK] = v, a, j
                    out[count, DURATION] = part
                    count += 1
                x += part * (v + part * (0.5 * a + j * part / 6.0))
                v = max(v + part * (a + 0.5 * j * part), 0.0)
                a += j * part
                dt -= part
                if not last and x >= border - SHORTEST:
                    begun = border
                    segment += 1
                    border += caps.length[segment]
                    while segment + 1 < end and caps.piece[segment + 1] == caps.piece[segment]:
                        segment += 1
                        border += caps.length[segment]
                    x = max(x, begun)
        t = then
        if until <= then:
            early += 1
        if behind <= then:
            late += 1
    return count


@kernel
def soft_law(caps: SoftCaps, cycle: float) -> Column:
    """Phases (p, 6) of constant jerk under all caps, from rest to rest wherever a junction or a fixed segment asks."""
    n = len(caps.length)
    out = np.empty((16 * n + 64, 6))
    count, first = 0, 0
    while first < n:
        if caps.fixed[first]:
            if count >= len(out):
                out = np.concatenate((out, np.empty_like(out)))
            out[count, PIECE], out[count, PLACE], out[count, SPEED] = caps.piece[first], 0.0, 1.0
            out[count, CHANGE], out[count, JERK], out[count, DURATION] = 0.0, 0.0, caps.length[first]
            count += 1
            first += 1
            continue
        end = first + 1
        while end < n and not caps.fixed[end] and caps.junction[end - 1] > 0.0:
            end += 1
        window = widest_window(caps, first, end)
        law, good = span_law(caps, first, end, window, 1.0, cycle)
        if not good:  # with twice the window even a change from full push to full brake keeps the jerk
            window *= 2.0
            law, good = span_law(caps, first, end, window, 0.5, cycle)
        more = averaged(law, window, caps, first, end, out, count)
        while more < 0:
            out = np.concatenate((out, np.empty_like(out)))
            more = averaged(law, window, caps, first, end, out, count)
        count = more
        first = end
    return out[:count].copy()
