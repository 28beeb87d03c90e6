"""Two convex bodies along one stretch of a joint path: where their gap first falls below a level, and how far it falls.

The joints of a stretch run evenly from one end to the other. A point of a body then leaves the chord between two of
its places by no more than its greatest acceleration allows, so the gap along a fixed direction, known at both ends,
is bounded in between: no contact can hide between two places that were looked at (conservative advancement, Mirtich
1996, with the second-order bound of linear interpolation).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.checks.gap_kernels import Convexes, GapRoom, Ints, gap_along, signed_gap
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.tree_kernels import joint_frames

CLOSE = 5e-7  # [m] a gap this little above the level counts as below it
TRIES = 5  # lengths of a step that are compared
SAMPLES = 8  # places at which a gap below the level is looked at, besides those close to its beginning
GOLDEN = 0.6180339887498949
ROUNDS = 32
NEVER = 2.0


class JointTree(NamedTuple):
    """The joints of the mover: parts of `kinematics.Tree`."""

    parent: Ints
    before: Array
    axis: Array
    prismatic: Ints


class Couple(NamedTuple):
    """Pairs of bodies (p,): what carries either, the joint that carries both (-1: the base), and bounds (p, j).

    `first`, `second` are joints, -1 the base. `reach` [m]: how far a point of the body that joint j moves against the
    other one may be from the joint; 0 where it moves none, 1 for joints that shift. `side`: 1, 2 or 0, which it moves.
    """

    first: Ints
    second: Ints
    common: Ints
    reach: Array
    side: Ints


class WayColumns(NamedTuple):
    """Joints `q` (n + 1, j) at the ends of n stretches, and `bend` (n, j): how far they may leave the straight line."""

    q: Array
    bend: Array


class WayRoom(NamedTuple):
    """Room to work in: joints, their frames, poses of both bodies (also earlier ones), directions."""

    q: Array
    frames: Array
    Xa: Array
    Xb: Array
    n: Array
    best: Array


def way_room(joints: int) -> WayRoom:
    """Room for `advance`."""
    return WayRoom(
        np.zeros(joints),
        np.zeros((joints, 4, 4)),
        np.zeros((4, 4)),
        np.zeros((4, 4)),
        np.zeros(3),
        np.zeros(3),
    )


@kernel
def seen_from(frames: Array, common: int, carrier: int, out: Array) -> None:
    """Pose `out` (4, 4) of joint `carrier` seen from joint `common`; -1 is the base."""
    for r in range(4):
        for c in range(4):
            out[r, c] = 1.0 if r == c else 0.0
    if carrier == common:
        return
    if common < 0:
        for r in range(3):
            for c in range(4):
                out[r, c] = frames[carrier, r, c]
        return
    for r in range(3):
        for c in range(3):
            out[r, c] = 0.0
            for k in range(3):
                out[r, c] += frames[common, k, r] * frames[carrier, k, c]
        for k in range(3):
            out[r, 3] += frames[common, k, r] * (frames[carrier, k, 3] - frames[common, k, 3])


@kernel
def place_pair(p: int, couple: Couple, chain: JointTree, room: WayRoom) -> None:
    """Poses of both bodies of pair `p` with the joints at ``room.q``."""
    joint_frames(room.q, chain.parent, chain.before, chain.axis, chain.prismatic, room.frames)
    seen_from(room.frames, couple.common[p], couple.first[p], room.Xa)
    seen_from(room.frames, couple.common[p], couple.second[p], room.Xb)


@kernel
def place_at(p: int, k: int, t: float, couple: Couple, chain: JointTree, way: WayColumns, room: WayRoom) -> None:
    """Poses of both bodies of pair `p` at share `t` of stretch `k`."""
    for j in range(way.q.shape[1]):
        room.q[j] = way.q[k, j] + t * (way.q[k + 1, j] - way.q[k, j])
    place_pair(p, couple, chain, room)


@kernel
def slack_of(p: int, k: int, couple: Couple, way: WayColumns) -> float:
    """How far [m] the bodies of pair `p` may be from where the straight way of the joints on stretch `k` puts them."""
    slack = 0.0
    for j in range(way.q.shape[1]):
        slack += couple.reach[p, j] * way.bend[k, j]
    return slack


@kernel
def acceleration_of(p: int, k: int, couple: Couple, chain: JointTree, way: WayColumns) -> float:
    """Bound of the second derivative of the gap along a fixed direction, by the share of stretch `k` [m].

    A joint turned by q_i that carries one turned by q_k: d²x/dq_i dq_k is not longer than the distance from joint k.
    """
    total, turned_first, turned_second = 0.0, 0.0, 0.0
    for j in range(way.q.shape[1]):
        side = couple.side[p, j]
        step = abs(way.q[k + 1, j] - way.q[k, j])
        if side == 0 or step == 0.0:
            continue
        inner = turned_first if side == 1 else turned_second
        if chain.prismatic[j] == 0:
            total += step * couple.reach[p, j] * (step + 2.0 * inner)
            if side == 1:
                turned_first += step
            else:
                turned_second += step
        else:
            total += 2.0 * step * couple.reach[p, j] * inner
    return total


@kernel
def free_share(gap: float, other: float, bend: float, step: float) -> float:
    """How much of a step is free when its gap above the level is `gap` at its start and `other` at its end.

    In between it is above gap + (other - gap) x / step - bend x (step - x) / 2.
    """
    # f(x) = A x² + B x + gap has its first root in the step, or none
    a = 0.5 * bend
    b = (other - gap) / step - a * step
    if a <= 0.0:
        if other > 0.0:
            return step
        return min(gap / (gap - other) * step, step)
    square = b * b - 4.0 * a * gap
    if square <= 0.0 or b >= 0.0:
        return step
    root = 2.0 * gap / (-b + math.sqrt(square))
    return min(root, step)


@kernel
def advance(
    p: int,
    a: int,
    b: int,
    place: tuple[int, float, float, float],
    couple: Couple,
    chain: JointTree,
    way: WayColumns,
    bodies: Convexes,
    rooms: tuple[WayRoom, GapRoom],
) -> tuple[float, float]:
    """Share of a stretch at which the gap of convex bodies `a` and `b` first falls to a level, and that gap [m].

    `place`: the stretch, the share from which on, the level, the share from which on it does not matter. `NEVER` when
    it stays above until then. Nothing below the level is
    passed over: the way is looked at so closely that the gap along one direction stays above it in between.
    """
    room, gaps = rooms
    k, t, level, enough = place
    bend = acceleration_of(p, k, couple, chain, way)
    level -= slack_of(p, k, couple, way) if level <= 0.0 else 0.0
    while True:
        place_at(p, k, t, couple, chain, way, room)
        gap = signed_gap(a, b, bodies, room.Xa, room.Xb, np.inf, gaps, room.n)
        if gap <= level + CLOSE:
            return t, gap
        if t >= min(enough, 1.0):
            return NEVER, gap
        step = 1.0 - t
        best = 0.0
        for _ in range(TRIES):
            place_at(p, k, t + step, couple, chain, way, room)
            other = gap_along(a, b, bodies, room.Xa, room.Xb, room.n, gaps)
            free = free_share(gap - level, other - level, bend, step)
            best = max(best, free)
            if free >= step:
                break
            step = min(0.5 * step, 2.0 * free)
        t = 1.0 if t + best >= 1.0 else t + max(best, 1e-12)


@kernel
def gap_at(
    p: int,
    a: int,
    b: int,
    place: tuple[int, float],
    couple: Couple,
    chain: JointTree,
    way: WayColumns,
    bodies: Convexes,
    rooms: tuple[WayRoom, GapRoom],
) -> float:
    """The signed gap [m] of convex bodies `a` and `b` of pair `p` at a share of a stretch."""
    room, gaps = rooms
    place_at(p, place[0], place[1], couple, chain, way, room)
    return signed_gap(a, b, bodies, room.Xa, room.Xb, np.inf, gaps, room.n)
