"""What a search along a way of joints goes by: pairs of bodies, where they are on the way, and how far they move."""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.checks.descent_kernels import Descent, begin, convexes_at, descend
from gcodesim.checks.forest_kernels import Forest
from gcodesim.checks.gap_kernels import Convexes, GapRoom, Ints, gap_along, gap_between
from gcodesim.checks.way_kernels import (
    Couple,
    JointTree,
    WayColumns,
    WayRoom,
    acceleration_of,
    place_at,
    seen_from,
    slack_of,
)
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.tree_kernels import joint_frames

PARTED = 4  # couples of convex bodies that are parted by a direction each before a pair is looked at more closely
MOST_PIECES = 8  # of a stretch at whose ends two bodies are looked at along one direction
AHEAD = 8  # places of many stretches that are looked at before all of them are
TOGETHER = 64  # stretches that one direction is tried on: more of them are halved first, which costs less than to fail


class PairSearch(NamedTuple):
    """Pairs of bodies, roots of trees (p, 2), that a way of joints moves; room to work in.

    `frames` (s, j, 4, 4) are those of the joints at the nodes `held` (s,) of the way, which are asked for again and
    again; `swing` (j,) is how far each joint goes from where a pair is looked at, which is in `descent`. `room` holds
    poses at other places.
    """

    roots: Ints
    couple: Couple
    chain: JointTree
    way: WayColumns
    forest: Forest
    bodies: Convexes
    descent: Descent
    held: Ints
    frames: Array
    swing: Array
    room: WayRoom
    gaps: GapRoom


@kernel
def frames_at(k: int, search: PairSearch) -> int:
    """The row of ``search.frames`` with the frames of the joints at node `k`."""
    chain, q = search.chain, search.room.q
    row: int = k % search.held.shape[0]
    if search.held[row] != k:
        for j in range(q.shape[0]):
            q[j] = search.way.q[k, j]
        joint_frames(q, chain.parent, chain.before, chain.axis, chain.prismatic, search.frames[row])
        search.held[row] = k
    return row


@kernel
def look_at(p: int, k: int, search: PairSearch) -> None:
    """Look at a pair at node `k`."""
    frames, couple = search.frames[frames_at(k, search)], search.couple
    seen_from(frames, couple.common[p], couple.first[p], search.descent.Xa)
    seen_from(frames, couple.common[p], couple.second[p], search.descent.Xb)


@kernel
def place_at_node(p: int, k: int, search: PairSearch) -> None:
    """Poses of both bodies of a pair at node `k`, in ``search.room``."""
    frames, couple = search.frames[frames_at(k, search)], search.couple
    seen_from(frames, couple.common[p], couple.first[p], search.room.Xa)
    seen_from(frames, couple.common[p], couple.second[p], search.room.Xb)


@kernel
def look_in(p: int, k: int, share: float, search: PairSearch) -> None:
    """Look at a pair at a share of a stretch."""
    room, descent = search.room, search.descent
    place_at(p, k, share, search.couple, search.chain, search.way, room)
    for r in range(4):
        for c in range(4):
            descent.Xa[r, c], descent.Xb[r, c] = room.Xa[r, c], room.Xb[r, c]


@kernel
def look_between(p: int, k: int, first: float, last: float, search: PairSearch) -> float:
    """Look at a pair in the middle between two shares of a stretch; how far [m] a point is from there at most."""
    way = search.way
    look_in(p, k, 0.5 * (first + last), search)
    for j in range(way.q.shape[1]):
        search.swing[j] = 0.5 * (last - first) * abs(way.q[k + 1, j] - way.q[k, j]) + way.bend[k, j]
    return range_of(p, search)


@kernel
def swing_about(lo: int, hi: int, m: int, search: PairSearch) -> None:
    """How far each joint goes from node `m` on the stretches from `lo` to `hi`."""
    way = search.way
    for j in range(way.q.shape[1]):
        most, bend = 0.0, 0.0
        for k in range(lo, hi + 1):
            most = max(most, abs(way.q[k, j] - way.q[m, j]))
        for k in range(lo, hi):
            bend = max(bend, way.bend[k, j])
        search.swing[j] = most + bend


@kernel
def range_of(p: int, search: PairSearch) -> float:
    """How far [m] a point of one body of a pair may move against the other when joints swing so far."""
    total = 0.0
    for j in range(search.swing.shape[0]):
        total += search.couple.reach[p, j] * search.swing[j]
    return total


@kernel
def gap_seen(p: int, low: float, high: float, search: PairSearch) -> float:
    """The gap [m] of a pair where it is looked at, from `low` to `high`; beyond them as `gap_between`, inf for far."""
    forest, bodies, descent = search.forest, search.bodies, search.descent
    top, least = begin(search.roots[p], descent), math.inf
    while True:
        # no two bodies are nearer than what is around them, so parts farther apart than the least gap do not count
        top = descend(top, min(high, least), forest, bodies, descent)
        if top < 0:
            return least
        a, b = convexes_at(top, forest, descent)
        gap = gap_between(a, b, bodies, descent.Xa, descent.Xb, low, min(high, least), search.gaps, search.room.n)
        least = min(least, gap)
        if least < low:
            return least
        top -= 1


@kernel
def comes_near(p: int, limit: float, search: PairSearch) -> bool:
    """Whether the bodies of a pair are nearer than `limit` [m] where they are looked at."""
    return gap_seen(p, limit, limit, search) < limit


@kernel
def is_free(p: int, stretches: tuple[int, int], level: float, search: PairSearch) -> bool:
    """Whether a pair is above a level on all of some stretches, as is known from where it is looked at.

    A gap changes by no more than the way of one body against the other, and the direction along which it lies may be
    one for all stretches.
    """
    forest, bodies, descent, room = search.forest, search.bodies, search.descent, search.room
    limit = level + range_of(p, search)
    top = begin(search.roots[p], descent)
    count = 0
    while True:
        top = descend(top, limit, forest, bodies, descent)
        if top < 0:
            return True
        a, b = convexes_at(top, forest, descent)
        gap = gap_between(a, b, bodies, descent.Xa, descent.Xb, level, limit, search.gaps, room.n)
        if gap < limit:
            count += 1
            if gap < level or count > PARTED or stretches[1] - stretches[0] > TOGETHER:
                return False
            if not is_above(p, (a, b), stretches, level, search):
                return False
        top -= 1


@kernel
def is_above(p: int, leaf: tuple[int, int], stretches: tuple[int, int], level: float, search: PairSearch) -> bool:
    """Whether the gap of two convex bodies along the direction ``room.n`` stays above a level on some stretches.

    Between two places it is above its chord but for what the bodies' acceleration allows, the square of their distance.
    """
    room, bodies, gaps = search.room, search.bodies, search.gaps
    a, b = leaf
    lo, hi = stretches
    before = math.inf
    if hi - lo > 2 * AHEAD:  # along a long way it mostly is not, which few places show
        for i in range(AHEAD + 1):
            place_at_node(p, lo + (hi - lo) * i // AHEAD, search)
            if gap_along(a, b, bodies, room.Xa, room.Xb, room.n, gaps) < level:
                return False
    for k in range(lo, hi + 1):
        place_at_node(p, k, search)
        gap = gap_along(a, b, bodies, room.Xa, room.Xb, room.n, gaps)
        if gap < level:
            return False
        if k > lo:
            bow = acceleration_of(p, k - 1, search.couple, search.chain, search.way) / 8.0
            room_left = min(before, gap) - level
            if bow > MOST_PIECES * MOST_PIECES * room_left:
                return False
            if bow > room_left:
                pieces = math.ceil(math.sqrt(bow / room_left))
                for i in range(1, pieces):
                    place_at(p, k - 1, i / pieces, search.couple, search.chain, search.way, room)
                    inner = gap_along(a, b, bodies, room.Xa, room.Xb, room.n, gaps)
                    if inner - bow / (pieces * pieces) < level:
                        return False
        before = gap
    return True


@kernel
def corner_shift(i: int, X: Array, Y: Array, forest: Forest) -> float:
    """The greatest way [m] of a corner of the box of node i from pose `X` (4, 4) of its carrier to `Y`."""
    most = 0.0
    for corner in range(8):
        square = 0.0
        for r in range(3):
            d = Y[r, 3] - X[r, 3]
            for c in range(3):
                half = forest.half[i, c] if corner >> c & 1 else -forest.half[i, c]
                d += (Y[r, c] - X[r, c]) * (forest.centre[i, c] + half)
            square += d * d
        most = max(most, square)
    return math.sqrt(most)


@kernel
def shift_on(p: int, stretches: tuple[int, int], most: float, search: PairSearch) -> float:
    """How far [m] the gap of a pair may be, on some stretches, from that where it is looked at; inf beyond `most`.

    Joints that turn against each other move bodies less than the sum of what each does, so bodies are placed at all
    nodes. A body moves no farther than a corner of a box around it; between nodes it leaves the chord by no more than
    its acceleration allows.
    """
    couple, chain, way, forest, room = search.couple, search.chain, search.way, search.forest, search.room
    one, other = search.roots[p, 0], search.roots[p, 1]
    lo, hi = stretches
    shift = 0.0
    for k in range(hi, lo - 1, -1):
        # the last one first, then the first: it mostly is too far there, if anywhere
        node = lo if k == hi - 1 else k if k == hi else k + 1
        place_at_node(p, node, search)
        bow = 0.0
        for stretch in (max(node - 1, lo), min(node, hi - 1)):
            bow = max(bow, acceleration_of(p, stretch, couple, chain, way) / 8.0 + slack_of(p, stretch, couple, way))
        there = corner_shift(one, search.descent.Xa, room.Xa, forest)
        shift = max(shift, there + corner_shift(other, search.descent.Xb, room.Xb, forest) + bow)
        if shift > most:
            return math.inf
    return shift
