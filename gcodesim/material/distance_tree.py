"""The tree of boxes in which the nearest triangle of a mesh is looked up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.material.distance_kernels import LEAF, SkinTree

Array = NDArray[np.float64]

_STEPS = 1 << 20
"""Places along an axis that the order of the triangles tells apart."""


def skin_tree(vertices: Array, faces: NDArray[np.int32]) -> SkinTree:
    """The tree over triangles: vertices (v, 3) [m], faces (f, 3) with f > 0."""
    corners = np.ascontiguousarray(vertices[faces], dtype=np.float64)
    corners = corners[in_leaves(corners)]
    least, most = corners.min(axis=1), corners.max(axis=1)
    firsts = np.arange(0, len(corners), LEAF)
    lows, highs = np.minimum.reduceat(least, firsts, axis=0), np.maximum.reduceat(most, firsts, axis=0)
    leaves = 1 << max(0, int(len(firsts) - 1).bit_length())
    boxes = np.empty((2 * leaves, 6))
    boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
    boxes[leaves : leaves + len(firsts)] = np.hstack((lows, highs))
    while leaves > 1:
        below = boxes[leaves : 2 * leaves]
        leaves //= 2
        boxes[leaves : 2 * leaves, :3] = np.minimum(below[0::2, :3], below[1::2, :3])
        boxes[leaves : 2 * leaves, 3:] = np.maximum(below[0::2, 3:], below[1::2, 3:])
    return SkinTree(corners.reshape(-1, 9), boxes)


def in_leaves(corners: Array) -> NDArray[np.intp]:
    """The order (f,) in which triangles with `corners` (f, 3, 3) stand in the tree."""
    return np.argsort(_places(corners.mean(axis=1)), kind="stable")


def _places(points: Array) -> NDArray[np.uint64]:
    """Places (n,) of points (n, 3) on a curve that keeps near points together (Morton 1966: bits in turn)."""
    low = points.min(axis=0)
    size = float((points.max(axis=0) - low).max()) or 1.0
    steps = np.minimum((points - low) / size * _STEPS, _STEPS - 1).astype(np.uint64)
    spread = np.zeros(len(points), dtype=np.uint64)
    for bit in range(20):
        for axis in range(3):
            on = (steps[:, axis] >> np.uint64(bit)) & np.uint64(1)
            spread |= on << np.uint64(3 * bit + axis)
    return spread
