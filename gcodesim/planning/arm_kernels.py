"""Joint rates along a path and the caps that they set; arrays in and out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column

SMALLEST_PIVOT = 1e-9
BESIDE = 1.0 / 64.0
"""Of the bow of a rate: so much greater it may be than along the cubic through both ends, whose third derivative is the
same all along. Where that changes by all of itself, rates are L²/125 of it beside those of the cubic."""
EVEN = 3e-5
"""Of a rate, up to which a bow is none: less than a millionth is left of it."""


class SegmentRates(NamedTuple):
    """Joint rates q' (k, j) at the start and the end of each segment, and on average."""

    start: Column
    end: Column
    mean: Column


class JointCaps(NamedTuple):
    """Columns (k,), one row a segment: what joints allow.

    `wanted` is the speed that the program asks for; what the speed limits alone allow comes back in it.
    `speed` and `acceleration` are the caps, `joint` the one whose speed limit is nearest. `unresolved` is the greatest
    share of an acceleration limit by which q'' changes within half the segment at that speed.
    """

    wanted: Column
    speed: Column
    acceleration: Column
    joint: Column
    unresolved: Column


@kernel
def joint_rates(jacobian: Column, first: Column, last: Column) -> tuple[Column, Column]:
    """Joint rates (n, j) twice: for velocities `first` and `last` of the flange, (n, 3), or (n, 6) where it turns.

    Solves J q' = (v, w): by elimination where J is square; with more joints the shortest q', with fewer the one that
    comes nearest. A singular J gives rates that are finite and far beyond any limit.
    """
    n, j = jacobian.shape[0], jacobian.shape[2]
    out0, out1 = np.zeros((n, j)), np.zeros((n, j))
    m = min(j, 6)
    A = np.zeros((6, 6))
    b = np.zeros((6, 2))
    for i in range(n):
        J = jacobian[i]
        b[:, :] = 0.0
        for r in range(first.shape[1]):
            b[r, 0] = first[i, r]
            b[r, 1] = last[i, r]
        if j == 6:
            A[:, :] = J
        elif j < 6:
            for r in range(j):
                b[r, 0], b[r, 1] = 0.0, 0.0
                for k in range(first.shape[1]):
                    b[r, 0] += J[k, r] * first[i, k]
                    b[r, 1] += J[k, r] * last[i, k]
                for c in range(j):
                    total = 0.0
                    for k in range(6):
                        total += J[k, r] * J[k, c]
                    A[r, c] = total
                A[r, r] += 1e-12
        else:
            for r in range(6):
                for c in range(6):
                    total = 0.0
                    for k in range(j):
                        total += J[r, k] * J[c, k]
                    A[r, c] = total
                A[r, r] += 1e-12
        for c in range(m):
            best = c
            for r in range(c + 1, m):
                if abs(A[r, c]) > abs(A[best, c]):
                    best = r
            if best != c:
                for k in range(m):
                    A[c, k], A[best, k] = A[best, k], A[c, k]
                for k in range(2):
                    b[c, k], b[best, k] = b[best, k], b[c, k]
            if abs(A[c, c]) < SMALLEST_PIVOT:
                A[c, c] = SMALLEST_PIVOT
            for r in range(c + 1, m):
                f = A[r, c] / A[c, c]
                for k in range(c, m):
                    A[r, k] -= f * A[c, k]
                b[r, 0] -= f * b[c, 0]
                b[r, 1] -= f * b[c, 1]
        for r in range(m - 1, -1, -1):
            for k in range(r + 1, m):
                b[r, 0] -= A[r, k] * b[k, 0]
                b[r, 1] -= A[r, k] * b[k, 1]
            b[r, 0] /= A[r, r]
            b[r, 1] /= A[r, r]
        if j <= 6:
            out0[i] = b[:j, 0]
            out1[i] = b[:j, 1]
        else:
            for k in range(j):
                for r in range(6):
                    out0[i, k] += J[r, k] * b[r, 0]
                    out1[i, k] += J[r, k] * b[r, 1]
    return out0, out1


@kernel(lean=True)
def mean_rates(q: Column, ends: Column, length: Column, close: float, rates: SegmentRates) -> None:
    """Rates on average along segments of `length` (k,) that end at rows `ends` (k,) of q (n, j), into `rates`.

    Where one is no longer than `close` [m], joints differ by rounding; there they are the mean of those at both ends.
    """
    start, end, mean = rates
    for k in range(len(length)):
        at = ends[k]
        for j in range(q.shape[1]):
            if length[k] <= close:
                mean[k, j] = 0.5 * (start[k, j] + end[k, j])
            else:
                mean[k, j] = (q[at, j] - q[at - 1, j]) / length[k]


@kernel(lean=True)
def hold_rates(rates: SegmentRates, length: Column, straight: Column, close: float, steepest: float) -> None:
    """Keep the rates at the ends of segments of `length` (k,) near to those on average, in place.

    They are no more than `steepest` times the greatest mean of a segment and its two neighbours, unless it is shorter
    than `close` [m]; where a segment is run `straight` (k,), they are its mean.
    """
    start, end, mean = rates
    count = len(length)
    for k in range(count):
        before, after = max(k - 1, 0), min(k + 1, count - 1)
        for j in range(start.shape[1]):
            middle = mean[k, j]
            if straight[k]:
                start[k, j], end[k, j] = middle, middle
            elif length[k] > close:
                most = steepest * max(abs(middle), max(abs(mean[before, j]), abs(mean[after, j])))
                start[k, j] = min(max(start[k, j], -most), most)
                end[k, j] = min(max(end[k, j], -most), most)


@kernel(lean=True)
def kink_caps(
    rates: SegmentRates,
    end: Column,
    ratio: Column,
    here: Column,
    acceleration: Column,
    cycle: float,
    most: float,
    cap: Column,
    left: Column,
) -> None:
    """`Kinks.between`: lower `cap`, `left` (k,); steps take `most` of an acceleration (j,) at most in a `cycle` [s]."""
    start_rate, end_rate, _ = rates
    for k in range(len(here)):
        if here[k]:
            share = 0.0  # of the acceleration, for each m/s
            for j in range(len(acceleration)):
                step = abs(start_rate[k + 1, j] * ratio[k] - end_rate[k, j])
                share = max(share, step / acceleration[j])
            share /= cycle
            asked = share * end[k]
            if asked > most:
                cap[k] = most / share
            rest = 1.0 - min(asked, most)
            left[k], left[k + 1] = min(left[k], rest), min(left[k + 1], rest)


@kernel(lean=True)
def hurry_shares(
    length: Column, speed: Column, acceleration: Column, end: Column, rests: Column, shares: Column
) -> None:
    """How much of the `speed` squared that is allowed on a segment of `length` (k,) motion can have, into `shares`.

    From rest where a segment `rests` (k,) before it begins, and to rest before the next of these and at the end, it
    gains no more than `acceleration` (k,) allows, and passes the ends of segments at `end` (k,) at most.
    """
    count = len(length)
    square = 0.0
    for k in range(count):
        if rests[k]:
            square = 0.0
        shares[k] = square  # of speed, where the segment begins
        square = min(square + 2.0 * acceleration[k] * length[k], min(speed[k] * speed[k], end[k] * end[k]))
    square = 0.0
    for k in range(count - 1, -1, -1):
        if k + 1 < count and rests[k + 1]:
            square = 0.0
        elif k + 1 < count:
            square = min(square, end[k] * end[k])
        gain = 2.0 * acceleration[k] * length[k]
        begin = shares[k]
        most = speed[k] * speed[k]
        top = min(0.5 * (begin + square + gain), min(begin + gain, square + gain))
        shares[k] = min(top / max(most, 1e-300), 1.0)
        square = min(square + gain, min(most, begin))


@kernel
def greatest_rate(r0: float, r1: float, mean: float) -> float:
    """The greatest |q'| along a cubic that has rates `r0` and `r1` at its ends and `mean` on average."""
    most = max(abs(r0), abs(r1))
    middle = 3.0 * mean - r0 - r1  # q' is the parabola with these three control points
    bow = r0 - 2.0 * middle + r1
    if (r0 - middle) * bow > 0.0 and (r1 - middle) * bow > 0.0:  # its vertex lies inside
        most = max(most, abs(r0 * r1 - middle * middle) / abs(bow))
    return most


@kernel
def joint_caps(
    rates: SegmentRates,
    length: Column,
    bending_share: float,
    speed_limit: Column,
    acceleration_limit: Column,
    caps: JointCaps,
) -> None:
    """Caps of each segment of `length` (k,) under joint limits (j,), into `caps`.

    Joint acceleration is q' a + q'' v²: `bending_share` of the limit may go into the second term, the rest of it stays
    for a. q is the cubic that has the joints and the rates of both ends; its q'' at the ends is the difference of the
    rates over the length, and six times as much more or less as the mean rate lies beside that of both ends. A rate may
    be greater than along the cubic, by `BESIDE` of that.
    """
    start_rate, end_rate, mean_rate = rates
    for k in range(len(length)):
        v_rate, v_bend = 1e30, 1e30
        guilty = -1
        for j in range(start_rate.shape[1]):
            r0, r1, mean = start_rate[k, j], end_rate[k, j], mean_rate[k, j]
            bow = abs(6.0 * mean - 3.0 * (r0 + r1))
            rate = greatest_rate(r0, r1, mean)
            if bow > EVEN * rate:
                rate += BESIDE * bow
            if rate > 1e-12 and speed_limit[j] / rate < v_rate:
                v_rate = speed_limit[j] / rate
                guilty = j
            bend = (abs(r1 - r0) + bow) / length[k]
            if bend > 1e-12:
                v_bend = min(v_bend, math.sqrt(bending_share * acceleration_limit[j] / bend))
        v = min(caps.wanted[k], v_rate, v_bend)
        a, rough = 1e30, 0.0
        for j in range(start_rate.shape[1]):
            r0, r1, mean = start_rate[k, j], end_rate[k, j], mean_rate[k, j]
            change = abs(6.0 * mean - 3.0 * (r0 + r1)) / length[k] * v * v
            rough = max(rough, change / acceleration_limit[j])
            rate = greatest_rate(r0, r1, mean)
            if rate > 1e-12:
                left = acceleration_limit[j] - abs(r1 - r0) / length[k] * v * v - change
                a = min(a, left / rate)
        caps.wanted[k] = v_rate
        caps.speed[k] = v
        caps.acceleration[k] = min(caps.acceleration[k], a)
        caps.joint[k] = guilty
        caps.unresolved[k] = rough
