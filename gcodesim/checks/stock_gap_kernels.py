"""How near bodies of a machine come to a stock as it is at a moment, along the joints of consecutive steps.

A stock is its columns: each interval of material counts as a straight line through the middle of its cell. Patches of
columns are looked at as boxes first, so that most columns are never asked. A body then goes on by the gap that was
found before it is looked at again (conservative advancement, Mirtich 1996), and by half a cell at least.

The column that was nearest to a body, or deepest in it, most likely is so again: it is asked first, and what cannot
promise more than it is left out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.checks.gap_kernels import Convexes, GapRoom, Ints, farthest, gap_along, signed_gap
from gcodesim.checks.way_kernels import Couple, JointTree, WayRoom, place_pair
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.material.column_kernels import (
    breadth,
    column_at,
    columns_of_patch,
    finest,
    interval_of,
    patch_room,
    patches_within,
)
from gcodesim.material.field_kernels import Field

LEAST_WAY = 0.5  # of a cell: what a body goes at least between two looks
COARSE = 4  # columns: every so many are asked first, so that few of the rest promise more
CLEAR = 4.0  # cells beyond the level by which the rooms of body and patches have to be apart to be answer enough
DEEPER = 0.25  # of a cell: what a column must promise beyond the depth that is known to be asked
TOUCH = 1e-6  # [m] bodies that enter each other by less only touch
HALVINGS = 12  # of the way to the first contact
NEVER = 2.0

FREE, LAST = 0, 1
CONVEX = 2
NEAREST = 5
STATE = CONVEX + NEAREST
"""Places in the state of a pair: the way [m] on which it cannot come below the level, the last gap [m], and where that

was found: the convex body (-1: nowhere yet), the patch and the column, `NEAREST` numbers.
"""

GAP, FIRST, DEEPEST = 0, 1, 2
"""Columns of what is found for a step: least gap [m], share at which the bodies meet (2: never), share of the least."""


class StockSight(NamedTuple):
    """One body and one stock, pair `pair` of a `Couple`.

    `X_JS` (4, 4) is where the stock stands on its joint. The body is convexes `first` to `end`, and `probe` is a row
    of the table with room for eight corners. Gaps above `level` [m] are of no interest (`-TOUCH`: contact alone is);
    below `floor` [m] in S the stock has nothing. `whether`: it is only asked when a gap comes down to
    the level, not how small it becomes.
    """

    pair: int
    X_JS: Array
    first: int
    end: int
    probe: int
    level: float
    floor: float
    whether: bool


class SightRoom(NamedTuple):
    """Room to work in.

    Joints and poses, gaps, the body seen from S, the stock's own pose, the corners of a room around a body, the
    direction along which the least gap lies, and where that is, as a state has it.
    """

    way: WayRoom
    gaps: GapRoom
    X_SB: Array
    X_SS: Array
    low: Array
    high: Array
    out: Array
    nearest: Ints


def sight_room(way: WayRoom, gaps: GapRoom) -> SightRoom:
    """Room for `approach`."""
    return SightRoom(way, gaps, np.eye(4), np.eye(4), np.zeros(3), np.zeros(3), np.zeros(3), np.full(NEAREST, -1))


@kernel
def seen_from_stock(Xa: Array, Xb: Array, X_JS: Array, X_SB: Array) -> None:
    """X_SB (4, 4) of a body at Xa, the stock standing at X_JS on the joint at Xb."""
    for r in range(3):
        # column r of the rotation of S in the common frame
        nx = Xb[0, 0] * X_JS[0, r] + Xb[0, 1] * X_JS[1, r] + Xb[0, 2] * X_JS[2, r]
        ny = Xb[1, 0] * X_JS[0, r] + Xb[1, 1] * X_JS[1, r] + Xb[1, 2] * X_JS[2, r]
        nz = Xb[2, 0] * X_JS[0, r] + Xb[2, 1] * X_JS[1, r] + Xb[2, 2] * X_JS[2, r]
        offset = 0.0
        for c in range(3):
            X_SB[r, c] = nx * Xa[0, c] + ny * Xa[1, c] + nz * Xa[2, c]
            p = Xb[c, 3] + Xb[c, 0] * X_JS[0, 3] + Xb[c, 1] * X_JS[1, 3] + Xb[c, 2] * X_JS[2, 3]
            offset += (nx if c == 0 else ny if c == 1 else nz) * (Xa[c, 3] - p)
        X_SB[r, 3] = offset


@kernel
def bounds_of_convex(a: int, bodies: Convexes, X: Array, room: SightRoom) -> None:
    """Least and greatest corner of convex body `a` at X (4, 4), into `low` and `high`."""
    d, out = room.gaps.d, room.gaps.point
    for axis in range(3):
        for c in range(3):
            d[c] = 1.0 if c == axis else 0.0
        room.high[axis] = farthest(a, bodies, X, d, 1.0, out) + bodies.grown[a]
        room.low[axis] = -farthest(a, bodies, X, d, -1.0, out) - bodies.grown[a]


@kernel
def show_line(bodies: Convexes, probe: int, x: float, y: float, low: float, high: float) -> None:
    """Make the probe the line from `low` to `high` at (x, y)."""
    row = bodies.first[probe]
    for k in range(2):
        bodies.points[row + k, 0], bodies.points[row + k, 1] = x, y
    bodies.points[row, 2], bodies.points[row + 1, 2] = low, high
    bodies.many[probe] = 2
    bodies.origin[probe, 0], bodies.origin[probe, 1], bodies.origin[probe, 2] = x, y, 0.5 * (low + high)


@kernel
def show_box(bodies: Convexes, probe: int, box: tuple[float, float, float, float, float, float]) -> None:
    """Make the probe a box (x, x, y, y, z, z)."""
    row = bodies.first[probe]
    for k in range(8):
        bodies.points[row + k, 0] = box[k & 1]
        bodies.points[row + k, 1] = box[2 + ((k >> 1) & 1)]
        bodies.points[row + k, 2] = box[4 + (k >> 2)]
    bodies.many[probe] = 8
    for c in range(3):
        bodies.origin[probe, c] = 0.5 * (box[2 * c] + box[2 * c + 1])


@kernel
def between(low: float, high: float, least: float, most: float) -> float:
    """How far apart two spans are; 0 where they overlap."""
    return max(max(least - high, low - most), 0.0)


@kernel
def may_be_nearer(
    box: tuple[float, float, float, float, float, float], best: float, slack: float, low: Array, high: Array
) -> bool:
    """Whether a body in the room `low` to `high` may be nearer to a box (x, x, y, y, z, z) than `best` [m].

    Once one is inside something, as `best` below 0 says: deeper in it by more than `slack`.
    """
    far, deep = 0.0, np.inf
    for c in range(3):
        deep = min(deep, box[2 * c + 1] - low[c], high[c] - box[2 * c])
        beside = between(low[c], high[c], box[2 * c], box[2 * c + 1])
        far += beside * beside
    return deep > slack - best if best <= 0.0 else far <= 0.0 or far < best * best


@kernel
def in_columns(
    a: int,
    patch: tuple[int, int],
    stride: int,
    sight: StockSight,
    field: Field,
    bodies: Convexes,
    best: float,
    room: SightRoom,
) -> float:
    """The least of `best` and the gaps [m] of convex body `a` to columns of a patch; `low`, `high` are its room.

    Every so many columns are asked, as `stride` says.
    """
    low, high = room.low, room.high
    cell = finest(field)
    first_i, last_i, first_j, last_j = columns_of_patch(field, patch[0], patch[1])
    for i in range(first_i, last_i, stride):
        for j in range(first_j, last_j, stride):
            x, y, many = column_at(field, i, j)
            for k in range(many):
                below, above = interval_of(field, i, j, k)
                if not may_be_nearer((x, x, y, y, below, above), best, DEEPER * cell, low, high):
                    continue
                show_line(bodies, sight.probe, x, y, below, above)
                if best <= 0.0:  # along the way out of the deepest so far: no body is deeper than along any
                    gap = gap_along(a, sight.probe, bodies, room.X_SB, room.X_SS, room.out, room.gaps)
                    if gap >= best - DEEPER * cell:
                        continue
                gap = signed_gap(a, sight.probe, bodies, room.X_SB, room.X_SS, best, room.gaps, room.way.n)
                if gap < best:
                    best = gap
                    room.nearest[0], room.nearest[1], room.nearest[2] = a, patch[0], patch[1]
                    room.nearest[3], room.nearest[4] = i, j
                    for c in range(3):
                        room.out[c] = room.way.n[c]
                if best <= sight.level and sight.whether:
                    return best
    return best


@kernel
def rooms_apart(sight: StockSight, field: Field, bodies: Convexes, enough: float, room: SightRoom) -> float:
    """A gap [m] that a body at `X_SB` has at least, from its room and those of the patches along x, y, z of S.

    At most `enough`. Where it comes near the level, there is no use in going on.
    """
    low, high = room.low, room.high
    near = sight.level + CLEAR * finest(field)
    best = enough
    for a in range(sight.first, sight.end):
        bounds_of_convex(a, bodies, room.X_SB, room)
        first_i, last_i, first_j, last_j = patches_within(
            field, low[0] - best, high[0] + best, low[1] - best, high[1] + best
        )
        for i in range(first_i, last_i):
            for j in range(first_j, last_j):
                x0, x1, y0, y1, top = patch_room(field, i, j)
                if top <= sight.floor:
                    continue
                up = between(low[2], high[2], sight.floor, top)
                if up >= best:
                    continue
                across, beside = between(low[0], high[0], x0, x1), between(low[1], high[1], y0, y1)
                best = min(best, float(np.sqrt(across * across + beside * beside + up * up)))
                if best <= near:
                    return best
    return best


@kernel
def gap_to_stock(sight: StockSight, field: Field, bodies: Convexes, enough: float, room: SightRoom) -> float:
    """The gap [m] of a body at `X_SB` to the material of a stock, or minus its depth.

    One that is well above the level may be told as less than it is, and as `enough` where it is more.
    """
    low, high = room.low, room.high
    apart = rooms_apart(sight, field, bodies, enough, room)
    if apart > sight.level + CLEAR * finest(field):
        return apart
    best = gap_where_it_was(sight, field, bodies, enough, room)
    slack = DEEPER * finest(field)
    for a in range(sight.first, sight.end):
        if best <= sight.level and sight.whether:
            return best
        bounds_of_convex(a, bodies, room.X_SB, room)
        reach = max(best, 0.0)
        first_i, last_i, first_j, last_j = patches_within(
            field, low[0] - reach, high[0] + reach, low[1] - reach, high[1] + reach
        )
        for stride in (COARSE, 1):
            for i in range(first_i, last_i):
                for j in range(first_j, last_j):
                    x0, x1, y0, y1, top = patch_room(field, i, j)
                    box = (x0, x1, y0, y1, sight.floor, top)
                    if top <= sight.floor or not may_be_nearer(box, best, slack, low, high):
                        continue
                    show_box(bodies, sight.probe, box)
                    if best <= 0.0:
                        gap = gap_along(a, sight.probe, bodies, room.X_SB, room.X_SS, room.out, room.gaps)
                        if gap >= best - slack:
                            continue
                    gap = signed_gap(a, sight.probe, bodies, room.X_SB, room.X_SS, best, room.gaps, room.way.n)
                    if gap >= (best if best > 0.0 else best - slack):
                        continue
                    best = in_columns(a, (i, j), stride, sight, field, bodies, best, room)
                    if best <= sight.level and sight.whether:
                        return best
    return best


@kernel
def gap_where_it_was(sight: StockSight, field: Field, bodies: Convexes, enough: float, room: SightRoom) -> float:
    """The gap [m] to the column in which the least one was found before; `enough` where it is more, or none was."""
    best = enough
    a, i, j = room.nearest[0], room.nearest[3], room.nearest[4]
    if a < 0:
        return best
    _, last_i, _, last_j = columns_of_patch(field, room.nearest[1], room.nearest[2])
    if i >= last_i or j >= last_j:  # a stock may get other columns
        return best
    x, y, many = column_at(field, i, j)
    for k in range(many):
        below, above = interval_of(field, i, j, k)
        show_line(bodies, sight.probe, x, y, below, above)
        gap = signed_gap(a, sight.probe, bodies, room.X_SB, room.X_SS, best, room.gaps, room.way.n)
        if gap < best:
            best = gap
            for c in range(3):
                room.out[c] = room.way.n[c]
    return best


@kernel
def gap_at_share(
    q: Array,
    place: tuple[int, float],
    sight: StockSight,
    couple: Couple,
    chain: JointTree,
    field: Field,
    bodies: Convexes,
    enough: float,
    room: SightRoom,
) -> float:
    """The gap [m] at a share of a step; `enough` where it is more."""
    k, t = place
    for j in range(q.shape[1]):
        room.way.q[j] = q[k, j] + t * (q[k + 1, j] - q[k, j])
    place_pair(sight.pair, couple, chain, room.way)
    seen_from_stock(room.way.Xa, room.way.Xb, sight.X_JS, room.X_SB)
    return gap_to_stock(sight, field, bodies, enough, room)


@kernel
def approach(
    q: Array,
    sight: StockSight,
    couple: Couple,
    chain: JointTree,
    field: Field,
    bodies: Convexes,
    state: Array,
    room: SightRoom,
    found: Array,
) -> int:
    """Follow one pair through n steps, joints q (n + 1, j) at their ends, with the stock as it is now; n.

    If only asked whether a gap comes down to the level, it ends there, and returns how many steps are before that.

    `found` (n, 3) says what happens in each step, `state` (STATE,) what is known of the pair before and after them. A
    body that is half a cell from the level, or nearer, is looked at at the end of each step, too.
    """
    level = sight.level
    for c in range(NEAREST):
        room.nearest[c] = int(state[CONVEX + c])
    least = LEAST_WAY * finest(field)
    enough = level + breadth(field)
    for k in range(len(q) - 1):
        found[k, GAP], found[k, FIRST], found[k, DEEPEST] = np.inf, NEVER, 0.0
        way = 0.0
        for j in range(q.shape[1]):
            way += couple.reach[sight.pair, j] * abs(q[k + 1, j] - q[k, j])
        if state[FREE] > 0.0 and state[LAST] <= level:  # as the step begins
            if sight.whether:
                return k
            found[k, GAP] = state[LAST]
            found[k, FIRST] = 0.0 if state[LAST] <= -TOUCH else NEVER
        done = 0.0
        while True:
            rest = way - done
            looks = rest > 0.0 and state[LAST] <= level + least  # at the end of the step
            if state[FREE] > rest and not looks:
                break
            before, done = done, way if looks and state[FREE] >= rest else done + state[FREE]
            t = done / way if way > 0.0 else 0.0
            gap = gap_at_share(q, (k, t), sight, couple, chain, field, bodies, enough, room)
            if gap < found[k, GAP]:
                found[k, GAP], found[k, DEEPEST] = gap, t
            if gap <= level and sight.whether:
                return k
            if gap <= -TOUCH and found[k, FIRST] > 1.0:
                clear = before / way if state[LAST] > -TOUCH and way > 0.0 else t
                for _ in range(HALVINGS):
                    middle = 0.5 * (clear + t)
                    if gap_at_share(q, (k, middle), sight, couple, chain, field, bodies, enough, room) > -TOUCH:
                        clear = middle
                    else:
                        t = middle
                found[k, FIRST] = t
            state[LAST] = gap
            state[FREE] = max(gap - level, least)
        state[FREE] -= way - done
    for c in range(NEAREST):
        state[CONVEX + c] = room.nearest[c]
    return len(q) - 1
