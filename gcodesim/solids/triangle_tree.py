"""Trees of boxes over triangles, for rays and for what a cone reaches."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.ray_kernels import Boxes, TriangleEdges

Ints = NDArray[np.int64]

LEAF: Final = 4
"""Triangles in a leaf."""

_BITS: Final = 20  # of each coordinate in the order along the curve
_NOWHERE: Final = 1e30  # m


class TriangleTree(NamedTuple):
    """Triangles in a tree. `order` (t,) says which of the given triangles each one is."""

    boxes: Boxes
    corners: TriangleEdges
    order: Ints


def tree_of(mesh: Triangles) -> TriangleTree:
    """A tree over at least one triangle.

    Triangles are put in the order of a Z curve through their middles (Morton 1966); runs of `LEAF` of them are leaves.
    """
    points = np.asarray(mesh.points, dtype=float)
    a, b, c = (points[mesh.faces[:, k]] for k in range(3))
    order = np.argsort(_along_curve((a + b + c) / 3.0), kind="stable")
    a, b, c = a[order], b[order], c[order]
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    corners = TriangleEdges(np.ascontiguousarray(a), np.ascontiguousarray(b - a), np.ascontiguousarray(c - a))
    return TriangleTree(_boxes(low, high, LEAF), corners, order)


def wider(tree: TriangleTree, leaf: int) -> Boxes:
    """Boxes over the same triangles in the same order with up to `leaf` triangles in each of the last ones."""
    a = tree.corners.corner
    b, c = a + tree.corners.along, a + tree.corners.across
    return _boxes(np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c), leaf)


def _along_curve(points: Array) -> Ints:
    """Numbers (n,) along a Z curve through the box of `points` (n, 3)."""
    low = points.min(axis=0)
    size = float(np.ptp(points, axis=0).max()) or 1.0
    cell = np.minimum(((points - low) / size * 2.0**_BITS).astype(np.int64), 2**_BITS - 1)
    number = np.zeros(len(points), dtype=np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            number |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return number


def _boxes(low: Array, high: Array, leaf: int) -> Boxes:
    """The full binary tree over items with corners `low`, `high` (t, 3) in order, `leaf` of them in a leaf."""
    count = len(low)
    leaves = max(1, -(-count // leaf))
    depth = (leaves - 1).bit_length()
    width = 1 << depth
    least, most = np.full((width * leaf, 3), np.inf), np.full((width * leaf, 3), -np.inf)
    least[:count], most[:count] = low, high
    level = [(least.reshape(width, leaf, 3).min(axis=1), most.reshape(width, leaf, 3).max(axis=1))]
    for _ in range(depth):
        below = level[-1]
        level.append((below[0].reshape(-1, 2, 3).min(axis=1), below[1].reshape(-1, 2, 3).max(axis=1)))
    nodes = 2 * width - 1
    box, skip = np.empty((nodes, 6)), np.empty(nodes, dtype=np.int64)
    begin, end = np.zeros(nodes, dtype=np.int64), np.zeros(nodes, dtype=np.int64)
    at = np.zeros(1, dtype=np.int64)  # place of each node of a level in the order of the walk
    for down in range(depth + 1):
        size = (2 << (depth - down)) - 1  # of a part
        box[at, :3], box[at, 3:] = level[depth - down]
        skip[at] = at + size
        if down == depth:
            begin[at] = np.minimum(leaf * np.arange(width), count)
            end[at] = np.minimum(leaf * np.arange(1, width + 1), count)
        else:
            half = size // 2
            at = np.stack([at + 1, at + 1 + half], axis=1).reshape(-1)
    box[box[:, 0] > box[:, 3]] = _NOWHERE  # nodes without items: no ray comes there
    return Boxes(box, skip, begin, end)


def joined(trees: list[TriangleTree]) -> tuple[Boxes, TriangleEdges, Ints]:
    """Several trees in one set of arrays: tree k has the nodes first[k] to first[k + 1]."""
    nodes = np.cumsum([0, *(len(tree.boxes.skip) for tree in trees)])
    items = np.cumsum([0, *(len(tree.order) for tree in trees)])
    boxes = Boxes(
        np.concatenate([np.zeros((0, 6)), *(tree.boxes.box for tree in trees)]),
        np.concatenate([nodes[:0], *(tree.boxes.skip + at for tree, at in zip(trees, nodes[:-1], strict=True))]),
        np.concatenate([nodes[:0], *(_shifted(tree, 0, at) for tree, at in zip(trees, items[:-1], strict=True))]),
        np.concatenate([nodes[:0], *(_shifted(tree, 1, at) for tree, at in zip(trees, items[:-1], strict=True))]),
    )
    parts = ([np.zeros((0, 3)), *(tree.corners[k] for tree in trees)] for k in range(3))
    corners = TriangleEdges(*(np.concatenate(part) for part in parts))
    return boxes, corners, nodes


def _shifted(tree: TriangleTree, which: int, at: int) -> Ints:
    """Begin (0) or end (1) of the leaves, `at` further on; inner nodes keep none."""
    edge = (tree.boxes.begin, tree.boxes.end)[which]
    return np.where(tree.boxes.end > tree.boxes.begin, edge + at, 0)
