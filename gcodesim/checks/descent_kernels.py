"""The way down two trees of bodies, to couples of convex bodies that may be near each other.

Balls around nodes are compared first, then boxes: flat and long parts, such as triangles, fill them better. Two boxes,
or a triangle and whatever is near it, are kept apart by the plane of one of their own faces (Gottschalk, Lin and
Manocha 1996, Proc. SIGGRAPH, 171, without the axes across two edges). What is apart by a ball or a plane is so for
sure; all else is looked at exactly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gcodesim.checks.forest_kernels import Forest
from gcodesim.checks.gap_kernels import Convexes, Ints
from gcodesim.compiled import kernel
from gcodesim.frames import Array

SLACK = 1e-9  # [m] for rounding, in favour of looking exactly
CORNERS = 3  # of a triangle


class Descent(NamedTuple):
    """Poses `Xa`, `Xb` (4, 4) of two bodies, how the frame of `b` is seen from `a`, and couples of nodes to look at.

    `turn` (3, 3), the same without signs `size` (3, 3), and `shift` (3,) [m]. The couple to look at next is on top of
    `nodes` (k, 2).
    """

    Xa: Array
    Xb: Array
    turn: Array
    size: Array
    shift: Array
    nodes: Ints


def descent_room(deepest: int) -> Descent:
    """Room for two trees that have at most `deepest` nodes on a way from the root."""
    nodes = np.zeros((2 * deepest + 8, 2), dtype=np.int64)
    return Descent(np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(3), nodes)


@kernel
def begin(pair: Ints, way: Descent) -> int:
    """Put two roots on top of all that is to be looked at, with both bodies at their poses."""
    Xa, Xb = way.Xa, way.Xb
    for r in range(3):
        way.shift[r] = 0.0
        for k in range(3):
            way.shift[r] += Xa[k, r] * (Xb[k, 3] - Xa[k, 3])
        for c in range(3):
            value = Xa[0, r] * Xb[0, c] + Xa[1, r] * Xb[1, c] + Xa[2, r] * Xb[2, c]
            way.turn[r, c], way.size[r, c] = value, abs(value)
    way.nodes[0, 0], way.nodes[0, 1] = pair[0], pair[1]
    return 0


@kernel
def descend(top: int, limit: float, forest: Forest, bodies: Convexes, way: Descent) -> int:
    """Go on from `top` to two convex bodies that nothing keeps farther apart than `limit` [m]; -1: there are no more.

    Below 0 it is a depth. `convexes_at` says which they are; who has looked at them goes on from the place before.
    """
    nodes, radius, left, right = way.nodes, forest.radius, forest.left, forest.right
    while top >= 0:
        i, j = nodes[top, 0], nodes[top, 1]
        if nodes_apart(i, j, limit, forest, way):
            top -= 1
        elif left[i] < 0 and left[j] < 0:
            a, b = forest.convex[i], forest.convex[j]
            if not (plane_parts(a, b, limit, bodies, way, False) or plane_parts(b, a, limit, bodies, way, True)):
                return top
            top -= 1
        elif left[j] < 0 or (left[i] >= 0 and radius[i] >= radius[j]):
            nodes[top, 0], nodes[top + 1, 0] = left[i], right[i]
            nodes[top + 1, 1] = j
            top += 1
        else:
            nodes[top, 1], nodes[top + 1, 1] = left[j], right[j]
            nodes[top + 1, 0] = i
            top += 1
    return -1


@kernel
def convexes_at(top: int, forest: Forest, way: Descent) -> tuple[int, int]:
    """The convex bodies of two leaves."""
    return forest.convex[way.nodes[top, 0]], forest.convex[way.nodes[top, 1]]


@kernel
def nodes_apart(i: int, j: int, limit: float, forest: Forest, way: Descent) -> bool:
    """Whether balls or boxes around two nodes are farther apart than `limit` [m], or what is in them is too small.

    A limit below 0 is a depth, and small parts, such as most triangles of a mesh, are nowhere as deep in each other.
    """
    enough = limit + SLACK
    if -enough > deepest_of(i, j, forest.most):
        return True
    turn, size, shift = way.turn, way.size, way.shift
    middle, half = forest.centre, forest.half
    x = shift[0] - middle[i, 0] + turn[0, 0] * middle[j, 0] + turn[0, 1] * middle[j, 1] + turn[0, 2] * middle[j, 2]
    y = shift[1] - middle[i, 1] + turn[1, 0] * middle[j, 0] + turn[1, 1] * middle[j, 1] + turn[1, 2] * middle[j, 2]
    z = shift[2] - middle[i, 2] + turn[2, 0] * middle[j, 0] + turn[2, 1] * middle[j, 1] + turn[2, 2] * middle[j, 2]
    far = enough + forest.radius[i] + forest.radius[j]
    if far < 0.0 or x * x + y * y + z * z > far * far:
        return True
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
def deepest_of(i: int, j: int, most: Array) -> float:
    """How deep [m] bodies below two nodes are in each other at most, wherever they are.

    They are parted along the normal of one of them, or across the longest edges of both.
    """
    one, other = most[i, 0] + 0.5 * most[j, 2], most[j, 0] + 0.5 * most[i, 2]
    deepest: float = min(one, other, 0.5 * (most[i, 1] + most[j, 1]))
    return deepest


@kernel
def plane_parts(a: int, b: int, limit: float, bodies: Convexes, way: Descent, seen_back: bool) -> bool:
    """Whether the plane of the triangle `a` has all corners of `b` on one side, farther away than `limit` [m].

    `b` is the second body of `way`, or, `seen_back`, the first.
    """
    if bodies.many[a] != CORNERS or bodies.round[a] == 1 or bodies.round[b] == 1:
        return False
    points, turn, shift = bodies.points, way.turn, way.shift
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
