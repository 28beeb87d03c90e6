"""The signed gap between two convex bodies: how far apart they are, or how deep they are in each other.

A body is the hull of corners, or of circles about one axis, grown by a radius: a
ball is one point, a capsule two. It is known by its farthest point in any
direction. Distances come by the method of Gilbert, Johnson and Keerthi (1988,
IEEE J. Robotics and Automation 4, 193), depths by an expanding polytope (van den
Bergen 2001, Proc. Game Developers Conference). Every answer goes with a
direction, and the gap along it is a bound that holds by itself.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.collision_kernels import shrink
from gcodesim.compiled import kernel
from gcodesim.frames import Array

MOST_ROUNDS = 64
NEAR = 1e-8  # [m] a distance is exact to this and
RELATIVE = 1e-6  # to this share of itself
MOST_POINTS = 160  # of the polytope
MOST_FACES = 2 * MOST_POINTS
LEAST = 1e-13  # what a unit vector must have across an axis to count as not along it
FRONT = 1e-10  # [m] a corner this little in front of a face is in its plane
GONE = -1  # in place of the first corner of a face that is no more
ROUND_ENOUGH = 1e-3  # share of the product of three edges that the volume between them has where a polytope may begin
FLAT = 1e-12  # [m] a polytope thinner than this has no inside

Ints = NDArray[np.int64]


class Convexes(NamedTuple):
    """Convex bodies by columns (k,); each stands in a frame of its own.

    Body i has `many` rows of `points` from `first` on: corners (x, y, z), or, if `round`, circles (radius, height, 0)
    about the line through `origin` (k, 3) along `axis` (k, 3). All of it is grown by `grown` [m].
    """

    first: Ints
    many: Ints
    round: Ints
    grown: Array
    origin: Array
    axis: Array
    points: Array


class GapRoom(NamedTuple):
    """Room to work in: simplex, its nearest point, weights, direction, two points, polytope, marks of its faces.

    `owner` (corner, corner) is the face that has the edge from one corner to another; -1: none.
    """

    simplex: Array
    closest: Array
    weight: Array
    d: Array
    point: Array
    spare: Array
    corners: Array
    faces: Ints
    planes: Array
    edges: Ints
    seen: Ints
    heap: Ints
    owner: Ints


def gap_room() -> GapRoom:
    """Room for `gap_between`."""
    return GapRoom(
        np.zeros((4, 3)),
        np.zeros(3),
        np.zeros(4),
        np.zeros(3),
        np.zeros(3),
        np.zeros(3),
        np.zeros((MOST_POINTS, 3)),
        np.zeros((MOST_FACES, 3), dtype=np.int64),
        np.zeros((MOST_FACES, 4)),
        np.zeros((3 * MOST_FACES, 2), dtype=np.int64),
        np.zeros(MOST_FACES, dtype=np.int64),
        np.zeros(MOST_FACES, dtype=np.int64),
        np.zeros((MOST_POINTS, MOST_POINTS), dtype=np.int64),
    )


@kernel(inlined=True)
def farthest(i: int, bodies: Convexes, X: Array, d: Array, sign: float, out: Array) -> float:
    """Farthest point `out` (3,) of body `i` at X (4, 4) in direction `sign` d, and its product with it; not grown."""
    u = sign * (X[0, 0] * d[0] + X[1, 0] * d[1] + X[2, 0] * d[2])
    v = sign * (X[0, 1] * d[0] + X[1, 1] * d[1] + X[2, 1] * d[2])
    w = sign * (X[0, 2] * d[0] + X[1, 2] * d[1] + X[2, 2] * d[2])
    points = bodies.points
    begin, end = bodies.first[i], bodies.first[i] + bodies.many[i]
    best, which = -math.inf, begin
    if bodies.round[i] == 0:
        for k in range(begin, end):
            reach = u * points[k, 0] + v * points[k, 1] + w * points[k, 2]
            if reach > best:
                best, which = reach, k
        x, y, z = points[which, 0], points[which, 1], points[which, 2]
    else:
        ax, ay, az = bodies.axis[i, 0], bodies.axis[i, 1], bodies.axis[i, 2]
        along = ax * u + ay * v + az * w
        cu, cv, cw = u - along * ax, v - along * ay, w - along * az
        # once more: of a direction along the axis only rounding is left, which need not be across it
        rest = ax * cu + ay * cv + az * cw
        cu, cv, cw = cu - rest * ax, cv - rest * ay, cw - rest * az
        across = math.sqrt(cu * cu + cv * cv + cw * cw)
        for k in range(begin, end):
            reach = points[k, 0] * across + points[k, 1] * along
            if reach > best:
                best, which = reach, k
        r = points[which, 0] / across if across > LEAST else 0.0
        h = points[which, 1]
        x = bodies.origin[i, 0] + h * ax + r * cu
        y = bodies.origin[i, 1] + h * ay + r * cv
        z = bodies.origin[i, 2] + h * az + r * cw
    for c in range(3):
        out[c] = X[c, 0] * x + X[c, 1] * y + X[c, 2] * z + X[c, 3]
    value: float = sign * (out[0] * d[0] + out[1] * d[1] + out[2] * d[2])
    return value


@kernel
def of_difference(a: int, b: int, bodies: Convexes, Xa: Array, Xb: Array, d: Array, out: Array, spare: Array) -> float:
    """Farthest point `out` (3,) of body `a` minus body `b` in direction d (3,), and its product with d."""
    value = farthest(a, bodies, Xa, d, 1.0, out) + farthest(b, bodies, Xb, d, -1.0, spare)
    for c in range(3):
        out[c] -= spare[c]
    return value


@kernel
def gap_along(a: int, b: int, bodies: Convexes, Xa: Array, Xb: Array, n: Array, room: GapRoom) -> float:
    """How far [m] body `a` lies beyond body `b` in the direction of the unit vector n; negative: they overlap in it."""
    for c in range(3):
        room.d[c] = -n[c]
    value = of_difference(a, b, bodies, Xa, Xb, room.d, room.point, room.spare)
    gap: float = -value - bodies.grown[a] - bodies.grown[b]
    return gap


@kernel
def approach(
    a: int, b: int, bodies: Convexes, Xa: Array, Xb: Array, low: float, high: float, room: GapRoom, n: Array
) -> tuple[bool, float, int]:
    """Whether two bodies, not grown, are known to be apart, and a bound of their distance [m], along `n` (3,).

    The bound is good as that of `gap_between`, or at least `high`; of a distance below `low` it may be any number from
    the true one to `low`. Not apart is also what only just touches. The last is how many corners of the difference are
    left in ``room.simplex``; if four, the origin is between them.
    """
    closest, simplex, weight, d, point = room.closest, room.simplex, room.weight, room.d, room.point
    size = 0.0
    for c in range(3):
        closest[c] = Xa[c, 3] - Xb[c, 3]
        for k in range(3):
            closest[c] += Xa[c, k] * bodies.origin[a, k] - Xb[c, k] * bodies.origin[b, k]
        size += closest[c] * closest[c]
    if size == 0.0:
        closest[2] = 1.0
    count = 0
    lower = -math.inf
    for _ in range(MOST_ROUNDS):
        size = math.sqrt(closest[0] * closest[0] + closest[1] * closest[1] + closest[2] * closest[2])
        if count > 0 and size <= NEAR:
            break
        if count > 0 and size < low:
            return True, size, count
        for c in range(3):
            d[c] = -closest[c] / size
        bound = -of_difference(a, b, bodies, Xa, Xb, d, point, room.spare)
        if bound > lower:
            lower = bound
            for c in range(3):
                n[c] = -d[c]
        if lower > 0.0 and (lower >= high or (count > 0 and size - lower <= NEAR + RELATIVE * size)):
            return True, lower, count
        known = False
        for i in range(count):
            if simplex[i, 0] == point[0] and simplex[i, 1] == point[1] and simplex[i, 2] == point[2]:
                known = True
        if known:
            break
        for c in range(3):
            simplex[count, c] = point[c]
        count = shrink(simplex, count + 1, closest, weight)
        if count == 4:
            break
    return lower > NEAR, lower, count


@kernel
def gap_between(
    a: int, b: int, bodies: Convexes, Xa: Array, Xb: Array, low: float, high: float, room: GapRoom, n: Array
) -> float:
    """The gap [m] between two bodies, or minus their depth, the least shift that parts them, where it is in a range.

    `n` (3,) is the unit vector from `b` to `a` along which this gap lies. It is never more than the true one, and
    less by `NEAR` and `RELATIVE` at most. Of a gap of `high` or more it may be any smaller number from `high` on, and
    the gap along `n` is no less than that; of one below `low` any greater number below `low`, and `n` says nothing.
    """
    grown: float = bodies.grown[a] + bodies.grown[b]
    is_apart, distance, count = approach(a, b, bodies, Xa, Xb, low + grown, high + grown, room, n)
    if is_apart:
        return distance - grown
    if -grown < low:
        return -grown
    is_around = count == 4 and _take_simplex(room)
    return -_depth(a, b, bodies, Xa, Xb, (-high - grown, -low - grown), is_around, room, n) - grown


@kernel
def signed_gap(a: int, b: int, bodies: Convexes, Xa: Array, Xb: Array, enough: float, room: GapRoom, n: Array) -> float:
    """`gap_between` of a gap that may be as small as it will, and is of no interest from `enough` [m] on."""
    return gap_between(a, b, bodies, Xa, Xb, -math.inf, enough, room, n)


@kernel
def _depth(
    a: int,
    b: int,
    bodies: Convexes,
    Xa: Array,
    Xb: Array,
    limits: tuple[float, float],
    is_around: bool,
    room: GapRoom,
    n: Array,
) -> float:
    """How far [m] the origin is in the difference of two bodies; `n` becomes the way out for `a`.

    Where it is the first of two limits at most, some greater number may come back for it that is so, too; where it is
    more than the second, some smaller number that is. `is_around`: ``room.corners`` begins with corners around it.

    A polytope inside the difference grows where its surface comes nearest to the origin. It need not hold the origin
    from the start: a face that has it in front is the nearest of all.
    """
    corners, faces, planes = room.corners, room.faces, room.planes
    shallow, deep = limits
    count = 4 if is_around else _first_corners(a, b, bodies, Xa, Xb, room)
    if count < 4:
        return 0.0
    for f in range(4):
        for c in range(3):
            faces[f, c] = (f + 1 + c) % 4
        _face(corners, faces, planes, f, f)
        _new_corner(room, f)
    for f in range(4):
        _own(room, f, f)
    used = 4
    least = math.inf
    for _ in range(MOST_POINTS):
        best = 0
        for f in range(1, used):
            if planes[f, 3] < planes[best, 3]:
                best = f
        inside: float = planes[best, 3]
        if inside > deep:
            return inside
        for c in range(3):
            room.d[c] = planes[best, c]
        reach = of_difference(a, b, bodies, Xa, Xb, room.d, room.point, room.spare)
        if reach < least:
            least = reach
            for c in range(3):
                n[c] = -room.d[c]
        if least <= shallow or least - inside <= NEAR + RELATIVE * abs(least) or count >= MOST_POINTS:
            break
        for c in range(3):
            corners[count, c] = room.point[c]
        _new_corner(room, count)
        count += 1
        used = _grow(room, used, count - 1, best)
        if used == 0:
            break
    return least


@kernel
def _take_simplex(room: GapRoom) -> bool:
    """Take the corners around the origin that the search for a distance has left, unless they are almost flat."""
    corners, simplex = room.corners, room.simplex
    for i in range(4):
        for c in range(3):
            corners[i, c] = simplex[i, c]
    u0, u1, u2 = simplex[1, 0] - simplex[0, 0], simplex[1, 1] - simplex[0, 1], simplex[1, 2] - simplex[0, 2]
    v0, v1, v2 = simplex[2, 0] - simplex[0, 0], simplex[2, 1] - simplex[0, 1], simplex[2, 2] - simplex[0, 2]
    w0, w1, w2 = simplex[3, 0] - simplex[0, 0], simplex[3, 1] - simplex[0, 1], simplex[3, 2] - simplex[0, 2]
    volume = (u1 * v2 - u2 * v1) * w0 + (u2 * v0 - u0 * v2) * w1 + (u0 * v1 - u1 * v0) * w2
    u, v, w = u0 * u0 + u1 * u1 + u2 * u2, v0 * v0 + v1 * v1 + v2 * v2, w0 * w0 + w1 * w1 + w2 * w2
    is_round: bool = abs(volume) > ROUND_ENOUGH * math.sqrt(u * v * w)
    return is_round


@kernel
def _first_corners(a: int, b: int, bodies: Convexes, Xa: Array, Xb: Array, room: GapRoom) -> int:
    """Four corners of the difference that are not in one plane; fewer where there are none."""
    corners, d = room.corners, room.d
    best = 0.0
    for axis in range(3):
        for c in range(3):
            d[c] = 1.0 if c == axis else 0.0
        high = of_difference(a, b, bodies, Xa, Xb, d, room.point, room.spare)
        for c in range(3):
            room.simplex[0, c] = room.point[c]
            d[c] = -d[c]
        low = -of_difference(a, b, bodies, Xa, Xb, d, room.point, room.spare)
        if high - low > best:
            best = high - low
            for c in range(3):
                corners[0, c], corners[1, c] = room.simplex[0, c], room.point[c]
    if best <= FLAT:
        return 1
    # across the line of the first two, and across the plane of the first three, on both sides
    for k in range(2, 4):
        found = 0.0
        for axis in range(3 if k == 2 else 1):
            _across(corners, k, axis, d)
            size = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
            if size <= 0.0:
                continue
            for c in range(3):
                d[c] /= size
            at = corners[0, 0] * d[0] + corners[0, 1] * d[1] + corners[0, 2] * d[2]
            for _ in range(2):
                off = of_difference(a, b, bodies, Xa, Xb, d, room.point, room.spare) - at
                if off > found:
                    found = off
                    for c in range(3):
                        corners[k, c] = room.point[c]
                for c in range(3):
                    d[c] = -d[c]
                at = -at
        if found <= FLAT:
            return k
    return 4


@kernel
def _across(corners: Array, k: int, axis: int, d: Array) -> None:
    """Direction `d` across the edge of the first two corners and a coordinate axis, or across three corners."""
    u = corners[1, 0] - corners[0, 0]
    v = corners[1, 1] - corners[0, 1]
    w = corners[1, 2] - corners[0, 2]
    if k == 2:
        x = 1.0 if axis == 0 else 0.0
        y = 1.0 if axis == 1 else 0.0
        z = 1.0 if axis == 2 else 0.0
    else:
        x, y, z = corners[2, 0] - corners[0, 0], corners[2, 1] - corners[0, 1], corners[2, 2] - corners[0, 2]
    d[0], d[1], d[2] = v * z - w * y, w * x - u * z, u * y - v * x


@kernel
def _face(corners: Array, faces: Ints, planes: Array, f: int, behind: int) -> None:
    """Plane `f` (normal, distance) of a face, which has the corner `behind` behind it; -1: its order says so."""
    i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
    u, v, w = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1], corners[j, 2] - corners[i, 2]
    x, y, z = corners[k, 0] - corners[i, 0], corners[k, 1] - corners[i, 1], corners[k, 2] - corners[i, 2]
    a, b, c = v * z - w * y, w * x - u * z, u * y - v * x
    size = math.sqrt(a * a + b * b + c * c)
    if size <= 0.0:
        planes[f, 0], planes[f, 1], planes[f, 2], planes[f, 3] = 0.0, 0.0, 0.0, math.inf
        return
    a, b, c = a / size, b / size, c / size
    at = a * corners[i, 0] + b * corners[i, 1] + c * corners[i, 2]
    if behind >= 0:
        off = a * corners[behind, 0] + b * corners[behind, 1] + c * corners[behind, 2]
        if off > at:
            a, b, c, at = -a, -b, -c, -at
            faces[f, 1], faces[f, 2] = k, j
    planes[f, 0], planes[f, 1], planes[f, 2], planes[f, 3] = a, b, c, at


@kernel
def _own(room: GapRoom, f: int, owner: int) -> None:
    """Let the edges of face `f` be those of `owner`."""
    for c in range(3):
        room.owner[room.faces[f, c], room.faces[f, (c + 1) % 3]] = owner


@kernel
def _new_corner(room: GapRoom, new: int) -> None:
    """No face has an edge to or from corner `new`."""
    for k in range(new + 1):
        room.owner[new, k] = room.owner[k, new] = -1


@kernel
def _seen_from(room: GapRoom, used: int, new: int, best: int) -> int:
    """Mark faces that corner `new` lies in front of, from `best` on over their edges; how many edges their rim has.

    Only what hangs together is taken: of faces in one plane with the corner, rounding would take some here and there.
    """
    corners, faces, planes, edges, seen = room.corners, room.faces, room.planes, room.edges, room.seen
    x, y, z = corners[new, 0], corners[new, 1], corners[new, 2]
    for f in range(used):
        seen[f] = 0
    seen[best] = 1
    room.heap[0] = best
    top, rim = 0, 0
    while top >= 0:
        f = room.heap[top]
        top -= 1
        for c in range(3):
            i, j = faces[f, c], faces[f, (c + 1) % 3]
            g = room.owner[j, i]
            if g >= 0 and seen[g] == 1:
                continue
            front = g >= 0 and planes[g, 0] * x + planes[g, 1] * y + planes[g, 2] * z > planes[g, 3] + FRONT
            if front:
                seen[g] = 1
                top += 1
                room.heap[top] = g
            else:
                edges[rim, 0], edges[rim, 1] = i, j
                rim += 1
    # a face may have been taken after its neighbour had put their edge on the rim
    kept = 0
    for e in range(rim):
        g = room.owner[edges[e, 1], edges[e, 0]]
        if g < 0 or seen[g] == 0:
            edges[kept, 0], edges[kept, 1] = edges[e, 0], edges[e, 1]
            kept += 1
    return kept


@kernel
def _grow(room: GapRoom, used: int, new: int, best: int) -> int:
    """Replace the faces that corner `new` lies in front of; how many rows hold faces now, 0 when there is no room.

    A face that is gone keeps its row until rows run out, and is never the nearest: so faces are seldom moved. They
    stay in the order in which they came.
    """
    corners, faces, planes, edges = room.corners, room.faces, room.planes, room.edges
    rim = _seen_from(room, used, new, best)
    for f in range(used):
        if room.seen[f] == 1:
            _own(room, f, -1)
            faces[f, 0], planes[f, 3] = GONE, math.inf
    if used + rim > MOST_FACES:
        used = _move_up(room, used)
    if rim == 0 or used + rim > MOST_FACES:
        return 0
    for e in range(rim):
        faces[used, 0], faces[used, 1], faces[used, 2] = edges[e, 0], edges[e, 1], new
        _face(corners, faces, planes, used, -1)
        _own(room, used, used)
        used += 1
    return used


@kernel
def _move_up(room: GapRoom, used: int) -> int:
    """Move faces up to where others are gone; how many there are."""
    faces, planes = room.faces, room.planes
    kept = 0
    for f in range(used):
        if faces[f, 0] == GONE:
            continue
        for c in range(3):
            faces[kept, c] = faces[f, c]
        for c in range(4):
            planes[kept, c] = planes[f, c]
        _own(room, kept, kept)
        kept += 1
    return kept
