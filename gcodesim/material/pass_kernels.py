"""How far a point is from what a pass of a tool swept."""

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

LEVEL = 1.0e-12
"""How far [m] along its axis a body goes that counts as going across it."""

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
def place_beside(pieces: PassPieces, lathe: bool, c: int, t: float, point: Array) -> tuple[float, float]:
    """Where a point (3,) is, across and along [m], from the body of piece c at the share t of its way."""
    start, end = pieces.starts[c], pieces.ends[c]
    x = point[0] - start[0] - t * (end[0] - start[0])
    y = point[1] - start[1] - t * (end[1] - start[1])
    z = point[2] - start[2] - t * (end[2] - start[2])
    if lathe:  # tips are at (x, ., z), and the stock turns
        r = float(np.sqrt(point[0] * point[0] + point[1] * point[1]))
        return r - (point[0] - x), z
    first, last = pieces.axes_start[c], pieces.axes_end[c]
    ax = first[0] + t * (last[0] - first[0])
    ay = first[1] + t * (last[1] - first[1])
    az = first[2] + t * (last[2] - first[2])
    size = float(np.sqrt(ax * ax + ay * ay + az * az))
    along = (x * ax + y * ay + z * az) / size
    return float(np.sqrt(max(x * x + y * y + z * z - along * along, 0.0))), along


@kernel(lean=True)
def pass_distance(pieces: PassPieces, bodies: PassBodies, c: int, t: float, point: Array) -> float:
    """Distance [m] of a point (3,) from the body of piece c at the share t of its way."""
    across, along = place_beside(pieces, bodies.lathe, c, t, point)
    return outline_distance(bodies, int(pieces.body[c]), across, along)


@kernel(lean=True)
def nearest_pass(
    pieces: PassPieces, bodies: PassBodies, c: int, point: Array, enough: float, satisfied: float
) -> float:
    """The least distance [m] of a point from the body of piece c; negative inside.

    Where it cannot be below `enough`, and once one is found that is no more than `satisfied`, it may be more.
    """
    length, bend, climb, foot = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        way, axis = pieces.ends[c, k] - pieces.starts[c, k], pieces.axes_start[c, k]
        length += way * way
        bend += abs(pieces.axes_end[c, k] - axis)
        climb += way * axis
        foot += way * (point[k] - pieces.starts[c, k])
    if bend == 0.0 and abs(climb) <= LEVEL and not bodies.lathe:
        # A body of revolution that goes across its axis is nearest where its axis is. The axis itself is no border of
        # it, though outlines are closed along it.
        share = min(max(foot / length, 0.0), 1.0) if length > 0.0 else 0.0
        across, along = place_beside(pieces, bodies.lathe, c, share, point)
        best = outline_distance(bodies, int(pieces.body[c]), across, along)
        if best <= satisfied or across > -best:
            return best
    length = np.sqrt(length)
    looks = max(2, min(MOST_LOOKS, 2 + int(2.0 * length / max(bodies.extent[pieces.body[c], 0], 1e-6))))
    best, at = np.inf, 0
    for k in range(looks):
        distance = pass_distance(pieces, bodies, c, k / (looks - 1.0), point)
        if distance < best:
            best, at = distance, k
            if distance <= satisfied:
                return best
    way = length + bend * bodies.extent[pieces.body[c], 3]  # no point of the body moves farther
    if way == 0.0 or best - 0.5 * way / (looks - 1.0) >= enough:
        return best
    low, high = max(at - 1, 0) / (looks - 1.0), min(at + 1, looks - 1) / (looks - 1.0)
    a, b = high - SHARE * (high - low), low + SHARE * (high - low)
    at_a, at_b = pass_distance(pieces, bodies, c, a, point), pass_distance(pieces, bodies, c, b, point)
    for _ in range(NARROWINGS):
        least = min(at_a, at_b)
        if least <= satisfied or least - (1.0 - SHARE) * (high - low) * way >= enough:
            break
        if at_a <= at_b:
            high, b, at_b = b, a, at_a
            a = high - SHARE * (high - low)
            at_a = pass_distance(pieces, bodies, c, a, point)
        else:
            low, a, at_a = a, b, at_b
            b = low + SHARE * (high - low)
            at_b = pass_distance(pieces, bodies, c, b, point)
    return min(best, at_a, at_b)
