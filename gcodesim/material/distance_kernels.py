"""The distance of points from the skin of a mesh: a balanced tree of boxes over its triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.compiled import kernel

Array = NDArray[np.float64]

LEAF = 4
"""Triangles of a leaf."""

DEEPEST = 64
"""Boxes that wait while the tree is searched: two for each of at most 32 levels."""


class SkinTree(NamedTuple):
    """Triangles (f, 9) [m] in the order of the leaves, `LEAF` in each, and boxes (2 n, 6) of a tree with n leaves.

    Box 1 is the root; below box b are 2 b and 2 b + 1; the leaves are the last n. A row has three least and three
    greatest coordinates.
    """

    triangles: Array
    boxes: Array


@kernel(lean=True)
def square_to_box(boxes: Array, b: int, x: float, y: float, z: float) -> float:
    """Square of the distance [m²] of a point from box `b`; 0 inside."""
    dx = max(boxes[b, 0] - x, 0.0, x - boxes[b, 3])
    dy = max(boxes[b, 1] - y, 0.0, y - boxes[b, 4])
    dz = max(boxes[b, 2] - z, 0.0, z - boxes[b, 5])
    return float(dx * dx + dy * dy + dz * dz)


@kernel(lean=True)
def weights_on_triangle(triangles: Array, f: int, x: float, y: float, z: float) -> tuple[float, float]:
    """Weights of the second and third corner of triangle `f` at its point nearest to x, y, z.

    Ericson 2005, Real-Time Collision Detection, 5.1.5.
    """
    ax, ay, az = triangles[f, 0], triangles[f, 1], triangles[f, 2]
    bx, by, bz = triangles[f, 3] - ax, triangles[f, 4] - ay, triangles[f, 5] - az
    cx, cy, cz = triangles[f, 6] - ax, triangles[f, 7] - ay, triangles[f, 8] - az
    px, py, pz = x - ax, y - ay, z - az
    d1, d2 = bx * px + by * py + bz * pz, cx * px + cy * py + cz * pz
    bb, bc, cc = bx * bx + by * by + bz * bz, bx * cx + by * cy + bz * cz, cx * cx + cy * cy + cz * cz
    d3, d4, d5, d6 = d1 - bb, d2 - bc, d1 - bc, d2 - cc
    v, w = 0.0, 0.0
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    if d1 <= 0.0 and d2 <= 0.0:
        pass
    elif d3 >= 0.0 and d4 <= d3:
        v = 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v = d1 / (d1 - d3) if d1 > d3 else 0.0
    elif d6 >= 0.0 and d5 <= d6:
        w = 1.0
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        w = d2 / (d2 - d6) if d2 > d6 else 0.0
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        both = (d4 - d3) + (d5 - d6)
        w = (d4 - d3) / both if both > 0.0 else 0.0
        v = 1.0 - w
    else:
        total = va + vb + vc
        v, w = vb / total, vc / total
    return v, w


@kernel(lean=True)
def square_to_triangle(triangles: Array, f: int, x: float, y: float, z: float) -> float:
    """Square of the distance [m²] of a point from triangle `f`."""
    v, w = weights_on_triangle(triangles, f, x, y, z)
    ax, ay, az = triangles[f, 0], triangles[f, 1], triangles[f, 2]
    bx, by, bz = triangles[f, 3] - ax, triangles[f, 4] - ay, triangles[f, 5] - az
    cx, cy, cz = triangles[f, 6] - ax, triangles[f, 7] - ay, triangles[f, 8] - az
    px, py, pz = x - ax, y - ay, z - az
    ex, ey, ez = px - v * bx - w * cx, py - v * by - w * cy, pz - v * bz - w * cz
    return float(ex * ex + ey * ey + ez * ez)


@kernel(lean=True)
def skin_distance(tree: SkinTree, x: float, y: float, z: float, most: float, waiting: NDArray[np.int64]) -> float:
    """Distance [m] of a point from the skin; `most` if it is farther. waiting (DEEPEST,) is room."""
    return nearest_triangle(tree, x, y, z, most, waiting)[0]


@kernel(lean=True)
def nearest_triangle(
    tree: SkinTree, x: float, y: float, z: float, most: float, waiting: NDArray[np.int64]
) -> tuple[float, int]:
    """The same and the triangle that is nearest, of several the first found; -1 where all are farther."""
    triangles, boxes = tree
    leaves = boxes.shape[0] // 2
    best, nearest = most * most, -1
    count = 1
    waiting[0] = 1
    while count > 0:
        count -= 1
        b = waiting[count]
        if square_to_box(boxes, b, x, y, z) >= best:
            continue
        if b >= leaves:
            first = (b - leaves) * LEAF
            for f in range(first, min(first + LEAF, triangles.shape[0])):
                square = square_to_triangle(triangles, f, x, y, z)
                if square < best:
                    best, nearest = square, f
            continue
        left, right = 2 * b, 2 * b + 1
        if square_to_box(boxes, left, x, y, z) < square_to_box(boxes, right, x, y, z):
            left, right = right, left
        waiting[count], waiting[count + 1] = left, right  # the nearer one comes first
        count += 2
    return float(np.sqrt(best)), nearest


@kernel
def skin_normals(tree: SkinTree, normals: Array, points: Array, distance: Array, normal: Array) -> None:
    """Distances (n,) [m] of `points` (n, 3) from the skin, and its normals (n, 3), of no certain length, where it is
    nearest: those at the corners (f, 9) of its triangles, by their weights."""
    waiting = np.zeros(DEEPEST, np.int64)
    for p in range(points.shape[0]):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        distance[p], f = nearest_triangle(tree, x, y, z, np.inf, waiting)
        v, w = weights_on_triangle(tree.triangles, f, x, y, z)
        for axis in range(3):
            first, second, third = normals[f, axis], normals[f, 3 + axis], normals[f, 6 + axis]
            normal[p, axis] = (1.0 - v - w) * first + v * second + w * third


@kernel
def skin_distances(tree: SkinTree, points: Array, most: float, found: Array) -> None:
    """The same of points (n, 3) into `found` (n,)."""
    waiting = np.zeros(DEEPEST, np.int64)
    for p in range(points.shape[0]):
        found[p] = skin_distance(tree, points[p, 0], points[p, 1], points[p, 2], most, waiting)
