"""The least gap of a pair of bodies of few parts on many stretches of a joint path at once.

The direction in which two convex bodies are to be parted at one node of the way bounds their gap at every other node,
for no more than a look at their farthest points. Each stretch whose bound is above the least gap so far is closed; the
node where the best bound of what is open is least is looked at next (supporting planes, Kelley 1960, J. SIAM 8, 703).
"""

from __future__ import annotations

import math

from gcodesim.checks.couple_kernels import Least, floor_of, keep, lower_couple
from gcodesim.checks.descent_kernels import begin, convexes_at, descend
from gcodesim.checks.gap_kernels import gap_along, signed_gap
from gcodesim.checks.search_kernels import PairSearch, place_at_node
from gcodesim.checks.way_kernels import acceleration_of, place_at
from gcodesim.compiled import kernel

COUPLES = 9  # of convex bodies that are bounded on many stretches each
PIECES = 5  # of a stretch that is too long to be bounded by its ends


@kernel
def couples_here(p: int, limit: float, search: PairSearch, least: Least) -> int:
    """Couples of convex bodies, with their gaps, that are nearer than `limit` [m] where a pair is looked at.

    How many there are in `least`; -1 where they are more than `COUPLES`.
    """
    descent = search.descent
    top, count = begin(search.roots[p], descent), 0
    while True:
        top = descend(top, limit, search.forest, search.bodies, descent)
        if top < 0:
            return count
        a, b = convexes_at(top, search.forest, descent)
        top -= 1
        if count == COUPLES:
            return -1
        least.couples[count, 0], least.couples[count, 1] = a, b
        count += 1


@kernel
def lower_front(p: int, stretches: tuple[int, int], m: int, way: float, search: PairSearch, least: Least) -> bool:
    """Lower the least gap to that of a pair on some stretches, if few couples of convex bodies count there.

    The pair is looked at at node `m`, from where a point of one body goes `way` [m] against the other at most.
    """
    descent, seen = search.descent, least.seen
    count = couples_here(p, floor_of(least) + way, search, least)
    if count < 0:
        return False
    for i in range(count):
        a, b = least.couples[i, 0], least.couples[i, 1]
        limit = floor_of(least) + way
        seen[i] = signed_gap(a, b, search.bodies, descent.Xa, descent.Xb, limit, search.gaps, search.room.n)
        if seen[i] < limit:
            keep(seen[i], m, 0.0, least)
    for _ in range(count):
        best = 0
        for i in range(count):
            if seen[i] < seen[best]:
                best = i
        if seen[best] >= floor_of(least) + way:
            break
        lower_along(p, (least.couples[best, 0], least.couples[best, 1]), stretches, m, search, least)
        seen[best] = math.inf
    return True


@kernel
def lower_along(
    p: int, couple: tuple[int, int], stretches: tuple[int, int], m: int, search: PairSearch, least: Least
) -> None:
    """Lower the least gap to that of two convex bodies on some stretches, if theirs is less.

    The direction in which they are to be parted at one node bounds their gap on all stretches. The node whose bound is
    the least is looked at next; what is left when a stretch has been looked at at both ends is looked at by itself.
    """
    lo, hi = stretches
    for i in range(hi - lo):
        least.open[i] = 1
    for i in range(hi - lo + 1):
        least.values[1, i], least.looked[i] = -math.inf, 0
    node = m
    while node >= 0:
        place_at_node(p, node, search)
        room = search.room
        gap = signed_gap(couple[0], couple[1], search.bodies, room.Xa, room.Xb, math.inf, search.gaps, room.n)
        keep(gap, node, 0.0, least)
        least.looked[node - lo] = 1
        close_stretches(p, couple, stretches, search, least)
        node = next_node(stretches, least)
    for k in range(lo, hi):
        if least.open[k - lo] == 1:
            lower_couple(p, couple, k, 0.0, 1.0, search, least)


@kernel
def close_stretches(
    p: int, couple: tuple[int, int], stretches: tuple[int, int], search: PairSearch, least: Least
) -> None:
    """Close stretches on which two convex bodies are nowhere below the least gap, by the direction ``room.n``.

    Between two nodes the gap along it is above its chord but for what the bodies' acceleration allows.
    """
    lo, hi = stretches
    room, values, is_open, floor = search.room, least.values, least.open, floor_of(least)
    for k in range(lo, hi + 1):
        i = k - lo
        if (i == 0 or is_open[i - 1] == 0) and (k == hi or is_open[i] == 0):
            continue
        place_at_node(p, k, search)
        value = gap_along(couple[0], couple[1], search.bodies, room.Xa, room.Xb, room.n, search.gaps)
        values[0, i] = value
        values[1, i] = max(values[1, i], value)
        if i > 0 and is_open[i - 1] == 1:
            bow = acceleration_of(p, k - 1, search.couple, search.chain, search.way) / 8.0
            above = min(values[0, i - 1], value) - floor
            if above >= bow or (PIECES * PIECES * above >= bow and stays_above(p, couple, k - 1, bow, floor, search)):
                is_open[i - 1] = 0


@kernel
def stays_above(p: int, couple: tuple[int, int], k: int, bow: float, floor: float, search: PairSearch) -> bool:
    """Whether the gap along ``room.n`` is above `floor` [m] on stretch `k`, looked at at the ends of `PIECES` of it.

    On the whole stretch it is above its chord but for `bow` [m]; the square of their number less on one piece.
    """
    room = search.room
    for i in range(1, PIECES):
        place_at(p, k, i / PIECES, search.couple, search.chain, search.way, room)
        value = gap_along(couple[0], couple[1], search.bodies, room.Xa, room.Xb, room.n, search.gaps)
        if value - bow / (PIECES * PIECES) < floor:
            return False
    return True


@kernel
def next_node(stretches: tuple[int, int], least: Least) -> int:
    """The node at the end of an open stretch where the gap may be least and was not looked at; -1: there is none."""
    lo, hi = stretches
    found, lowest = -1, math.inf
    for i in range(hi - lo + 1):
        is_open = (i > 0 and least.open[i - 1] == 1) or (i < hi - lo and least.open[i] == 1)
        if is_open and least.looked[i] == 0 and least.values[1, i] < lowest:
            found, lowest = lo + i, least.values[1, i]
    return found
