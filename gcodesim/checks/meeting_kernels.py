"""Pairs of bodies along a whole joint path: when they meet, how deep, and how near they come.

Stretches of the path are looked at together while the distance of a pair is greater than its bodies can move on them
(adaptive bisection, Schwarzer, Saha and Latombe 2005, IEEE Trans. Robotics 21, 338). What is left goes to
`way_kernels.descend`, one stretch and one couple of convex bodies at a time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.checks.gap_kernels import (
    RELATIVE,
    Convexes,
    GapRoom,
    Ints,
    gap_along,
    gap_between,
    is_nearer,
    signed_gap,
)
from gcodesim.checks.way_kernels import (
    CLOSE,
    GOLDEN,
    NEVER,
    ROUNDS,
    SAMPLES,
    Couple,
    JointTree,
    WayColumns,
    WayRoom,
    acceleration_of,
    descend,
    gap_at,
    place_at,
    place_pair,
    seen_from,
    slack_of,
)
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.tree_kernels import joint_frames

HALVINGS = 12  # of a stretch behind the first contact: a touch of a 4000th of it is looked at
LEVELS = 64
SHARE = 2e-4  # of itself by which a least gap may be too large, besides the tolerance
WINDOW = 1e-3  # [m] by which two bodies are above a level when their gap is not worked out
AGAIN = 2  # samples on a stretch that begins in contact
DEEPER = 5e-6  # [m] by which bodies must be deeper in each other than known for it to be worth a look: less than what
# the way is known to
FEW = 24  # couples of convex bodies that are looked at one by one on a piece of a stretch
SHORTEST = 1.0 / 256.0  # of a stretch: pieces are no shorter
LEAST_SHARE = 0.05  # of such a stretch, up to which the place of the least gap is sought


class Forest(NamedTuple):
    """Bodies as trees of balls: node i has its ball at `centre` (n, 3) with `radius` (n,) in the frame of its carrier.

    All of it is also in a box about the same centre along the axes of that frame, with half sides `half` (n, 3): plates
    and beams fill little of their balls. `left`, `right` are its parts; a leaf has -1 there and its convex body in
    `convex`.
    """

    centre: Array
    radius: Array
    half: Array
    left: Ints
    right: Ints
    convex: Ints


class Meetings(NamedTuple):
    """Room for what is found, a row each: pair, first stretch, last, deepest, both convex bodies.

    `figures`: the share at which the gap falls to the level, at which it is least, that gap [m]. `used` (1,) rows.
    """

    rows: Ints
    figures: Array
    used: Ints


class Walk(NamedTuple):
    """Room to work in: pairs by level of bisection and how many; intervals; two trees; poses; state of each pair.

    Of a pair below the level, `ended` (p,) is its gap [m] at the end of the stretch that was `last`, inf if nobody has
    looked there; `sinks` (p,) says that it is the least so far, found there without a look at what lies just before.
    `way` (3,) is from the middle of one node to that of another.
    """

    alive: Ints
    many: Ints
    intervals: Ints
    nodes: Ints
    Xa: Array
    Xb: Array
    swing: Array
    last: Ints
    open: Ints
    ended: Array
    sinks: Ints
    best: Array
    way: Array


def walk_room(pairs: int, joints: int, deepest: int) -> Walk:
    """Room for `meet`; `deepest` is how many nodes the two deepest trees have on a way from the root."""
    return Walk(
        np.zeros((LEVELS, pairs), dtype=np.int64),
        np.zeros(LEVELS, dtype=np.int64),
        np.zeros((2 * LEVELS, 3), dtype=np.int64),
        np.zeros((2 * deepest + 8, 2), dtype=np.int64),
        np.zeros((4, 4)),
        np.zeros((4, 4)),
        np.zeros(joints),
        np.full(pairs, -2, dtype=np.int64),
        np.full(pairs, -1, dtype=np.int64),
        np.zeros(pairs),
        np.zeros(pairs, dtype=np.int64),
        np.zeros(1),
        np.zeros(3),
    )


@kernel
def beside_box(half: Array, i: int, X: Array, way: Array, far: float) -> bool:
    """Whether a point is farther than `far` [m] from the box of node i, whose carrier stands at `X`.

    `way` (3,) leads from the middle of the one to the other, either way, in the world.
    """
    if far < 0.0:
        return False
    square = 0.0
    for k in range(3):
        d = abs(X[0, k] * way[0] + X[1, k] * way[1] + X[2, k] * way[2]) - half[i, k]
        if d > 0.0:
            square += d * d
    return square > far * far


@kernel
def next_leaves(top: int, limit: float, forest: Forest, nodes: Ints, Xa: Array, Xb: Array, way: Array) -> int:
    """Go on to two leaves whose balls and boxes are nearer than `limit`: they are on top of `nodes` then; -1: no more.

    `way` (3,) is room to work in.
    """
    centre, radius, left = forest.centre, forest.radius, forest.left
    while top >= 0:
        i, j = nodes[top, 0], nodes[top, 1]
        square = 0.0
        for c in range(3):
            d = Xa[c, 3] - Xb[c, 3]
            for k in range(3):
                d += Xa[c, k] * centre[i, k] - Xb[c, k] * centre[j, k]
            way[c] = d
            square += d * d
        far = limit + radius[i] + radius[j]
        if far < 0.0 or square > far * far:
            top -= 1
            continue
        if radius[i] >= radius[j]:
            is_far = beside_box(forest.half, i, Xa, way, limit + radius[j])
        else:
            is_far = beside_box(forest.half, j, Xb, way, limit + radius[i])
        if is_far:
            top -= 1
            continue
        if left[i] < 0 and left[j] < 0:
            return top
        if left[j] < 0 or (left[i] >= 0 and radius[i] >= radius[j]):
            nodes[top, 0], nodes[top + 1, 0] = left[i], forest.right[i]
            nodes[top + 1, 1] = j
        else:
            nodes[top, 1], nodes[top + 1, 1] = left[j], forest.right[j]
            nodes[top + 1, 0] = i
        top += 1
    return -1


@kernel
def come_near(
    pair: Ints, limit: float, forest: Forest, bodies: Convexes, walk: Walk, gaps: GapRoom, n: Array, least: bool
) -> bool:
    """Whether two bodies at the poses of `walk` are nearer than `limit`; if `least`, keep the least gap in its best."""
    nodes = walk.nodes
    nodes[0, 0], nodes[0, 1] = pair[0], pair[1]
    top = 0
    near = False
    while True:
        top = next_leaves(top, limit, forest, nodes, walk.Xa, walk.Xb, walk.way)
        if top < 0:
            return near
        a, b = forest.convex[nodes[top, 0]], forest.convex[nodes[top, 1]]
        if not least:
            if is_nearer(a, b, bodies, walk.Xa, walk.Xb, limit, gaps, n):
                return True
        else:
            gap = signed_gap(a, b, bodies, walk.Xa, walk.Xb, limit, gaps, n)
            if gap < limit:
                near = True
                walk.best[0] = min(walk.best[0], gap)
        top -= 1


@kernel
def swings(lo: int, hi: int, m: int, way: WayColumns, swing: Array) -> None:
    """How far (j,) each joint goes from node `m` on the stretches from `lo` to `hi`."""
    for j in range(way.q.shape[1]):
        most, bend = 0.0, 0.0
        for k in range(lo, hi + 1):
            most = max(most, abs(way.q[k, j] - way.q[m, j]))
        for k in range(lo, hi):
            bend = max(bend, way.bend[k, j])
        swing[j] = most + bend


@kernel
def range_of(p: int, couple: Couple, swing: Array) -> float:
    """How far [m] a point of one body of a pair may move against the other when joints swing so far."""
    total = 0.0
    for j in range(swing.shape[0]):
        total += couple.reach[p, j] * swing[j]
    return total


@kernel
def least_gap(
    p: int,
    pair: Ints,
    place: tuple[int, float, float],
    couple: Couple,
    chain: JointTree,
    way: WayColumns,
    forest: Forest,
    bodies: Convexes,
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
) -> float:
    """The signed gap [m] of two bodies at a share of a stretch; inf when the balls around them are far apart.

    `place` ends with a level: far is more than `WINDOW` above it.
    """
    room, gaps = rooms
    k, t, level = place
    place_at(p, k, t, couple, chain, way, room)
    nodes = walk.nodes
    nodes[0, 0], nodes[0, 1] = pair[0], pair[1]
    top, least = 0, math.inf
    window = WINDOW + max(level, 0.0)
    while True:
        # no two bodies are nearer than the balls around them, so parts farther apart than the least gap do not count
        top = next_leaves(top, min(window, least), forest, nodes, room.Xa, room.Xb, walk.way)
        if top < 0:
            return least
        a, b = forest.convex[nodes[top, 0]], forest.convex[nodes[top, 1]]
        least = min(least, signed_gap(a, b, bodies, room.Xa, room.Xb, math.inf, gaps, room.n))
        top -= 1


@kernel
def seen_between(
    p: int,
    k: int,
    begin: float,
    end: float,
    couple: Couple,
    chain: JointTree,
    way: WayColumns,
    walk: Walk,
    room: WayRoom,
) -> float:
    """Poses of `walk` in the middle between two shares of a stretch, and how far [m] a point may be from there."""
    place_at(p, k, 0.5 * (begin + end), couple, chain, way, room)
    walk.Xa[:], walk.Xb[:] = room.Xa, room.Xb
    for j in range(way.q.shape[1]):
        walk.swing[j] = 0.5 * (end - begin) * abs(way.q[k + 1, j] - way.q[k, j]) + way.bend[k, j]
    return range_of(p, couple, walk.swing)


@kernel
def couples_within(
    pair: Ints, limit: float, forest: Forest, bodies: Convexes, walk: Walk, gaps: GapRoom, n: Array, most: int
) -> int:
    """How many couples of convex bodies are nearer than `limit` at the poses of `walk`; counted up to `most`."""
    nodes = walk.nodes
    nodes[0, 0], nodes[0, 1] = pair[0], pair[1]
    top, count = 0, 0
    while count < most:
        top = next_leaves(top, limit, forest, nodes, walk.Xa, walk.Xb, walk.way)
        if top < 0:
            return count
        a, b = forest.convex[nodes[top, 0]], forest.convex[nodes[top, 1]]
        if is_nearer(a, b, bodies, walk.Xa, walk.Xb, limit, gaps, n):
            count += 1
        top -= 1
    return count


@kernel
def first_on(
    p: int,
    pair: Ints,
    place: tuple[int, float, float],
    couple: Couple,
    chain: JointTree,
    way: WayColumns,
    forest: Forest,
    bodies: Convexes,
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
) -> tuple[float, int, int, float]:
    """Where on a stretch two bodies first come to a level: share, both convex bodies, the gap [m].

    Bodies of many parts are looked at on pieces of the stretch, so short that few couples of parts may meet on one.
    """
    room, gaps = rooms
    k, begin, level = place
    width = 1.0 - begin
    nodes = walk.nodes
    first, one, other, deep = NEVER, -1, -1, 0.0
    while True:
        end = 1.0 if begin + width >= 1.0 else begin + width
        limit = seen_between(p, k, begin, end, couple, chain, way, walk, room) + level + CLOSE
        count = couples_within(pair, limit, forest, bodies, walk, gaps, room.n, FEW + 1)
        if count > FEW and width > SHORTEST:
            width *= 0.5
            continue
        nodes[0, 0], nodes[0, 1] = pair[0], pair[1]
        top = 0 if count > 0 else -1
        while True:
            top = next_leaves(top, limit, forest, nodes, walk.Xa, walk.Xb, walk.way)
            if top < 0:
                break
            a, b = forest.convex[nodes[top, 0]], forest.convex[nodes[top, 1]]
            if is_nearer(a, b, bodies, walk.Xa, walk.Xb, limit, gaps, room.n):
                near = k, begin, level, min(first, end)
                share, gap = descend(p, a, b, near, couple, chain, way, bodies, rooms)
                if share < first:
                    first, one, other, deep = share, a, b, gap
            top -= 1
        if first <= end or end >= 1.0:
            return first, one, other, deep
        begin, width = end, 2.0 * width


@kernel
def is_above(
    p: int,
    leaf: tuple[int, int],
    stretches: tuple[int, int],
    level: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    rooms: tuple[WayRoom, GapRoom],
) -> bool:
    """Whether the gap of two convex bodies along the direction ``room.n`` stays above a level on some stretches.

    Between the ends of a stretch it is above its chord but for what the bodies' acceleration allows.
    """
    couple, chain, way, _, bodies = scene
    room, gaps = rooms
    a, b = leaf
    lo, hi = stretches
    before = math.inf
    for k in range(lo, hi + 1):
        for j in range(way.q.shape[1]):
            room.q[j] = way.q[k, j]
        place_pair(p, couple, chain, room)
        gap = gap_along(a, b, bodies, room.Xa, room.Xb, room.n, gaps)
        if gap < level:
            return False
        if k > lo and min(before, gap) - acceleration_of(p, k - 1, couple, chain, way) / 8.0 < level:
            return False
        before = gap
    return True


@kernel
def least_known(e: int, level: float, found: Meetings) -> float:
    """The gap [m] below which a gap is worth a look: the least of a row so far, but for what makes no difference."""
    least: float = found.figures[e, 2]
    return least - DEEPER - RELATIVE * abs(least) if level <= 0.0 else least


@kernel
def deepest_of(
    p: int,
    pair: Ints,
    stretches: tuple[int, int],
    bounds: tuple[float, float, float],
    enough: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
) -> float:
    """A gap [m] of two bodies at the poses of `walk`, if it is above some level on all of some stretches; else NaN.

    It is not above `enough` only if the true one is not. `bounds`: that level, how much a gap may change on the
    stretches, and a gap from which on nothing counts. Where a gap may change too much, the direction in which bodies
    are to be parted here may still be one for all stretches.
    """
    _, _, _, forest, bodies = scene
    room, gaps = rooms
    least, between, limit = bounds
    nodes = walk.nodes
    nodes[0, 0], nodes[0, 1] = pair[0], pair[1]
    top, deepest = 0, math.inf
    while True:
        top = next_leaves(top, limit, forest, nodes, walk.Xa, walk.Xb, walk.way)
        if top < 0:
            return deepest
        a, b = forest.convex[nodes[top, 0]], forest.convex[nodes[top, 1]]
        gap = gap_between(a, b, bodies, walk.Xa, walk.Xb, least + between, enough, gaps, room.n)
        deepest = min(deepest, gap)
        if gap < least + between and not is_above(p, (a, b), stretches, least, scene, rooms):
            return math.nan
        top -= 1


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
def shift_on(
    p: int,
    pair: Ints,
    stretches: tuple[int, int],
    most: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
) -> float:
    """How far [m] the gap of two bodies may be, on some stretches, from that at the poses of `walk`; inf beyond `most`.

    Joints that turn against each other move bodies less than the sum of what each does, so bodies are placed at all
    nodes. A body moves no farther than a corner of a box around it; between nodes it leaves the chord by no more than
    its acceleration allows.
    """
    couple, chain, way, forest, _ = scene
    room, _ = rooms
    lo, hi = stretches
    shift = 0.0
    for k in range(hi, lo - 1, -1):
        # the last one first, then the first: it mostly is too far there, if anywhere
        node = lo if k == hi - 1 else k if k == hi else k + 1
        for j in range(way.q.shape[1]):
            room.q[j] = way.q[node, j]
        place_pair(p, couple, chain, room)
        bow = 0.0
        for stretch in (max(node - 1, lo), min(node, hi - 1)):
            bow = max(bow, acceleration_of(p, stretch, couple, chain, way) / 8.0 + slack_of(p, stretch, couple, way))
        there = corner_shift(pair[0], walk.Xa, room.Xa, forest) + corner_shift(pair[1], walk.Xb, room.Xb, forest)
        shift = max(shift, there + bow)
        if shift > most:
            return math.inf
    return shift


@kernel
def stays(
    p: int,
    pair: Ints,
    stretches: tuple[int, int],
    level: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
    found: Meetings,
) -> bool:
    """Whether a pair that begins some stretches below the level stays so and is nowhere deeper than it has been.

    The bodies are at the poses of `walk` at a node of these stretches, and joints swing by ``walk.swing`` about it; a
    gap changes by no more than the ways of both bodies.
    """
    lo, hi = stretches
    e = walk.open[p]
    if e < 0 or walk.last[p] != lo - 1 or walk.sinks[p] > 0:
        return False
    least = least_known(e, level, found)
    between = min(range_of(p, scene[0], walk.swing), shift_on(p, pair, stretches, level - least, scene, walk, rooms))
    if least + between > level:
        return False
    enough = level - between
    limit = max(least + between, enough)
    deepest = deepest_of(p, pair, stretches, (least, between, limit), enough, scene, walk, rooms)
    if not deepest <= enough:
        return False
    walk.last[p], walk.ended[p], found.rows[e, 2] = hi - 1, math.inf, hi - 1
    return True


@kernel
def goes_on(
    p: int,
    pair: Ints,
    place: tuple[int, float, float],
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
    found: Meetings,
) -> bool:
    """Whether a pair that begins a stretch below the level stays so all along it, as one gap at its end shows.

    A gap changes by no more than the way of one body against the other; between the ends of the stretch it is within
    half of that way of one of them. Where the end is the least so far it is kept in the row of the pair, and what lies
    just before it waits until the gap has begun to grow. False also where something deeper may lie in between.
    """
    couple, chain, way, forest, bodies = scene
    k, t, level = place
    if t > 0.0:
        return False
    for j in range(way.q.shape[1]):
        walk.swing[j] = abs(way.q[k + 1, j] - way.q[k, j])
    between = 0.5 * range_of(p, couple, walk.swing)
    begin = walk.ended[p]
    if begin == math.inf:
        begin = least_gap(p, pair, (k, 0.0, level), couple, chain, way, forest, bodies, walk, rooms)
    if begin + between > level:
        return False
    if walk.sinks[p] == 0 and begin - between < least_known(walk.open[p], level, found):
        return False
    end = least_gap(p, pair, (k, 1.0, level), couple, chain, way, forest, bodies, walk, rooms)
    if end + between > level:
        return False
    e = walk.open[p]
    least = least_known(e, level, found)
    if end < found.figures[e, 2]:
        found.figures[e, 1], found.figures[e, 2], found.rows[e, 3] = 1.0, end, k
    if end < least:
        walk.sinks[p] = 1
    elif walk.sinks[p] > 0 or min(begin, end) - between < least:
        return False
    walk.ended[p] = end
    found.rows[e, 2] = k
    return True


@kernel
def deepen(
    p: int,
    pair: Ints,
    place: tuple[int, float, float],
    bracket: tuple[float, float, float, float],
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
    found: Meetings,
) -> None:
    """Look for the least gap between two shares of a stretch by golden section, and keep it in the row of the pair.

    `bracket`: both shares, how near they come to each other at last, and the least gap known there, that of `place`.
    """
    couple, chain, way, forest, bodies = scene
    k, at, level = place
    low, high, enough, best = bracket
    left, right, known = low, high, 0  # which of the two inner places was one of the round before: 1 left, 2 right
    at_left = at_right = math.inf
    for _ in range(ROUNDS):
        if high - low < enough:
            break
        if known != 1:
            left = high - GOLDEN * (high - low)
            at_left = least_gap(p, pair, (k, left, level), couple, chain, way, forest, bodies, walk, rooms)
        if known != 2:
            right = low + GOLDEN * (high - low)
            at_right = least_gap(p, pair, (k, right, level), couple, chain, way, forest, bodies, walk, rooms)
        if at_left < best:
            best, at = at_left, left
        if at_right < best:
            best, at = at_right, right
        if at_left <= at_right:
            high, right, at_right, known = right, left, at_left, 2
        else:
            low, left, at_left, known = left, right, at_right, 1
    e = walk.open[p]
    if best < found.figures[e, 2]:
        found.figures[e, 1], found.figures[e, 2] = at, best
        found.rows[e, 3] = k


@kernel
def follow(
    p: int,
    pair: Ints,
    place: tuple[int, float, float],
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
    found: Meetings,
    fresh: bool,
) -> float:
    """Follow a pair that is below the level from a share of a stretch on; where it is above again, or 1.

    The least gap is kept in the row of the pair, found between samples by golden section.
    """
    couple, chain, way, forest, bodies = scene
    k, t, level = place
    if not fresh and goes_on(p, pair, place, scene, walk, rooms, found):
        return 1.0
    if not fresh and walk.sinks[p] > 0:
        deepen(p, pair, (k - 1, 1.0, level), (0.0, 1.0, 0.5 * LEAST_SHARE, walk.ended[p]), scene, walk, rooms, found)
    walk.sinks[p] = 0
    count = HALVINGS + SAMPLES if fresh else AGAIN
    best, before, after, past, end = math.inf, t, 1.0, t, 1.0
    at = t
    pending = False
    gap = at_begin = at_middle = math.inf
    for i in range(count + 1):
        if i == 0:
            here = t
        elif fresh and i <= HALVINGS:
            here = t + (1.0 - t) * 2.0 ** (i - HALVINGS - 4)
        elif fresh:
            here = t + (1.0 - t) * (i - HALVINGS) / SAMPLES
        else:
            here = t + (1.0 - t) * i / AGAIN
        at_begin, at_middle = at_middle, gap
        if i == 0 and t == 0.0 and not fresh and walk.ended[p] < math.inf:
            gap = walk.ended[p]
        else:
            gap = least_gap(p, pair, (k, here, level), couple, chain, way, forest, bodies, walk, rooms)
        if pending:
            after = here
            pending = False
        if gap < best:
            best, at, before = gap, here, past
            pending = True
        past = here
        if i > 0 and gap > level + CLOSE:
            end = here
            break
    walk.ended[p] = gap
    if pending:
        after = past
    e = walk.open[p]
    found.rows[e, 2] = k
    if not fresh and end >= 1.0:
        # the gap of two convex bodies that shift is a convex function: it is above the lines that lead to the middle
        least = least_known(e, level, found)
        sinks = best == gap and best < least
        if sinks or at_middle - max(at_begin - at_middle, gap - at_middle, 0.0) >= least:
            walk.sinks[p] = 1 if sinks and t == 0.0 else 0
            if best < found.figures[e, 2]:
                found.figures[e, 1], found.figures[e, 2], found.rows[e, 3] = at, best, k
            if not sinks or t == 0.0:
                return end
    enough = 1e-9 if fresh else LEAST_SHARE
    deepen(p, pair, (k, at, level), (before, after, enough, best), scene, walk, rooms, found)
    return end


@kernel
def meet_on(
    p: int,
    pair: Ints,
    place: tuple[int, float],
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
    found: Meetings,
) -> None:
    """What two bodies do on one stretch: rows of `found` for each time that they come below a level."""
    couple, chain, way, forest, bodies = scene
    k, level = place
    if walk.last[p] != k - 1:
        walk.open[p] = -1
    t = 0.0
    while t < 1.0:
        fresh = walk.open[p] < 0
        if fresh:
            first, a, b, gap = first_on(p, pair, (k, t, level), couple, chain, way, forest, bodies, walk, rooms)
            if first > 1.0 or found.used[0] >= found.rows.shape[0]:
                break
            e = found.used[0]
            found.used[0] += 1
            walk.open[p] = e
            found.rows[e, 0], found.rows[e, 1], found.rows[e, 2], found.rows[e, 3] = p, k, k, k
            found.rows[e, 4], found.rows[e, 5] = a, b
            found.figures[e, 0], found.figures[e, 1], found.figures[e, 2] = first, first, gap
            t = first
            if first >= 1.0:
                walk.last[p] = k
                break
        lower = level - (slack_of(p, k, couple, way) if level <= 0.0 else 0.0)
        end = follow(p, pair, (k, t, lower), scene, walk, rooms, found, fresh)
        walk.last[p] = k
        if end >= 1.0:
            break
        walk.open[p] = -1
        t = end


@kernel
def below(least: float, tolerance: float) -> float:
    """What a gap must be less than to count as less than `least`."""
    return least - tolerance - SHARE * abs(least) if least < math.inf else least


@kernel
def nearest_on(
    p: int,
    pair: Ints,
    k: int,
    tolerance: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
) -> None:
    """Lower the least gap in ``walk.best`` to that of two bodies on one stretch, if theirs is less by `tolerance`."""
    couple, chain, way, forest, bodies = scene
    t = 0.0
    while True:
        level = below(walk.best[0], tolerance)
        first, a, b, gap = first_on(p, pair, (k, t, level), couple, chain, way, forest, bodies, walk, rooms)
        if first > 1.0:
            return
        walk.best[0] = min(walk.best[0], gap)
        t = first
        # a good bound first, so that little is left to prove
        low, high = t, 1.0
        for _ in range(ROUNDS):
            left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
            at_left = gap_at(p, a, b, (k, left), couple, chain, way, bodies, rooms)
            at_right = gap_at(p, a, b, (k, right), couple, chain, way, bodies, rooms)
            walk.best[0] = min(walk.best[0], at_left, at_right)
            if at_left <= at_right:
                high = right
            else:
                low = left


@kernel
def meet(
    pairs: Ints,
    level: float,
    tolerance: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    walk: Walk,
    rooms: tuple[WayRoom, GapRoom],
    found: Meetings,
) -> None:
    """Every time that one of `pairs` (p, 2), roots of trees, comes below `level` [m] on the way.

    With a `tolerance` [m] above 0, the least gap of all pairs in ``walk.best`` instead, up to that.
    """
    couple, chain, way, forest, bodies = scene
    room, gaps = rooms
    count, intervals = walk.many, walk.intervals
    count[0] = pairs.shape[0]
    for i in range(pairs.shape[0]):
        walk.alive[0, i] = i
    intervals[0, 0], intervals[0, 1], intervals[0, 2] = 0, way.bend.shape[0], 0
    top = 0
    while top >= 0:
        lo, hi, deep = intervals[top, 0], intervals[top, 1], intervals[top, 2]
        top -= 1
        m = (lo + hi) // 2
        swings(lo, hi, m, way, walk.swing)
        moved = True
        kept = 0
        for i in range(count[deep]):
            p = walk.alive[deep, i]
            # `stays` has had joints elsewhere
            if moved:
                for j in range(way.q.shape[1]):
                    room.q[j] = way.q[m, j]
                joint_frames(room.q, chain.parent, chain.before, chain.axis, chain.prismatic, room.frames)
                moved = False
            seen_from(room.frames, couple.common[p], couple.first[p], walk.Xa)
            seen_from(room.frames, couple.common[p], couple.second[p], walk.Xb)
            if tolerance <= 0.0 and walk.open[p] >= 0:
                if stays(p, pairs[p], (lo, hi), level, scene, walk, rooms, found):
                    moved = True
                    continue
                moved = True
            at = below(walk.best[0], tolerance) if tolerance > 0.0 else level
            limit = range_of(p, couple, walk.swing) + at + CLOSE
            if come_near(pairs[p], limit, forest, bodies, walk, gaps, room.n, tolerance > 0.0):
                walk.alive[deep + 1, kept] = p
                kept += 1
        count[deep + 1] = kept
        if kept == 0:
            continue
        if hi - lo > 1:
            intervals[top + 1, 0], intervals[top + 1, 1], intervals[top + 1, 2] = m, hi, deep + 1
            intervals[top + 2, 0], intervals[top + 2, 1], intervals[top + 2, 2] = lo, m, deep + 1
            top += 2
            continue
        for i in range(kept):
            p = walk.alive[deep + 1, i]
            if tolerance > 0.0:
                nearest_on(p, pairs[p], lo, tolerance, scene, walk, rooms)
            else:
                meet_on(p, pairs[p], (lo, level), scene, walk, rooms, found)


@kernel
def beginning(
    p: int,
    a: int,
    b: int,
    place: tuple[int, float],
    before: float,
    scene: tuple[Couple, JointTree, WayColumns, Forest, Convexes],
    rooms: tuple[WayRoom, GapRoom],
) -> float:
    """Share of a stretch at which two convex bodies touch that are in each other at `place`, not before `before`."""
    couple, chain, way, _, bodies = scene
    k, high = place
    low = before
    if gap_at(p, a, b, (k, low), couple, chain, way, bodies, rooms) <= 0.0:
        return low
    for _ in range(ROUNDS):
        middle = 0.5 * (low + high)
        if gap_at(p, a, b, (k, middle), couple, chain, way, bodies, rooms) > 0.0:
            low = middle
        else:
            high = middle
    return high
