"""The least gap of two convex bodies between two places of one stretch of a joint path, and the least so far of all.

The bodies' gap is bounded by the gaps along the directions in which they are to be parted at either end: it is above
both of them, and each is above its chord but for what the bodies' acceleration allows. Where the chords cross is looked
at next (supporting planes, Kelley 1960, J. SIAM 8, 703).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.checks.contact_kernels import FEW
from gcodesim.checks.gap_kernels import Ints, gap_along, signed_gap
from gcodesim.checks.search_kernels import PairSearch
from gcodesim.checks.way_kernels import acceleration_of, place_at
from gcodesim.compiled import kernel
from gcodesim.frames import Array

DEEPEST = 64  # divisions of a way into stretches
PARTS = 128  # divisions of a stretch
FRONT = 128  # stretches that are bounded at once
SIDE = 0.15  # of a part: a division is no nearer to its ends
SHORT = 1e-7  # of a stretch: parts are not divided any more
FIRST, LAST, AT_FIRST, AT_LAST, FROM_FIRST, FROM_LAST = 0, 1, 2, 3, 4, 7
"""Columns of a part: the shares at its ends, the gaps [m] there, and the directions (3,) in which these lie."""


class Least(NamedTuple):
    """The least gap (1,) [m] so far, its `stretch` (1,) and its `share` (1,) of that.

    It is found to `exact` (2,): [m], and a share of itself. The rest is room: intervals of stretches with what gaps are
    not below there, parts of a stretch, couples of convex bodies with the gaps (k,) [m] where they were seen; for each
    node of some stretches, along the last direction and at most along any, the gap `values` (2, k) of a couple, and
    whether it was looked at there; for each stretch whether it is `open`.
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
    values: Array
    looked: Ints
    open: Ints


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
        np.zeros((2, FRONT + 1)),
        np.zeros(FRONT + 1, dtype=np.int64),
        np.zeros(FRONT, dtype=np.int64),
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
