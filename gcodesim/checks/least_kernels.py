"""The least gap of a pair of bodies between two places of a joint path: how deep they come in each other, or how near.

Stretches of the path are divided as long as something less than what is known may lie on them (branch and bound). What
is left, one stretch and one couple of convex bodies, is bounded by the gaps along the directions in which the bodies
are to be parted at either end: the gap is above both of them, and each is above its chord but for what the bodies'
acceleration allows. Where the chords cross is looked at next (supporting planes, Kelley 1960, J. SIAM 8, 703).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.checks.contact_kernels import FEW, SHORTEST
from gcodesim.checks.descent_kernels import begin, convexes_at, descend
from gcodesim.checks.gap_kernels import Ints, gap_along, signed_gap
from gcodesim.checks.search_kernels import (
    PairSearch,
    is_above,
    look_at,
    look_between,
    range_of,
    swing_about,
)
from gcodesim.checks.way_kernels import acceleration_of, place_at
from gcodesim.compiled import kernel
from gcodesim.frames import Array

DEEPEST = 64  # divisions of a way into stretches
PARTS = 128  # divisions of a stretch
SIDE = 0.15  # of a part: a division is no nearer to its ends
SHORT = 1e-7  # of a stretch: parts are not divided any more
FIRST, LAST, AT_FIRST, AT_LAST, FROM_FIRST, FROM_LAST = 0, 1, 2, 3, 4, 7
"""Columns of a part: the shares at its ends, the gaps [m] there, and the directions (3,) in which these lie."""


class Least(NamedTuple):
    """The least gap (1,) [m] so far, its `stretch` (1,) and its `share` (1,) of that.

    It is found to `exact` (2,): [m], and a share of itself. The rest is room: intervals of stretches with what gaps are
    not below there, parts of a stretch, couples of convex bodies with the gaps (k,) [m] where they were seen.
    """

    gap: Array
    share: Array
    stretch: Ints
    exact: Array
    intervals: Ints
    bounds: Array
    parts: Array
    couples: Ints
    seen: Array


def least_room(tolerance: float, relative: float) -> Least:
    """With no gap known yet, which is to be found to `tolerance` [m] and a `relative` share of itself."""
    return Least(
        np.full(1, np.inf),
        np.zeros(1),
        np.zeros(1, dtype=np.int64),
        np.array([tolerance, relative]),
        np.zeros((2 * DEEPEST, 2), dtype=np.int64),
        np.zeros(2 * DEEPEST),
        np.zeros((PARTS, 10)),
        np.zeros((FEW, 2), dtype=np.int64),
        np.zeros(FEW),
    )


@kernel
def floor_of(least: Least) -> float:
    """The gap [m] from which on nothing counts beside the least so far."""
    gap: float = least.gap[0]
    return gap - least.exact[0] - least.exact[1] * abs(gap) if gap < math.inf else gap


@kernel
def keep(gap: float, k: int, share: float, least: Least) -> None:
    """Keep a gap that is less than the least so far."""
    if gap < least.gap[0]:
        least.gap[0], least.stretch[0], least.share[0] = gap, k, share


@kernel
def least_below(p: int, limit: float, search: PairSearch) -> float:
    """The gap [m] of a pair where it is looked at, if that is less than `limit`; else `limit`."""
    descent = search.descent
    top, here = begin(search.roots[p], descent), limit
    while True:
        top = descend(top, here, search.forest, search.bodies, descent)
        if top < 0:
            return here
        a, b = convexes_at(top, search.forest, descent)
        gap = signed_gap(a, b, search.bodies, descent.Xa, descent.Xb, here, search.gaps, search.room.n)
        here = min(here, gap)
        top -= 1


@kernel
def gap_here(p: int, limit: float, search: PairSearch, least: Least) -> float:
    """`least_below`; of bodies known to meet first of depths like the greatest so far: few couples can be as deep."""
    if least.gap[0] < 0.0:
        for low in (0.5 * least.gap[0], 0.0):
            here = least_below(p, min(low, limit), search)
            if here < min(low, limit):
                return here
    return least_below(p, limit, search)


@kernel
def is_clear(p: int, stretches: tuple[int, int], floor: float, limit: float, search: PairSearch) -> bool:
    """Whether a pair is above `floor` [m] on all of some stretches, as one direction for each of few couples shows.

    Couples of convex bodies that are `limit` [m] apart where they are looked at do not count.
    """
    descent, room = search.descent, search.room
    top, count = begin(search.roots[p], descent), 0
    while True:
        top = descend(top, limit, search.forest, search.bodies, descent)
        if top < 0:
            return True
        a, b = convexes_at(top, search.forest, descent)
        if signed_gap(a, b, search.bodies, descent.Xa, descent.Xb, limit, search.gaps, room.n) < limit:
            count += 1
            if count > FEW or not is_above(p, (a, b), stretches, floor, search):
                return False
        top -= 1


@kernel
def bound_on(p: int, stretches: tuple[int, int], search: PairSearch, least: Least) -> float:
    """A gap [m] below which that of a pair is nowhere on some stretches; inf where nothing there counts.

    They are looked at from a node between them. A gap changes by no more than the way of one body against the other,
    and the direction in which bodies are to be parted here may still be one for all stretches.
    """
    lo, hi = stretches
    m = (lo + hi) // 2
    look_at(p, m, search)
    swing_about(lo, hi, m, search)
    way, floor = range_of(p, search), floor_of(least)
    here = gap_here(p, floor + way, search, least)
    if here >= floor + way:
        return math.inf
    keep(here, m, 0.0, least)
    if here >= floor and is_clear(p, stretches, floor, floor + way, search):
        return math.inf
    return here - way


@kernel
def measure(p: int, couple: tuple[int, int], k: int, share: float, search: PairSearch, least: Least) -> float:
    """The gap [m] of two convex bodies at a share of a stretch, with its direction in ``room.n``; kept if it counts."""
    room = search.room
    place_at(p, k, share, search.couple, search.chain, search.way, room)
    gap = signed_gap(couple[0], couple[1], search.bodies, room.Xa, room.Xb, math.inf, search.gaps, room.n)
    keep(gap, k, share, least)
    return gap


@kernel
def along(p: int, couple: tuple[int, int], k: int, share: float, way_out: Array, search: PairSearch) -> float:
    """The gap [m] of two convex bodies at a share of a stretch along a direction (3,)."""
    room = search.room
    place_at(p, k, share, search.couple, search.chain, search.way, room)
    return gap_along(couple[0], couple[1], search.bodies, room.Xa, room.Xb, way_out, search.gaps)


@kernel
def lower_couple(
    p: int, couple: tuple[int, int], k: int, first: float, last: float, search: PairSearch, least: Least
) -> None:
    """Lower the least gap to that of two convex bodies between two shares of a stretch, if theirs is less."""
    parts, n = least.parts, search.room.n
    bend = acceleration_of(p, k, search.couple, search.chain, search.way)
    parts[0, FIRST], parts[0, LAST] = first, last
    parts[0, AT_FIRST] = measure(p, couple, k, first, search, least)
    for c in range(3):
        parts[0, FROM_FIRST + c] = n[c]
    parts[0, AT_LAST] = measure(p, couple, k, last, search, least)
    for c in range(3):
        parts[0, FROM_LAST + c] = n[c]
    top = 0
    while top >= 0:
        part = parts[top]
        first, last, at_first, at_last = part[FIRST], part[LAST], part[AT_FIRST], part[AT_LAST]
        size = last - first
        fall = at_first - along(p, couple, k, first, part[FROM_LAST : FROM_LAST + 3], search)
        rise = at_last - along(p, couple, k, last, part[FROM_FIRST : FROM_FIRST + 3], search)
        lowest, cross = min(at_first, at_last), 0.5
        if fall + rise > 0.0:
            cross = fall / (fall + rise)
            lowest = min(lowest, at_first + cross * (at_last - rise - at_first))
        if size <= SHORT or lowest - 0.125 * bend * size * size >= floor_of(least):
            top -= 1
            continue
        middle = first + min(max(cross, SIDE), 1.0 - SIDE) * size
        gap = measure(p, couple, k, middle, search, least)
        after = parts[top + 1]
        after[FIRST], after[LAST], after[AT_FIRST], after[AT_LAST] = middle, last, gap, at_last
        part[LAST], part[AT_LAST] = middle, gap
        for c in range(3):
            after[FROM_LAST + c] = part[FROM_LAST + c]
            after[FROM_FIRST + c] = part[FROM_LAST + c] = n[c]
        top += 1


@kernel
def lower_on(p: int, k: int, first: float, last: float, search: PairSearch, least: Least) -> None:
    """Lower the least gap to that of a pair between two shares of a stretch, if theirs is less.

    Bodies of many parts are looked at on pieces of the stretch, so short that few couples of parts count on one.
    """
    forest, bodies, descent = search.forest, search.bodies, search.descent
    width = last - first
    while True:
        end = last if first + width >= last else first + width
        way = look_between(p, k, first, end, search)
        top, count, is_cut = begin(search.roots[p], descent), 0, False
        while not is_cut:
            limit = floor_of(least) + way
            top = descend(top, limit, forest, bodies, descent)
            if top < 0:
                break
            a, b = convexes_at(top, forest, descent)
            gap = signed_gap(a, b, bodies, descent.Xa, descent.Xb, limit, search.gaps, search.room.n)
            top -= 1
            if gap >= limit:
                continue
            keep(gap, k, 0.5 * (first + end), least)
            if count < FEW:
                least.couples[count, 0], least.couples[count, 1], least.seen[count] = a, b, gap
                count += 1
            elif width > SHORTEST:
                is_cut = True
            else:
                lower_couple(p, (a, b), k, first, end, search, least)
        if is_cut:
            width *= 0.5
            continue
        for i in range(count):
            if least.seen[i] < floor_of(least) + way:
                couple = least.couples[i, 0], least.couples[i, 1]
                lower_couple(p, couple, k, first, end, search, least)
        if end >= last:
            return
        first, width = end, 2.0 * width


@kernel
def lower(p: int, begin_at: tuple[int, float], end_at: tuple[int, float], search: PairSearch, least: Least) -> None:
    """Lower the least gap to that of a pair between two places of the way, each a stretch and a share."""
    intervals, bounds = least.intervals, least.bounds
    intervals[0, 0], intervals[0, 1], bounds[0] = begin_at[0], end_at[0] + 1, -math.inf
    top = 0
    while top >= 0:
        lo, hi, bound = intervals[top, 0], intervals[top, 1], bounds[top]
        top -= 1
        if bound >= floor_of(least):
            continue
        if hi - lo == 1:
            first = begin_at[1] if lo == begin_at[0] else 0.0
            last = end_at[1] if lo == end_at[0] else 1.0
            lower_on(p, lo, first, last, search, least)
            continue
        m = (lo + hi) // 2
        one = bound_on(p, (lo, m), search, least) if m - lo > 1 else -math.inf
        other = bound_on(p, (m, hi), search, least) if hi - m > 1 else -math.inf
        # what promises less comes last, so that it is looked at first
        top += 2
        at_one, at_other = (top, top - 1) if one < other else (top - 1, top)
        intervals[at_one, 0], intervals[at_one, 1], bounds[at_one] = lo, m, one
        intervals[at_other, 0], intervals[at_other, 1], bounds[at_other] = m, hi, other


@kernel
def lower_all(search: PairSearch, least: Least) -> None:
    """Lower the least gap to that of any pair on the whole way."""
    for p in range(search.roots.shape[0]):
        lower(p, (0, 0.0), (search.way.bend.shape[0] - 1, 1.0), search, least)
