"""Whether a swept tool and a convex body meet, and how deep: support points, and the method of Gilbert et al.

A part of a tool is a convex body of revolution given by points (k, 2) of its
outline: radius and height above the tip [m]. Swept along a straight piece with
a constant axis it stays convex, so it is known by its support point in any
direction; so is a fixture, the hull of its corners. Two convex bodies meet when
the origin lies in their difference (Gilbert, Johnson and Keerthi 1988, IEEE J.
Robotics and Automation 4, 193).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel
from gcodesim.frames import Array

MOST_ROUNDS = 64
GOLDEN = 0.6180339887498949
MOST_CONES = 8  # points of an outline, up to which the flanks of its cones are asked one by one; balls have more
EXACT = 1e-9  # [m] to which the first contact is known
ROUNDS = 40  # golden section: 5e-9 of a piece, if it is not shorter than the tolerance before

Ints = NDArray[np.int64]


@kernel
def support(outline: Array, axis: Array, start: Array, end: Array, corners: Array, d: Array, out: Array) -> float:
    """Support point `out` (3,) of swept tool minus hull in direction `d` (3,), and its product with `d`."""
    along = axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2]
    across = math.sqrt(max(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - along * along, 0.0))
    best, which = -math.inf, 0
    for i in range(outline.shape[0]):
        reach = outline[i, 0] * across + outline[i, 1] * along
        if reach > best:
            best, which = reach, i
    out_r = outline[which, 0] / across if across > 0.0 else 0.0
    out_h = outline[which, 1]
    at_start = start[0] * d[0] + start[1] * d[1] + start[2] * d[2]
    at_end = end[0] * d[0] + end[1] * d[1] + end[2] * d[2]
    far = -math.inf
    corner = 0
    for i in range(corners.shape[0]):
        reach = -(corners[i, 0] * d[0] + corners[i, 1] * d[1] + corners[i, 2] * d[2])
        if reach > far:
            far, corner = reach, i
    value = 0.0
    for c in range(3):
        tip = end[c] if at_end > at_start else start[c]
        out[c] = tip + out_h * axis[c] + out_r * (d[c] - along * axis[c]) - corners[corner, c]
        value += out[c] * d[c]
    return value


@kernel
def nearest_on_segment(a: Array, b: Array, weight: Array) -> float:
    """Weights (2,) of the point of segment a b nearest to the origin, and its squared distance."""
    ab2, at = 0.0, 0.0
    for c in range(3):
        ab2 += np.square(b[c] - a[c])
        at -= a[c] * (b[c] - a[c])
    t = min(max(at / ab2, 0.0), 1.0) if ab2 > 0.0 else 0.0
    weight[0], weight[1] = 1.0 - t, t
    square = 0.0
    for c in range(3):
        square += np.square(a[c] + t * (b[c] - a[c]))
    return square


@kernel
def nearest_on_triangle(a: Array, b: Array, c: Array, weight: Array) -> float:
    """Weights (3,) of the point of triangle a b c nearest to the origin, and its squared distance."""
    abab = acac = abac = aab = aac = 0.0
    for k in range(3):
        u, v = b[k] - a[k], c[k] - a[k]
        abab += u * u
        acac += v * v
        abac += u * v
        aab += a[k] * u
        aac += a[k] * v
    det = abab * acac - abac * abac
    if det > 1e-14 * abab * acac:
        s, t = (abac * aac - acac * aab) / det, (abac * aab - abab * aac) / det
        if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
            weight[0], weight[1], weight[2] = 1.0 - s - t, s, t
            square = 0.0
            for k in range(3):
                square += np.square(a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]))
            return square
    best = math.inf
    two = np.zeros(2)
    for edge in range(3):
        if edge == 0:
            square = nearest_on_segment(a, b, two)
        elif edge == 1:
            square = nearest_on_segment(b, c, two)
        else:
            square = nearest_on_segment(c, a, two)
        if square < best:
            best = square
            weight[0] = weight[1] = weight[2] = 0.0
            weight[edge], weight[(edge + 1) % 3] = two[0], two[1]
    return best


@kernel
def orientation(a: Array, b: Array, c: Array, p: Array, shift: float) -> float:
    """Six times the signed volume of the tetrahedron a b c and (p times `shift`); shift 0 puts the origin there."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = shift * p[0] - a[0], shift * p[1] - a[1], shift * p[2] - a[2]
    volume: float = ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)
    return volume


@kernel
def shrink(simplex: Array, count: int, closest: Array, weight: Array) -> int:
    """How many points of `simplex` (4, 3), moved to its front, carry its point `closest` to the origin; 4: inside."""
    four = weight
    three = np.zeros(3)
    kept = count
    if count == 1:
        four[0] = 1.0
    elif count == 2:
        nearest_on_segment(simplex[0], simplex[1], four[:2])
    elif count == 3:
        nearest_on_triangle(simplex[0], simplex[1], simplex[2], four[:3])
    else:
        inside = True
        best = math.inf
        four[:] = 0.0
        for skip in range(4):
            i, j, k = (skip + 1) % 4, (skip + 2) % 4, (skip + 3) % 4
            mine = orientation(simplex[i], simplex[j], simplex[k], simplex[skip], 1.0)
            origin = orientation(simplex[i], simplex[j], simplex[k], simplex[skip], 0.0)
            if mine * origin > 0.0:
                continue
            inside = False
            square = nearest_on_triangle(simplex[i], simplex[j], simplex[k], three)
            if square < best:
                best = square
                four[:] = 0.0
                four[i], four[j], four[k] = three[0], three[1], three[2]
        if inside:
            closest[:] = 0.0
            return 4
    closest[:] = 0.0
    kept = 0
    for i in range(count):
        if four[i] > 0.0:
            for c in range(3):
                closest[c] += four[i] * simplex[i, c]
                simplex[kept, c] = simplex[i, c]
            kept += 1
    return kept


@kernel
def separation(outline: Array, axis: Array, start: Array, end: Array, corners: Array, tolerance: float) -> float:
    """Distance [m] between the tool swept from `start` to `end` and the hull of `corners`; 0 when they meet.

    Accurate to `tolerance` [m]; anything nearer than that counts as meeting.
    """
    simplex, closest, weight = np.zeros((4, 3)), np.zeros(3), np.zeros(4)
    for c in range(3):
        closest[c] = start[c] - corners[0, c]
    if closest[0] * closest[0] + closest[1] * closest[1] + closest[2] * closest[2] == 0.0:
        closest[0] = 1.0
    count = 0
    lower = 0.0
    d, point = np.zeros(3), np.zeros(3)
    for _ in range(MOST_ROUNDS):
        for c in range(3):
            d[c] = -closest[c]
        size = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        value = support(outline, axis, start, end, corners, d, point)
        lower = max(lower, -value / size)
        if count > 0 and size - lower <= tolerance:
            return size
        for i in range(count):
            if simplex[i, 0] == point[0] and simplex[i, 1] == point[1] and simplex[i, 2] == point[2]:
                return size
        for c in range(3):
            simplex[count, c] = point[c]
        count = shrink(simplex, count + 1, closest, weight)
        square = closest[0] * closest[0] + closest[1] * closest[1] + closest[2] * closest[2]
        if count == 4 or square <= tolerance * tolerance:
            return 0.0
    return lower


@kernel
def overlap_along(outline: Array, axis: Array, tip: Array, corners: Array, d: Array, point: Array) -> float:
    """How far the standing tool has to be moved along -d to leave the hull; inf when `d`, normalised here, is 0."""
    size = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
    if size < 1e-12:
        return math.inf
    for c in range(3):
        d[c] /= size
    return support(outline, axis, tip, tip, corners, d, point)


@kernel
def has_cones(outline: Array) -> bool:
    """Whether the outline (k, 2) of a part has flanks that are neither upright nor level."""
    for k in range(outline.shape[0] - 1):
        if outline[k, 0] != outline[k + 1, 0] and outline[k, 1] != outline[k + 1, 1]:
            return True
    return False


@kernel
def flank_depth(outline: Array, axis: Array, tip: Array, corners: Array, side: Array) -> float:
    """The least way out [m] along the normals of the flanks of cones that stand on the side `side` (3,) of the axis."""
    least = math.inf
    size = math.sqrt(side[0] * side[0] + side[1] * side[1] + side[2] * side[2])
    if size < 1e-12:
        return least
    d, point = np.zeros(3), np.zeros(3)
    for k in range(outline.shape[0] - 1):
        across, along = outline[k + 1, 1] - outline[k, 1], outline[k, 0] - outline[k + 1, 0]
        if across == 0.0 or along == 0.0:
            continue
        for sign in range(4):  # out of the flank and into it, to this side and the other
            for c in range(3):
                d[c] = (1 - 2 * (sign & 1)) * across * side[c] / size + (1 - (sign & 2)) * along * axis[c]
            least = min(least, overlap_along(outline, axis, tip, corners, d, point))
    return least


@kernel
def depth_at(outline: Array, axis: Array, tip: Array, corners: Array, normals: Array) -> float:
    """How deep [m] the tool standing at `tip` is in the hull: the least way out along any of these directions.

    The directions are the normals (m, 3) of the hull's faces and the tool's axis, both also
    across the axis, those from the axis to each corner, and, towards all of these, the normals of cones. For an upright
    tool of cylinders and cones in an upright box that is exact; for others it is an upper bound of the least way out.
    Negative or 0: they do not meet.
    """
    least = math.inf
    slanted = outline.shape[0] <= MOST_CONES and has_cones(outline)
    d, point = np.zeros(3), np.zeros(3)
    for i in range(2 * normals.shape[0] + 1 + corners.shape[0]):
        for c in range(3):
            if i < normals.shape[0]:
                d[c] = normals[i, c]
            elif i < 2 * normals.shape[0]:
                d[c] = normals[i - normals.shape[0], c]
            elif i == 2 * normals.shape[0]:
                d[c] = axis[c]
            else:
                d[c] = corners[i - 2 * normals.shape[0] - 1, c] - tip[c]
        if i >= normals.shape[0] and i != 2 * normals.shape[0]:
            along = d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2]
            for c in range(3):
                d[c] -= along * axis[c]
            if slanted:
                least = min(least, flank_depth(outline, axis, tip, corners, d))
        for _ in range(2):
            least = min(least, overlap_along(outline, axis, tip, corners, d, point))
            for c in range(3):
                d[c] = -d[c]
    return least


@kernel
def depth_on(
    outline: Array, axis: Array, start: Array, end: Array, corners: Array, normals: Array, t: float, tip: Array
) -> float:
    """`depth_at` with the tip at share `t` of the way from `start` to `end`; minus the distance where they are apart.

    As an upper bound the depth may be greatest where they do not meet at all. `tip` (3,) is room to work in.
    """
    for c in range(3):
        tip[c] = start[c] + t * (end[c] - start[c])
    distance = separation(outline, axis, tip, tip, corners, EXACT)
    return -distance if distance > 0.0 else depth_at(outline, axis, tip, corners, normals)


@kernel
def touch(
    outline: Array, axis: Array, start: Array, end: Array, corners: Array, normals: Array, tolerance: float, tip: Array
) -> tuple[float, float]:
    """Depth [m] of one part of the tool in one hull on a straight piece, 0 where they keep clear, and where they meet.

    That is a share of the piece. On a straight way into a convex body the distance falls, the depth rises to one top
    and falls again, so the top is found by golden section and the first contact before it by halving. `tip` (3,) is
    room to work in.
    """
    if separation(outline, axis, start, end, corners, tolerance) > 0.0:
        return 0.0, 0.0
    best, top = depth_on(outline, axis, start, end, corners, normals, 0.0, tip), 0.0
    at_start = best
    at_end = depth_on(outline, axis, start, end, corners, normals, 1.0, tip)
    if at_end > best:
        best, top = at_end, 1.0
    low, high = 0.0, 1.0
    left, right = high - GOLDEN, low + GOLDEN
    at_left = depth_on(outline, axis, start, end, corners, normals, left, tip)
    at_right = depth_on(outline, axis, start, end, corners, normals, right, tip)
    length = math.sqrt(np.square(end[0] - start[0]) + np.square(end[1] - start[1]) + np.square(end[2] - start[2]))
    for _ in range(ROUNDS):
        if (high - low) * length < tolerance:
            break
        if at_left > best:
            best, top = at_left, left
        if at_right > best:
            best, top = at_right, right
        if at_left >= at_right:
            high, right, at_right = right, left, at_left
            left = high - GOLDEN * (high - low)
            at_left = depth_on(outline, axis, start, end, corners, normals, left, tip)
        else:
            low, left, at_left = left, right, at_right
            right = low + GOLDEN * (high - low)
            at_right = depth_on(outline, axis, start, end, corners, normals, right, tip)
    if best <= tolerance:
        return 0.0, 0.0
    if at_start > 0.0:
        return best, 0.0
    outside, inside = 0.0, top
    for _ in range(ROUNDS):
        middle = 0.5 * (outside + inside)
        for c in range(3):
            tip[c] = start[c] + middle * (end[c] - start[c])
        if separation(outline, axis, start, tip, corners, EXACT) <= 0.0:
            inside = middle
        else:
            outside = middle
    return best, inside


@kernel
def touches(
    piece: Ints,
    outline: Array,
    axis: Array,
    start: Array,
    end: Array,
    corners: Array,
    normals: Array,
    tolerance: float,
    first: Array,
    depth: Array,
) -> None:
    """`touch` for pieces `piece` (p,) of a way: raises `depth` and lowers `first` (m,) to those of this hull."""
    tip = np.zeros(3)
    for p in range(len(piece)):
        i = piece[p]
        deep, share = touch(outline, axis[i], start[i], end[i], corners, normals, tolerance, tip)
        if deep > 0.0:
            depth[i], first[i] = max(depth[i], deep), min(first[i], share)


class Crossing(NamedTuple):
    """A part of a tool that goes along straight pieces (m, 3), in bunches of neighbours; see `touch`.

    `near` (p,): the pieces that count; `low`, `high` (m, 3): the room of each. Bunch b has those from
    `begin[b]` to `begin[b + 1]` of `near`, in the room `bunch_low` to `bunch_high` (b, 3).
    """

    outline: Array
    axis: Array
    start: Array
    end: Array
    near: Ints
    low: Array
    high: Array
    begin: Ints
    bunch_low: Array
    bunch_high: Array


@kernel
def apart(low: Array, high: Array, other_low: Array, other_high: Array) -> bool:
    """Whether two upright boxes have no room in common."""
    behind: bool = high[0] <= other_low[0] or high[1] <= other_low[1] or high[2] <= other_low[2]
    before: bool = low[0] >= other_high[0] or low[1] >= other_high[1] or low[2] >= other_high[2]
    return behind or before


@kernel
def exceeds(
    outline: Array, axis: Array, start: Array, end: Array, corners: Array, normals: Array, known: float
) -> bool:
    """Whether `touch` may find more than `known` [m]: not where some direction that `depth_at` tries has a way out."""
    d, point = np.zeros(3), np.zeros(3)
    for i in range(normals.shape[0] + 1):
        for side in range(2):
            for c in range(3):
                d[c] = normals[i, c] if i < normals.shape[0] else axis[c]
                if side == 1:
                    d[c] = -d[c]
            if support(outline, axis, start, end, corners, d, point) <= known:
                return False
    return True


@kernel
def height_of(axis: Array, points: Array) -> float:
    """Height [m] of the highest of `points` (k, 3) along an axis."""
    highest = -math.inf
    for i in range(points.shape[0]):
        highest = max(highest, axis[0] * points[i, 0] + axis[1] * points[i, 1] + axis[2] * points[i, 2])
    return highest


@kernel
def say_nothing(way: Crossing, bunch: int, first: Array, depth: Array, below: Array) -> float:
    """Renew `below` (m,) for the pieces of a bunch; the height [m] that holds for all, if they have one axis.

    A triangle that nowhere is higher along the axis says nothing new of a piece which is in contact from its beginning:
    with its depth the tool would be above it.
    """
    lowest, least, alike = math.inf, math.inf, True
    for i in range(way.outline.shape[0]):
        lowest = min(lowest, way.outline[i, 1])
    one = way.near[way.begin[bunch]]
    for p in range(way.begin[bunch], way.begin[bunch + 1]):
        i = way.near[p]
        axis, start, end = way.axis[i], way.start[i], way.end[i]
        at_start = axis[0] * start[0] + axis[1] * start[1] + axis[2] * start[2]
        at_end = axis[0] * end[0] + axis[1] * end[1] + axis[2] * end[2]
        below[i] = min(at_start, at_end) + lowest + depth[i] if first[i] == 0.0 else -math.inf
        least = min(least, below[i])
        for c in range(3):
            alike = alike and axis[c] == way.axis[one, c]
    return least if alike else -math.inf


@kernel
def lay_normals(corners: Array, normals: Array) -> bool:
    """Unit directions (4, 3) across a triangle and, in its plane, across its edges; False if it is but a line."""
    edge = np.zeros((3, 3))
    for i in range(3):
        for c in range(3):
            edge[i, c] = corners[(i + 1) % 3, c] - corners[i, c]
    cross(edge[0], edge[1], normals[0])
    size = math.sqrt(normals[0, 0] * normals[0, 0] + normals[0, 1] * normals[0, 1] + normals[0, 2] * normals[0, 2])
    if not size > 0.0:
        return False
    for c in range(3):
        normals[0, c] /= size
    for i in range(3):
        cross(edge[i], normals[0], normals[i + 1])
        size = math.sqrt(np.square(normals[i + 1, 0]) + np.square(normals[i + 1, 1]) + np.square(normals[i + 1, 2]))
        for c in range(3):
            normals[i + 1, c] /= size
    return True


@kernel
def cross(a: Array, b: Array, out: Array) -> None:
    """Vector product `out` (3,)."""
    for c in range(3):
        out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3]


@kernel
def facet_touches(facets: Array, way: Crossing, tolerance: float, first: Array, depth: Array) -> None:
    """`touches` for triangles (t, 3, 3) [m], each a flat body; `first` and `depth` (m,).

    A triangle that can neither raise the depth of a piece nor be met earlier is left out: in the midst of a tool
    there are more triangles than one wants to measure. That is soon known if the highest ones come first.
    """
    tip, low, high, normals = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros((4, 3))
    bunches = len(way.begin) - 1
    below, bunch_below = np.zeros(len(depth)), np.zeros(bunches)
    for bunch in range(bunches):
        bunch_below[bunch] = say_nothing(way, bunch, first, depth, below)
    for t in range(facets.shape[0]):
        corners = facets[t]
        for c in range(3):
            low[c] = min(corners[0, c], corners[1, c], corners[2, c])
            high[c] = max(corners[0, c], corners[1, c], corners[2, c])
        laid = False
        for bunch in range(bunches):
            if apart(low, high, way.bunch_low[bunch], way.bunch_high[bunch]):
                continue
            if height_of(way.axis[way.near[way.begin[bunch]]], corners) <= bunch_below[bunch]:
                continue
            if not laid:
                if not lay_normals(corners, normals):
                    break
                laid = True
            new = False
            for p in range(way.begin[bunch], way.begin[bunch + 1]):
                i = way.near[p]
                if apart(low, high, way.low[i], way.high[i]) or height_of(way.axis[i], corners) <= below[i]:
                    continue
                deep, share = touch_facet(way, i, corners, normals, tolerance, first[i], depth[i], tip)
                if deep > 0.0:
                    depth[i], first[i], new = max(depth[i], deep), min(first[i], share), True
            if new:
                bunch_below[bunch] = say_nothing(way, bunch, first, depth, below)


@kernel
def touch_facet(
    way: Crossing, i: int, corners: Array, normals: Array, tolerance: float, first: float, depth: float, tip: Array
) -> tuple[float, float]:
    """`touch` of piece i, or no depth if the triangle can say nothing that `first` and `depth` do not say already."""
    outline, axis, start, end = way.outline, way.axis[i], way.start[i], way.end[i]
    if not exceeds(outline, axis, start, end, corners, normals, max(tolerance, depth)):
        if first == 0.0 or not exceeds(outline, axis, start, end, corners, normals, tolerance):
            return 0.0, 0.0
        until = np.zeros(3)
        for c in range(3):
            until[c] = start[c] + first * (end[c] - start[c])
        if separation(outline, axis, start, until, corners, tolerance) > 0.0:
            return 0.0, 0.0
    return touch(outline, axis, start, end, corners, normals, tolerance, tip)
