"""The least gap of a pair of bodies between two places of a joint path: how deep they come in each other, or how near.

Stretches of the path are divided as long as something less than what is known may lie on them (branch and bound).
Where few couples of convex bodies count on some stretches, `front_kernels` bounds all of these stretches at once; one
couple on one stretch is left to `couple_kernels`.
"""

from __future__ import annotations

import math

from gcodesim.checks.contact_kernels import FEW, SHORTEST
from gcodesim.checks.couple_kernels import FRONT, Least, floor_of, keep, lower_couple
from gcodesim.checks.descent_kernels import begin, convexes_at, descend
from gcodesim.checks.front_kernels import lower_front
from gcodesim.checks.gap_kernels import signed_gap
from gcodesim.checks.search_kernels import PairSearch, is_above, look_at, look_between, range_of, swing_about
from gcodesim.compiled import kernel


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
    way = range_of(p, search)
    if hi - lo <= FRONT and lower_front(p, stretches, m, way, search, least):
        return math.inf
    floor = floor_of(least)
    here = gap_here(p, floor + way, search, least)
    if here >= floor + way:
        return math.inf
    keep(here, m, 0.0, least)
    if here >= floor and is_clear(p, stretches, floor, floor + way, search):
        return math.inf
    return here - way


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
    k, end, top = begin_at[0], end_at[0], 0
    intervals[0, 0], intervals[0, 1], bounds[0] = k, k + 1, -math.inf
    if end > k:
        top += 1
        intervals[top, 0], intervals[top, 1], bounds[top] = end, end + 1, -math.inf
    if end - k > 1:
        # whole stretches come first: below what they hold little is left where a contact begins or ends
        top += 1
        bounds[top] = bound_on(p, (k + 1, end), search, least) if end - k > 2 else -math.inf
        intervals[top, 0], intervals[top, 1] = k + 1, end
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
