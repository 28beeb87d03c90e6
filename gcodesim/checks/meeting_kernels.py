"""When pairs of bodies meet along a whole joint path: from where to where they are below a level of their gap.

Stretches of the path are looked at together while the distance of a pair is greater than its bodies can move on them,
or while its bodies are deeper in each other than that (adaptive bisection, Schwarzer, Saha and Latombe 2005, IEEE
Trans. Robotics 21, 338). What is left goes to `contact_kernels`, one stretch at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.checks.contact_kernels import beginning, end_on, first_on, later_end_on
from gcodesim.checks.couple_kernels import Least
from gcodesim.checks.descent_kernels import deepest_of
from gcodesim.checks.gap_kernels import Ints
from gcodesim.checks.least_kernels import lower
from gcodesim.checks.search_kernels import (
    TOGETHER,
    PairSearch,
    comes_near,
    is_free,
    look_at,
    range_of,
    shift_on,
    swing_about,
)
from gcodesim.checks.way_kernels import CLOSE, NEVER, slack_of
from gcodesim.compiled import kernel
from gcodesim.frames import Array

LEVELS = 64
PAIR, FIRST, LAST, DEEPEST, ONE, OTHER = 0, 1, 2, 3, 4, 5
"""Columns of rows of meetings: the pair, the first stretch, the last, that of the least gap, both convex bodies that

come into contact first.
"""
BEGIN, END, AT_LEAST, GAP = 0, 1, 2, 3
"""Columns of their figures: shares of the first, the last and the deepest stretch; the least gap [m]."""


class Meetings(NamedTuple):
    """Room for what is found: `rows` (n, 6) and `figures` (n, 4), of which `used` (1,) are filled."""

    rows: Ints
    figures: Array
    used: Ints


def meetings_room(most: int) -> Meetings:
    """Room for `most` meetings."""
    return Meetings(np.zeros((most, 6), dtype=np.int64), np.zeros((most, 4)), np.zeros(1, dtype=np.int64))


class Walk(NamedTuple):
    """Pairs by level of bisection and how many; intervals; the last stretch and the open meeting of each pair."""

    alive: Ints
    many: Ints
    intervals: Ints
    last: Ints
    open: Ints


def walk_room(pairs: int) -> Walk:
    """Room for `meet`, before the first stretch."""
    return Walk(
        np.zeros((LEVELS, pairs), dtype=np.int64),
        np.zeros(LEVELS, dtype=np.int64),
        np.zeros((2 * LEVELS, 3), dtype=np.int64),
        np.full(pairs, -2, dtype=np.int64),
        np.full(pairs, -1, dtype=np.int64),
    )


@kernel
def stays(p: int, stretches: tuple[int, int], level: float, search: PairSearch) -> bool:
    """Whether a pair is below the level on all of some stretches, as the gap where it is looked at shows."""
    way = range_of(p, search)
    deepest = deepest_of(search.roots[p, 0], search.roots[p, 1], search.forest.most)
    if way < deepest and comes_near(p, level - way, search):
        return True
    if stretches[1] - stretches[0] > TOGETHER:
        return False
    shift = shift_on(p, stretches, deepest, search)
    return shift < min(way, deepest) and comes_near(p, level - shift, search)


@kernel
def open_meeting(p: int, k: int, start: float, level: float, search: PairSearch, walk: Walk, found: Meetings) -> float:
    """Where on a stretch a pair comes below the level, which opens a meeting; `NEVER`: nowhere, or rows are full."""
    share, one, other, gap = first_on(p, k, start, level, search)
    if share > 1.0 or found.used[0] >= found.rows.shape[0]:
        return NEVER
    e = found.used[0]
    found.used[0] += 1
    walk.open[p] = e
    row, figures = found.rows[e], found.figures[e]
    row[PAIR], row[FIRST], row[LAST], row[DEEPEST], row[ONE], row[OTHER] = p, k, k, k, one, other
    figures[BEGIN], figures[END], figures[AT_LEAST], figures[GAP] = share, share, share, gap
    return share


@kernel
def meet_on(p: int, k: int, level: float, search: PairSearch, walk: Walk, found: Meetings) -> None:
    """What two bodies do on one stretch: rows of `found` for each time that they come below a level."""
    if walk.last[p] != k - 1:
        walk.open[p] = -1
    kept = level - slack_of(p, k, search.couple, search.way) if level <= 0.0 else level
    here = 0.0
    while here < 1.0:
        is_new = walk.open[p] < 0
        if is_new:
            here = open_meeting(p, k, here, level, search, walk, found)
            if here > 1.0:
                return
        if is_new:
            end = end_on(p, k, here, kept, search) if here < 1.0 else NEVER
        else:
            end = later_end_on(p, k, kept, search)
        e = walk.open[p]
        walk.last[p] = found.rows[e, LAST] = k
        found.figures[e, END] = min(end, 1.0)
        if end > 1.0:
            return
        walk.open[p] = -1
        here = end


@kernel
def meet(level: float, search: PairSearch, walk: Walk, found: Meetings) -> None:
    """Every time that a pair comes below `level` [m] on the way; how deep it gets is left to `complete`."""
    count, intervals = walk.many, walk.intervals
    count[0] = search.roots.shape[0]
    for p in range(count[0]):
        walk.alive[0, p] = p
    intervals[0, 0], intervals[0, 1], intervals[0, 2] = 0, search.way.bend.shape[0], 0
    top = 0
    while top >= 0:
        lo, hi, depth = intervals[top, 0], intervals[top, 1], intervals[top, 2]
        top -= 1
        m = (lo + hi) // 2
        swing_about(lo, hi, m, search)
        kept = 0
        for i in range(count[depth]):
            p = walk.alive[depth, i]
            look_at(p, m, search)
            e = walk.open[p]
            if e >= 0 and walk.last[p] == lo - 1:
                if stays(p, (lo, hi), level, search):
                    walk.last[p] = found.rows[e, LAST] = hi - 1
                    found.figures[e, END] = 1.0
                    continue
            elif is_free(p, (lo, hi), level + CLOSE, search):
                continue
            walk.alive[depth + 1, kept] = p
            kept += 1
        count[depth + 1] = kept
        if kept == 0:
            continue
        if hi - lo > 1:
            intervals[top + 1, 0], intervals[top + 1, 1], intervals[top + 1, 2] = m, hi, depth + 1
            intervals[top + 2, 0], intervals[top + 2, 1], intervals[top + 2, 2] = lo, m, depth + 1
            top += 2
            continue
        for i in range(kept):
            meet_on(walk.alive[depth + 1, i], lo, level, search, walk, found)


@kernel
def complete(which: Ints, search: PairSearch, least: Least, found: Meetings) -> None:
    """Find how near the bodies of some meetings, by their rows, come, or how deep in each other."""
    for e in which:
        row, figures = found.rows[e], found.figures[e]
        p, begin = row[PAIR], (row[DEEPEST], figures[AT_LEAST])
        least.gap[0], least.stretch[0], least.share[0] = figures[GAP], row[DEEPEST], figures[AT_LEAST]
        lower(p, begin, (row[LAST], figures[END]), search, least)
        row[DEEPEST], figures[AT_LEAST], figures[GAP] = least.stretch[0], least.share[0], least.gap[0]


@kernel
def touch_exactly(search: PairSearch, found: Meetings) -> None:
    """Find where contacts begin exactly, of bodies that have come a little into each other there."""
    for e in range(found.used[0]):
        row, figures = found.rows[e], found.figures[e]
        if figures[BEGIN] > 0.0:
            figures[BEGIN] = beginning(row[PAIR], row[ONE], row[OTHER], row[FIRST], figures[BEGIN], search)
