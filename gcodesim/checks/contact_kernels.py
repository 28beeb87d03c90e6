"""Where on one stretch of a joint path the bodies of a pair come down to a level of their gap, and leave it again."""

from __future__ import annotations

from gcodesim.checks.descent_kernels import begin, convexes_at, descend
from gcodesim.checks.gap_kernels import gap_between
from gcodesim.checks.search_kernels import PairSearch, gap_seen, look_between, look_in, range_of
from gcodesim.checks.way_kernels import CLOSE, NEVER, ROUNDS, advance, gap_at
from gcodesim.compiled import kernel

FEW = 24  # couples of convex bodies that are looked at one by one on a piece of a stretch
SHORTEST = 1.0 / 256.0  # of a stretch: pieces are no shorter
FIRST_STEP = 2.0**-15  # of what is left of a stretch: where it is first asked whether a contact is over
STEP = 0.125  # of the same: the longest way between two such places behind a contact
TOUCHING = 1e-9  # [m] bodies that are no deeper in each other touch
SAME = 1e-10  # of a stretch


@kernel
def is_nearer(a: int, b: int, limit: float, search: PairSearch) -> bool:
    """Whether the gap of two convex bodies is less than `limit` [m] where their pair is looked at."""
    descent = search.descent
    gap = gap_between(a, b, search.bodies, descent.Xa, descent.Xb, limit, limit, search.gaps, search.room.n)
    return gap < limit


@kernel
def couples_within(p: int, limit: float, most: int, search: PairSearch) -> int:
    """How many couples of convex bodies are nearer than `limit` [m] where the pair is looked at; counted to `most`."""
    top, count = begin(search.roots[p], search.descent), 0
    while count < most:
        top = descend(top, limit, search.forest, search.bodies, search.descent)
        if top < 0:
            return count
        a, b = convexes_at(top, search.forest, search.descent)
        if is_nearer(a, b, limit, search):
            count += 1
        top -= 1
    return count


@kernel
def first_on(p: int, k: int, start: float, level: float, search: PairSearch) -> tuple[float, int, int, float]:
    """Where on a stretch from a share on two bodies first come to a level: share, both convex bodies, the gap [m].

    `NEVER` where they do not. Bodies of many parts are looked at on pieces of the stretch, so short that few couples of
    parts may meet on one.
    """
    rooms = search.room, search.gaps
    width = 1.0 - start
    first, one, other, deep = NEVER, -1, -1, 0.0
    while True:
        end = 1.0 if start + width >= 1.0 else start + width
        limit = look_between(p, k, start, end, search) + level + CLOSE
        count = couples_within(p, limit, FEW + 1, search)
        if count > FEW and width > SHORTEST:
            width *= 0.5
            continue
        top = begin(search.roots[p], search.descent) if count > 0 else -1
        while True:
            top = descend(top, limit, search.forest, search.bodies, search.descent)
            if top < 0:
                break
            a, b = convexes_at(top, search.forest, search.descent)
            if is_nearer(a, b, limit, search):
                near = k, start, level, min(first, end)
                share, gap = advance(p, a, b, near, search.couple, search.chain, search.way, search.bodies, rooms)
                if share < first:
                    first, one, other, deep = share, a, b, gap
            top -= 1
        if first <= end or end >= 1.0:
            return first, one, other, deep
        start, width = end, 2.0 * width


@kernel
def way_on(p: int, k: int, search: PairSearch) -> float:
    """How far [m] a point of one body of a pair may move against the other on a stretch."""
    for j in range(search.swing.shape[0]):
        search.swing[j] = abs(search.way.q[k + 1, j] - search.way.q[k, j])
    return range_of(p, search)


@kernel
def end_on(p: int, k: int, start: float, level: float, search: PairSearch) -> float:
    """Where on a stretch two bodies that come below a level at a share are found above it; `NEVER`: they stay below.

    A gap grows by no more than the way of one body against the other, so where they are deep enough in each other they
    stay so. Elsewhere it is looked at again and again, the sooner the nearer the contact is.
    """
    left, way = 1.0 - start, way_on(p, k, search)
    here = start
    step = FIRST_STEP * left
    while here < 1.0:
        step = max(step, SAME)  # a contact may begin so near to the end of the stretch that nothing is left to halve
        here = 1.0 if here + step >= 1.0 else here + step
        look_in(p, k, here, search)
        stays_from = level - way * (1.0 - here)
        gap = gap_seen(p, stays_from, level + CLOSE, search)
        if gap >= level + CLOSE:
            return here
        if gap < stays_from:
            return NEVER
        step = min(here - start, STEP * left)
        if way > 0.0:
            step = max(step, (level - gap) / way)
    return NEVER


@kernel
def later_end_on(p: int, k: int, level: float, search: PairSearch) -> float:
    """`end_on` of bodies that are below the level where the stretch begins: looked at in its middle and at its end."""
    way = way_on(p, k, search)
    for half in range(1, 3):
        here = 0.5 * half
        look_in(p, k, here, search)
        stays_from = level - way * (1.0 - here)
        gap = gap_seen(p, stays_from, level + CLOSE, search)
        if gap >= level + CLOSE:
            return here
        if gap < stays_from:
            return NEVER
    return NEVER


@kernel
def beginning(p: int, a: int, b: int, k: int, share: float, search: PairSearch) -> float:
    """Share of a stretch at which two convex bodies touch that are in each other at `share`, or 0.

    By false position, with half of the value of an end that stays (the Illinois algorithm, Dowell and Jarratt 1971,
    BIT 11, 168).
    """
    couple, chain, way, bodies = search.couple, search.chain, search.way, search.bodies
    rooms = search.room, search.gaps
    low, high = 0.0, share
    at_low = gap_at(p, a, b, (k, low), couple, chain, way, bodies, rooms)
    if at_low <= 0.0:
        return low
    at_high = gap_at(p, a, b, (k, high), couple, chain, way, bodies, rooms)
    end = at_high
    for _ in range(ROUNDS):
        if end > -TOUCHING or high - low < SAME:
            break
        middle = high - at_high * (high - low) / (at_high - at_low)
        gap = gap_at(p, a, b, (k, middle), couple, chain, way, bodies, rooms)
        if gap > 0.0:
            low, at_low, at_high = middle, gap, 0.5 * at_high
        else:
            high, at_high, at_low, end = middle, gap, 0.5 * at_low, gap
    return high
