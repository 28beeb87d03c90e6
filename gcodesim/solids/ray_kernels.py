"""Rays against triangles in a tree of boxes: whether something stands between two points.

The tree is a full binary tree in the order of a walk from the root (preorder): behind node i comes its first part, and
`skip[i]` is the node after all of its parts. So a walk needs no stack: after a miss it goes on at `skip[i]`, else at
i + 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from numpy import float64, int64
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[float64]
Ints = NDArray[int64]

_VAGUE = 0.25  # sine by which a horizon may be too high
_PARALLEL = 1e-30  # determinant below which a triangle is seen edge-on


class Boxes(NamedTuple):
    """Nodes of one or more trees: least and greatest corner `box` (m, 6) [m] and where to go on after a miss.

    A leaf has the items `begin` to `end`; every other node has begin = end = 0.
    """

    box: Array
    skip: Ints
    begin: Ints
    end: Ints


class TriangleEdges(NamedTuple):
    """Triangles (t, 3) in the order of their tree: one corner and the ways from it to the two others [m]."""

    corner: Array
    along: Array
    across: Array


@kernel(lean=True)
def blocked(boxes: Boxes, triangles: TriangleEdges, first: int, last: int, ends: Array, near: float) -> bool:
    """Whether a triangle of the tree of nodes `first` to `last` stands between two points, seen from either side.

    `ends` (2, 3) [m] are the points; what is nearer than `near` [m] to the first does not count. The test of a
    triangle is that of Möller and Trumbore (1997, J. Graphics Tools 2, 21).
    """
    x, y, z = ends[0, 0], ends[0, 1], ends[0, 2]
    dx, dy, dz = ends[1, 0] - x, ends[1, 1] - y, ends[1, 2] - z
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    if length <= near:
        return False
    least = near / length
    box, skip = boxes.box, boxes.skip
    node = first
    while node < last:
        low, high = least, 1.0
        for axis in range(3):
            if axis == 0:
                p, d = x, dx
            elif axis == 1:
                p, d = y, dy
            else:
                p, d = z, dz
            if d == 0.0:
                if p < box[node, axis] or p > box[node, 3 + axis]:
                    low = 2.0
            else:
                a = (box[node, axis] - p) / d
                b = (box[node, 3 + axis] - p) / d
                low = max(low, min(a, b))
                high = min(high, max(a, b))
        if low > high:
            node = skip[node]
            continue
        for t in range(boxes.begin[node], boxes.end[node]):
            ax, ay, az = triangles.along[t, 0], triangles.along[t, 1], triangles.along[t, 2]
            bx, by, bz = triangles.across[t, 0], triangles.across[t, 1], triangles.across[t, 2]
            px, py, pz = dy * bz - dz * by, dz * bx - dx * bz, dx * by - dy * bx
            det = ax * px + ay * py + az * pz
            if abs(det) < _PARALLEL:
                continue
            sx, sy, sz = x - triangles.corner[t, 0], y - triangles.corner[t, 1], z - triangles.corner[t, 2]
            u = (sx * px + sy * py + sz * pz) / det
            if u < 0.0 or u > 1.0:
                continue
            qx, qy, qz = sy * az - sz * ay, sz * ax - sx * az, sx * ay - sy * ax
            v = (dx * qx + dy * qy + dz * qz) / det
            if v < 0.0 or u + v > 1.0:
                continue
            share = (bx * qx + by * qy + bz * qz) / det
            if least < share < 1.0:
                return True
        node += 1
    return False


@kernel(lean=True)
def horizons(boxes: Boxes, triangles: TriangleEdges, centre: Array, normal: Array, slack: float, found: Array) -> None:
    """How high over the plane of each place `centre` (n, 3), with `normal` (n, 3), anything of the body rises.

    `found` (n,) is the sine of an elevation that nothing exceeds which rises by more than `slack` [m]: what is seen
    higher cannot be shaded by the body. It is taken from boxes around triangles, so it may be too high,
    never too low.
    """
    box = boxes.box
    last = 0  # the triangle that rises highest over one place often does so over the next
    for i in range(len(centre)):
        highest = _elevation(triangles, last, centre, normal, i, slack)
        left = 0.0
        node = 0
        while node < len(box):
            top = 0.0
            away = 0.0
            for axis in range(3):
                n, c = normal[i, axis], centre[i, axis]
                low, high = box[node, axis] - c, box[node, 3 + axis] - c
                if n > 0.0:
                    top += n * high
                elif n < 0.0:
                    top += n * low
                gap = max(low, max(-high, 0.0))
                away += gap * gap
            sine = 1.0 if top * top >= away else top / math.sqrt(away)
            if top <= slack or sine <= highest + _VAGUE:
                if top > slack:
                    left = max(left, sine)
                node = boxes.skip[node]
                continue
            for t in range(boxes.begin[node], boxes.end[node]):
                rises = _elevation(triangles, t, centre, normal, i, slack)
                if rises > highest:
                    highest = rises
                    last = t
            node += 1
        found[i] = max(highest, left)


@kernel(lean=True)
def _elevation(triangles: TriangleEdges, t: int, centre: Array, normal: Array, i: int, slack: float) -> float:
    """A sine that no point of triangle t exceeds over place i; 0 of one that rises by `slack` [m] at most."""
    base, one, other, away = 0.0, 0.0, 0.0, 0.0
    for axis in range(3):
        n = normal[i, axis]
        p, a, b = triangles.corner[t, axis] - centre[i, axis], triangles.along[t, axis], triangles.across[t, axis]
        base += n * p
        one += n * a
        other += n * b
        gap = max(p + min(0.0, min(a, b)), max(-(p + max(0.0, max(a, b))), 0.0))
        away += gap * gap
    top = base + max(0.0, max(one, other))
    if top <= slack:
        return 0.0
    return 1.0 if top * top >= away else top / math.sqrt(away)
