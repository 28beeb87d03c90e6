"""Which of many passes of tools made a face, or came nearest to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]

SHARE = 0.618033988749895
"""Of the golden section."""

NARROWINGS = 24
"""After so many the place on a piece is known to a 100,000th."""

MOST_LOOKS = 64
"""Places at which a long piece is looked at first."""


class PassPieces(NamedTuple):
    """c straight pieces in the order in which they ran, in S: tips (c, 3) [m], axes (c, 3) to the holder; body (c,)."""

    starts: Array
    ends: Array
    axes_start: Array
    axes_end: Array
    body: NDArray[np.int32]


class PassBodies(NamedTuple):
    """Closed outlines of what acts: points (k, 2) [m] across and along the axis, of body b those from first[b] on.

    extent (bodies, 4) [m]: the widest of it, its least and greatest height, and how far any point is from the tip.
    `lathe`: outlines are (r, z) about the axis of the stock instead, and never turn.
    """

    points: Array
    first: NDArray[np.int64]
    extent: Array
    lathe: bool


@kernel(lean=True)
def outline_distance(bodies: PassBodies, b: int, u: float, v: float) -> float:
    """Distance [m] of (u, v) from an outline; negative inside."""
    points = bodies.points
    begin, end = bodies.first[b], bodies.first[b + 1]
    square, inside = np.inf, False
    for k in range(begin, end):
        n = k + 1 if k + 1 < end else begin
        au, av = points[k, 0], points[k, 1]
        du, dv = points[n, 0] - au, points[n, 1] - av
        pu, pv = u - au, v - av
        length = du * du + dv * dv
        t = min(max((pu * du + pv * dv) / length, 0.0), 1.0) if length > 0.0 else 0.0
        eu, ev = pu - t * du, pv - t * dv
        square = min(square, eu * eu + ev * ev)
        if (av > v) != (av + dv > v) and u < au + (v - av) * du / dv:
            inside = not inside
    distance = float(np.sqrt(square))
    return -distance if inside else distance


@kernel(lean=True)
def pass_distance(pieces: PassPieces, bodies: PassBodies, c: int, t: float, point: Array) -> float:
    """Distance [m] of a point (3,) from the body of piece c at the share t of its way."""
    start, end = pieces.starts[c], pieces.ends[c]
    x = point[0] - start[0] - t * (end[0] - start[0])
    y = point[1] - start[1] - t * (end[1] - start[1])
    z = point[2] - start[2] - t * (end[2] - start[2])
    b = int(pieces.body[c])
    if bodies.lathe:  # tips are at (x, ., z), and the stock turns
        r = float(np.sqrt(point[0] * point[0] + point[1] * point[1]))
        return outline_distance(bodies, b, r - (point[0] - x), z)
    first, last = pieces.axes_start[c], pieces.axes_end[c]
    ax = first[0] + t * (last[0] - first[0])
    ay = first[1] + t * (last[1] - first[1])
    az = first[2] + t * (last[2] - first[2])
    size = float(np.sqrt(ax * ax + ay * ay + az * az))
    along = (x * ax + y * ay + z * az) / size
    across = max(x * x + y * y + z * z - along * along, 0.0)
    return outline_distance(bodies, b, float(np.sqrt(across)), along)


@kernel(lean=True)
def nearest_pass(pieces: PassPieces, bodies: PassBodies, c: int, point: Array, length: float, enough: float) -> float:
    """The least distance [m] of a point from the body of piece c, `length` [m] long; negative inside.

    Where it cannot be below `enough` it may be more.
    """
    looks = max(2, min(MOST_LOOKS, 2 + int(2.0 * length / max(bodies.extent[pieces.body[c], 0], 1e-6))))
    best, at = np.inf, 0
    for k in range(looks):
        distance = pass_distance(pieces, bodies, c, k / (looks - 1.0), point)
        if distance < best:
            best, at = distance, k
    bend = 0.0
    for k in range(3):
        bend += abs(pieces.axes_end[c, k] - pieces.axes_start[c, k])
    way = length + bend * bodies.extent[pieces.body[c], 3]
    if way == 0.0 or best - 0.5 * way / (looks - 1.0) >= enough:  # no point of it moves farther between two looks
        return best
    low, high = max(at - 1, 0) / (looks - 1.0), min(at + 1, looks - 1) / (looks - 1.0)
    a, b = high - SHARE * (high - low), low + SHARE * (high - low)
    at_a, at_b = pass_distance(pieces, bodies, c, a, point), pass_distance(pieces, bodies, c, b, point)
    for _ in range(NARROWINGS):
        if at_a <= at_b:
            high, b, at_b = b, a, at_a
            a = high - SHARE * (high - low)
            at_a = pass_distance(pieces, bodies, c, a, point)
        else:
            low, a, at_a = a, b, at_b
            b = low + SHARE * (high - low)
            at_b = pass_distance(pieces, bodies, c, b, point)
    return min(best, at_a, at_b)


@kernel(lean=True)
def least_gap(pieces: PassPieces, bodies: PassBodies, c: int, point: Array) -> float:
    """A distance [m] from piece c that the point is not nearer than: that of the cylinder around the body."""
    start, end = pieces.starts[c], pieces.ends[c]
    b = int(pieces.body[c])
    widest, low, high, far = bodies.extent[b, 0], bodies.extent[b, 1], bodies.extent[b, 2], bodies.extent[b, 3]
    x, y, z = point[0] - start[0], point[1] - start[1], point[2] - start[2]
    mx, my, mz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    if bodies.lathe:
        x, y, my = float(np.sqrt(point[0] * point[0] + point[1] * point[1])) - start[0], 0.0, 0.0
        length = mx * mx + mz * mz
        t = min(max((x * mx + z * mz) / length, 0.0), 1.0) if length > 0.0 else 0.0
        x, z = x - t * mx, z - t * mz
        return float(np.sqrt(x * x + z * z) - far)
    axis, other = pieces.axes_start[c], pieces.axes_end[c]
    bend = abs(other[0] - axis[0]) + abs(other[1] - axis[1]) + abs(other[2] - axis[2])
    along = x * axis[0] + y * axis[1] + z * axis[2]
    climb = mx * axis[0] + my * axis[1] + mz * axis[2]
    x, y, z = x - along * axis[0], y - along * axis[1], z - along * axis[2]
    mx, my, mz = mx - climb * axis[0], my - climb * axis[1], mz - climb * axis[2]
    length = mx * mx + my * my + mz * mz
    t = min(max((x * mx + y * my + z * mz) / length, 0.0), 1.0) if length > 0.0 else 0.0
    x, y, z = x - t * mx, y - t * my, z - t * mz
    gap = float(np.sqrt(x * x + y * y + z * z)) - widest
    gap = max(gap, low - max(along, along - climb), min(along, along - climb) - high)
    return float(gap - bend * far)


@kernel
def makers_of(
    points: Array, pieces: PassPieces, bodies: PassBodies, slack: float, maker: NDArray[np.int64], gap: Array
) -> None:
    """For each point (n, 3) the first piece that came to within `slack` [m], else the one that came nearest.

    `maker` (n,) is -1 where there are no pieces; gap (n,) [m] is how near the piece came, negative inside.
    """
    count = pieces.body.shape[0]
    length = np.zeros(count)
    for c in range(count):
        way = pieces.ends[c] - pieces.starts[c]
        length[c] = np.sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2])
    for p in range(points.shape[0]):
        point = points[p]
        maker[p], gap[p] = -1, np.inf
        for c in range(count):
            far = least_gap(pieces, bodies, c, point)
            if far > slack and far >= gap[p]:
                continue
            distance = nearest_pass(pieces, bodies, c, point, length[c], max(slack, gap[p]))
            if distance < gap[p]:
                maker[p], gap[p] = c, distance
            if distance <= slack:
                break
