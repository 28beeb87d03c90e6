"""Boxes around the nodes of trees of balls: flat and long parts, such as triangles, fill them better than balls.

Two boxes, or a triangle and whatever is near it, are kept apart by the plane of one of their own faces (Gottschalk,
Lin and Manocha 1996, Proc. SIGGRAPH, 171, without the axes across two edges). What a plane parts is apart for sure;
all else is looked at exactly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.checks.gap_kernels import Convexes, GapRoom, Ints, is_nearer
from gcodesim.checks.meeting_kernels import Forest, Walk
from gcodesim.compiled import kernel
from gcodesim.frames import Array

SLACK = 1e-9  # [m] for rounding, in favour of looking exactly
CORNERS = 3  # of a triangle


class SeenFrame(NamedTuple):
    """How the frame of one body is seen from that of another.

    `turn` (3, 3), the same without signs `size` (3, 3), and `shift` (3,) [m].
    """

    turn: Array
    size: Array
    shift: Array


@kernel
def see(Xa: Array, Xb: Array, sight: SeenFrame) -> None:
    """How the frame `Xb` (4, 4) is seen from `Xa`."""
    for r in range(3):
        sight.shift[r] = 0.0
        for k in range(3):
            sight.shift[r] += Xa[k, r] * (Xb[k, 3] - Xa[k, 3])
        for c in range(3):
            value = Xa[0, r] * Xb[0, c] + Xa[1, r] * Xb[1, c] + Xa[2, r] * Xb[2, c]
            sight.turn[r, c], sight.size[r, c] = value, abs(value)


@kernel
def boxes_apart(i: int, j: int, limit: float, forest: Forest, sight: SeenFrame) -> bool:
    """Whether a face of one of two boxes keeps the other farther away than `limit` [m]."""
    turn, size, shift = sight
    middle, half = forest.centre, forest.half
    enough = limit + SLACK
    x = shift[0] - middle[i, 0] + turn[0, 0] * middle[j, 0] + turn[0, 1] * middle[j, 1] + turn[0, 2] * middle[j, 2]
    y = shift[1] - middle[i, 1] + turn[1, 0] * middle[j, 0] + turn[1, 1] * middle[j, 1] + turn[1, 2] * middle[j, 2]
    z = shift[2] - middle[i, 2] + turn[2, 0] * middle[j, 0] + turn[2, 1] * middle[j, 1] + turn[2, 2] * middle[j, 2]
    u, v, w = half[j, 0], half[j, 1], half[j, 2]
    if abs(x) - half[i, 0] - size[0, 0] * u - size[0, 1] * v - size[0, 2] * w > enough:
        return True
    if abs(y) - half[i, 1] - size[1, 0] * u - size[1, 1] * v - size[1, 2] * w > enough:
        return True
    if abs(z) - half[i, 2] - size[2, 0] * u - size[2, 1] * v - size[2, 2] * w > enough:
        return True
    for c in range(3):
        along = abs(x * turn[0, c] + y * turn[1, c] + z * turn[2, c])
        if along - half[j, c] - size[0, c] * half[i, 0] - size[1, c] * half[i, 1] - size[2, c] * half[i, 2] > enough:
            return True
    return False


@kernel
def plane_parts(a: int, b: int, limit: float, bodies: Convexes, sight: SeenFrame, seen_back: bool) -> bool:
    """Whether the plane of the triangle `a` has all corners of `b` on one side, farther away than `limit` [m].

    `sight` is that of the frame of `b` from that of `a`, or, `seen_back`, the other way round.
    """
    if bodies.many[a] != CORNERS or bodies.round[a] == 1 or bodies.round[b] == 1:
        return False
    points, turn, shift = bodies.points, sight.turn, sight.shift
    p = bodies.first[a]
    px, py, pz = points[p, 0], points[p, 1], points[p, 2]
    ux, uy, uz = points[p + 1, 0] - px, points[p + 1, 1] - py, points[p + 1, 2] - pz
    vx, vy, vz = points[p + 2, 0] - px, points[p + 2, 1] - py, points[p + 2, 2] - pz
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size = math.sqrt(nx * nx + ny * ny + nz * nz)
    if size <= 0.0:
        return False
    # the normal in the frame of b, and how far the plane is from its origin
    if seen_back:
        mx = turn[0, 0] * nx + turn[0, 1] * ny + turn[0, 2] * nz
        my = turn[1, 0] * nx + turn[1, 1] * ny + turn[1, 2] * nz
        mz = turn[2, 0] * nx + turn[2, 1] * ny + turn[2, 2] * nz
        off = nx * px + ny * py + nz * pz + mx * shift[0] + my * shift[1] + mz * shift[2]
    else:
        mx = turn[0, 0] * nx + turn[1, 0] * ny + turn[2, 0] * nz
        my = turn[0, 1] * nx + turn[1, 1] * ny + turn[2, 1] * nz
        mz = turn[0, 2] * nx + turn[1, 2] * ny + turn[2, 2] * nz
        off = nx * (px - shift[0]) + ny * (py - shift[1]) + nz * (pz - shift[2])
    enough = (limit + bodies.grown[a] + bodies.grown[b] + SLACK) * size
    least, most = math.inf, -math.inf
    for k in range(bodies.first[b], bodies.first[b] + bodies.many[b]):
        height = mx * points[k, 0] + my * points[k, 1] + mz * points[k, 2] - off
        least, most = min(least, height), max(most, height)
    parted: bool = least > enough or -most > enough
    return parted


@kernel
def boxes_come_near(
    pair: Ints, limit: float, forest: Forest, bodies: Convexes, sight: SeenFrame, walk: Walk, gaps: GapRoom,
    n: Array,
) -> bool:  # fmt: skip
    """Whether two bodies at the poses of `walk` are nearer than `limit` [m], as `meeting_kernels.come_near` says."""
    nodes, radius, left, right = walk.nodes, forest.radius, forest.left, forest.right
    see(walk.Xa, walk.Xb, sight)
    nodes[0, 0], nodes[0, 1] = pair[0], pair[1]
    top = 0
    while top >= 0:
        i, j = nodes[top, 0], nodes[top, 1]
        if boxes_apart(i, j, limit, forest, sight):
            top -= 1
        elif left[i] < 0 and left[j] < 0:
            a, b = forest.convex[i], forest.convex[j]
            parted = plane_parts(a, b, limit, bodies, sight, False) or plane_parts(b, a, limit, bodies, sight, True)
            if not parted and is_nearer(a, b, bodies, walk.Xa, walk.Xb, limit, gaps, n):
                return True
            top -= 1
        elif left[j] < 0 or (left[i] >= 0 and radius[i] >= radius[j]):
            nodes[top, 0], nodes[top + 1, 0] = left[i], right[i]
            nodes[top + 1, 1] = j
            top += 1
        else:
            nodes[top, 1], nodes[top + 1, 1] = left[j], right[j]
            nodes[top + 1, 0] = i
            top += 1
    return False
