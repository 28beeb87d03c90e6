"""Joints between curves: which are passed, rounded or overlapped; arrays and scalars in and out."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.motion.columns import Column

# Habits of the motion planner, as numbers with names. They are those of LinuxCNC 2.9, measured on its own planner.
# The two shares on arcs belong to any planner that keeps acceleration back in bends; the others are this one's own
# and decide between 5 % and 1 % of time.

# Share of the acceleration that bends the path on arcs and corner arcs: sqrt(3)/2, so half of it is left along it.
NORMAL_SHARE: Final = 3.0**0.5 / 2.0
# Share along the path where the normal share is used up.
TANGENTIAL_SHARE: Final = 0.5
# A step of direction is passed at the speed where it asks for this share of the acceleration within one cycle;
# the blocks at both sides then do with the rest.
KINK_SHARE: Final = 0.1
CYCLE: Final = 1e-3  # [s]
# The last block before the queue runs empty in G64, and blocks that overlap, use this share, in both their ramps.
OPEN_END_SHARE: Final = 0.5
# G64 without P rounds corners within this share of the shorter block.
TOLERANCE_SHARE: Final = 0.25
# A corner sharper than this angle to a full reversal gets no arc [rad].
SHARPEST_CORNER: Final = 0.02
# Chords that are merged into one line.
LONGEST_CHAIN: Final = 100

# what happens at the end of a curve
STAND = 0
PASS = 1
ROUNDED = 2
OVERLAPPED = 3


@kernel
def merge_chords(start: Column, end: Column, joined: Column, tolerance: Column) -> Column:
    """For each row (n,) the first row of the chain it belongs to.

    Row i may continue the chain when `joined[i]`; it does while all points
    passed by lie within `tolerance` [m] of the straight line from the chain's
    start to the new end.
    """
    n = len(joined)
    first = np.arange(n)
    for i in range(1, n):
        head = first[i - 1]
        if not joined[i] or i - head > LONGEST_CHAIN:
            continue
        m0 = end[i, 0] - start[head, 0]
        m1 = end[i, 1] - start[head, 1]
        m2 = end[i, 2] - start[head, 2]
        square = m0 * m0 + m1 * m1 + m2 * m2
        if square == 0.0:
            continue
        limit = tolerance[i] * tolerance[i]
        fits = True
        for j in range(i - 1, head - 1, -1):
            p0 = end[j, 0] - start[head, 0]
            p1 = end[j, 1] - start[head, 1]
            p2 = end[j, 2] - start[head, 2]
            t = min(max((m0 * p0 + m1 * p1 + m2 * p2) / square, 0.0), 1.0)
            d0, d1, d2 = p0 - t * m0, p1 - t * m1, p2 - t * m2
            if d0 * d0 + d1 * d1 + d2 * d2 > limit:
                fits = False
                break
        if fits:
            first[i] = head
    return first


@kernel
def in_plane(n0: float, n1: float, n2: float, limits: Column) -> float:
    """The greatest length that a vector of any direction in the plane with unit normal n may have.

    The circle inscribed in the box of `limits` cut by the plane: a direction in
    the plane has at most sqrt(1 - n_i²) of its length along axis i.
    """
    best = 1e30
    for limit, n in ((limits[0], n0), (limits[1], n1), (limits[2], n2)):
        share = math.sqrt(max(1.0 - n * n, 0.0))
        if share > 1e-6:
            best = min(best, limit / share)
    return best


@kernel
def turned_speed(first: Column, turned: Column, angle: float, limits: Column) -> float:
    """The greatest speed in all directions cos(w) first + sin(w) turned (3,), unit vectors, w from 0 to `angle`."""
    best = 1e30
    for k in range(3):
        share = max(abs(first[k]), abs(math.cos(angle) * first[k] + math.sin(angle) * turned[k]))
        peak = math.atan2(turned[k], first[k])  # where the component is greatest; or least, half a turn away
        if peak < 0.0:
            peak += math.pi
        if peak < angle:
            share = math.sqrt(first[k] * first[k] + turned[k] * turned[k])
        if share > 1e-12:
            best = min(best, limits[k] / share)
    return best


@kernel
def corners(
    stop: Column,
    blended: Column,
    first: Column,
    last: Column,
    length: Column,
    straight: Column,
    turning: Column,
    speed: Column,
    tolerance: Column,
    axis_limits: Column,
    kind: Column,
    trim_end: Column,
    trim_start: Column,
    cap: Column,
    acceleration: Column,
    reduction: Column,
) -> None:
    """Decide what happens at the end of every curve but the last; results go into the last six arguments.

    `first`, `last` (c, 6) are unit tangents, `turning` is set where a rotary
    axis moves, `speed` is what each curve may reach. Corner arcs touch both
    lines at `trim_end[i]` before and `trim_start[i + 1]` behind the corner; with
    half included angle t, R = P sin t / (1 - sin t) and trim R / tan t.
    `reduction` is the share of acceleration lost to a kink.
    """
    across = np.empty(3)
    for i in range(len(stop) - 1):
        kind[i] = STAND
        cap[i] = 0.0
        if stop[i]:
            continue
        if turning[i] or turning[i + 1]:
            if blended[i]:
                kind[i] = OVERLAPPED
            continue
        kink = 0.0
        for k in range(6):
            kink = max(kink, abs(first[i + 1, k] - last[i, k]) / axis_limits[1, k])
        kink /= CYCLE  # share of acceleration for each m/s
        reach = max(speed[i], speed[i + 1])
        if kink * reach <= KINK_SHARE:
            kind[i] = PASS
            cap[i] = 1e30
            reduction[i] = max(reduction[i], kink * reach)
            reduction[i + 1] = max(reduction[i + 1], kink * reach)
            continue
        kink_speed = KINK_SHARE / kink
        if blended[i]:
            kind[i] = OVERLAPPED
            cosine = 0.0
            for k in range(3):
                cosine += last[i, k] * first[i + 1, k]
            turn = math.acos(min(max(cosine, -1.0), 1.0))
            if straight[i] and straight[i + 1] and turn < math.pi - SHARPEST_CORNER:
                half = 0.5 * (math.pi - turn)
                n0 = last[i, 1] * first[i + 1, 2] - last[i, 2] * first[i + 1, 1]
                n1 = last[i, 2] * first[i + 1, 0] - last[i, 0] * first[i + 1, 2]
                n2 = last[i, 0] * first[i + 1, 1] - last[i, 1] * first[i + 1, 0]
                size = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
                n0, n1, n2 = n0 / size, n1 / size, n2 / size
                most = in_plane(n0, n1, n2, axis_limits[1])
                a_n = NORMAL_SHARE * most
                p1 = tolerance[i] if tolerance[i] > 0.0 else TOLERANCE_SHARE * length[i]
                p2 = tolerance[i + 1] if tolerance[i + 1] > 0.0 else TOLERANCE_SHARE * length[i + 1]
                s, tan = math.sin(half), math.tan(half)
                radius = min(p1, p2) * s / (1.0 - s) if s < 1.0 else 1e30
                radius = min(radius, tan * 0.5 * min(length[i], length[i + 1]))
                for k in range(3):
                    across[k] = (first[i + 1, k] - math.cos(turn) * last[i, k]) / math.sin(turn)
                v = min(reach, turned_speed(last[i], across, turn, axis_limits[0]), math.sqrt(a_n * radius))
                if v > kink_speed:
                    radius = v * v / a_n  # not larger than the speed needs
                    kind[i] = ROUNDED
                    trim_end[i] = radius / tan
                    trim_start[i + 1] = radius / tan
                    cap[i] = v
                    acceleration[i] = most
                    continue
                kind[i] = PASS
        else:
            kind[i] = PASS
        if kind[i] == PASS:
            cap[i] = kink_speed
            reduction[i] = KINK_SHARE
            reduction[i + 1] = KINK_SHARE


@kernel
def overlaps(
    kind: Column,
    first: Column,
    last: Column,
    left: Column,
    speed: Column,
    acceleration: Column,
    tolerance: Column,
    trim_end: Column,
    trim_start: Column,
    cap: Column,
    ratio: Column,
    duration: Column,
) -> None:
    """Fill the last five columns where the end of a curve overlaps with the start of the next.

    `left` is what corner arcs leave of each curve, `acceleration` already the
    share that such blocks have. Both ramps last T; the corner is missed by
    v² cos t / (4 a), with half included angle t, which P limits.
    """
    for i in range(len(kind) - 1):
        if kind[i] != OVERLAPPED:
            continue
        a1, a2 = acceleration[i], acceleration[i + 1]
        v1 = min(speed[i], math.sqrt(a1 * left[i]))
        v2 = min(speed[i + 1], math.sqrt(a2 * left[i + 1]))
        ramp = min(min(left[i] / v1, left[i + 1] / v2), max(v1 / a1, v2 / a2))
        v1, v2 = min(v1, ramp * a1), min(v2, ramp * a2)
        if tolerance[i] > 0.0:
            cosine = 0.0
            for k in range(3):
                cosine += last[i, k] * first[i + 1, k]
            sharp = math.sqrt(max(0.5 * (1.0 - cosine), 0.0))  # cosine of half the included angle
            if sharp > 1e-3:
                most = 2.0 * math.sqrt(a1 * tolerance[i] / sharp)
                v1, v2 = min(v1, most), min(v2, most)
        ramp = v1 / a1
        v2 = min(v2, a2 * ramp)
        duration[i] = ramp
        cap[i] = v1
        ratio[i] = v2 / v1
        trim_end[i] = 0.5 * v1 * ramp
        trim_start[i + 1] = 0.5 * v2 * ramp
