"""Trees over triangles: the same answers as looking at every triangle."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.solids import Box
from gcodesim.solids.mesh_file import Triangles
from gcodesim.solids.ray_kernels import blocked, horizons
from gcodesim.solids.triangle_tree import joined, tree_of, wider
from gcodesim.solids.triangles import triangles_of


def scattered(count: int, seed: int) -> Triangles:
    """Small triangles in a box of 1 m."""
    rng = np.random.default_rng(seed)
    points = (rng.random((count, 1, 3)) + 0.1 * rng.standard_normal((count, 3, 3))).reshape(-1, 3)
    return Triangles(points=points, faces=np.arange(3 * count, dtype=np.int32).reshape(-1, 3))


def crossed(mesh: Triangles, start: np.ndarray, end: np.ndarray) -> bool:
    """Whether any triangle has the two points on different sides, and the line between them within its edges."""
    for a, b, c in mesh.points[mesh.faces]:
        ends = [np.dot(np.cross(b - a, c - a), p - a) for p in (start, end)]
        if ends[0] * ends[1] >= 0.0:
            continue
        sides = [np.dot(np.cross(q - start, r - start), end - start) for q, r in ((a, b), (b, c), (c, a))]
        if all(side > 0.0 for side in sides) or all(side < 0.0 for side in sides):
            return True
    return False


@pytest.mark.parametrize("count", [1, 4, 5, 33, 200])
def test_a_ray_is_blocked_where_it_crosses_a_triangle(count: int) -> None:
    mesh = scattered(count, seed=count)
    tree = tree_of(mesh)
    rng = np.random.default_rng(7)
    rays = rng.random((60, 2, 3)) * 1.4 - 0.2
    nodes = len(tree.boxes.skip)

    found = [blocked(tree.boxes, tree.corners, 0, nodes, ray, 0.0) for ray in rays]

    assert found == [crossed(mesh, *ray) for ray in rays]
    assert sorted(tree.order.tolist()) == list(range(count))
    if count > 30:
        assert 0 < sum(found) < len(found)


def test_what_is_nearer_than_allowed_does_not_count() -> None:
    wall = Triangles(points=np.array([[0.0, -1, -1], [0, 3, -1], [0, -1, 3]]), faces=np.array([[0, 1, 2]], np.int32))
    tree = tree_of(wall)
    ray = np.array([[-0.01, 0.0, 0.0], [1.0, 0.0, 0.0]])

    assert blocked(tree.boxes, tree.corners, 0, 1, ray, 0.009)
    assert not blocked(tree.boxes, tree.corners, 0, 1, ray, 0.011)


def test_joined_trees_keep_to_themselves() -> None:
    near, far = scattered(40, 1), scattered(9, 2)
    far = Triangles(points=far.points + 10.0, faces=far.faces)
    boxes, corners, first = joined([tree_of(near), tree_of(far)])
    rng = np.random.default_rng(3)
    for shift, mesh, k in ((0.0, near, 0), (10.0, far, 1)):
        for ray in rng.random((40, 2, 3)) + shift:
            assert blocked(boxes, corners, first[k], first[k + 1], ray, 0.0) == crossed(mesh, *ray)
            assert not blocked(boxes, corners, first[1 - k], first[2 - k], ray, 0.0)


def test_faces_over_which_nothing_rises() -> None:
    """All of a box; of two boxes side by side those that look away from each other, and upwards if they are as high."""
    low, high = triangles_of(Box(lower=(0, 0, 0), upper=(1, 1, 1))), triangles_of(Box(lower=(2, 0, 0), upper=(3, 1, 2)))
    both = Triangles(
        points=np.concatenate([low.points, high.points]),
        faces=np.concatenate([low.faces, high.faces + len(low.points)]),
    )
    tree = tree_of(both)
    normal = np.cross(tree.corners.along, tree.corners.across)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    middle = tree.corners.corner + (tree.corners.along + tree.corners.across) / 3.0
    horizon = np.zeros(len(middle))

    horizons(tree.boxes, tree.corners, middle, normal, 1e-6, horizon)

    shaded = ((normal[:, 0] > 0.5) & (middle[:, 0] < 1.5)) | ((normal[:, 0] < -0.5) & (middle[:, 0] > 1.5))
    shaded |= (normal[:, 2] > 0.5) & (middle[:, 2] < 1.5)
    assert (horizon > 0.06).tolist() == shaded.tolist()


def test_nothing_is_seen_above_the_horizon() -> None:
    """Points of any triangle stand at most so high over a face as its horizon says."""
    mesh = scattered(60, 5)
    tree = tree_of(mesh)
    rng = np.random.default_rng(8)
    centre, normal = rng.random((20, 3)), rng.standard_normal((20, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    horizon = np.zeros(20)
    horizons(tree.boxes, tree.corners, centre, normal, 0.0, horizon)

    weights = rng.dirichlet(np.ones(3), size=50)
    points = np.einsum("wk,tkc->twc", weights, mesh.points[mesh.faces]).reshape(-1, 3)
    ways = points[None] - centre[:, None]
    sines = (ways * normal[:, None]).sum(axis=2) / np.linalg.norm(ways, axis=2)
    assert (sines.max(axis=1) <= horizon + 1e-12).all()


@pytest.mark.parametrize("count", [1, 31, 32, 33, 1000])
def test_wider_boxes_hold_the_same_triangles(count: int) -> None:
    tree = tree_of(scattered(count, seed=count))
    boxes = wider(tree, 32)
    held = np.zeros(count, dtype=int)
    corners = np.stack([tree.corners.corner + way for way in (0.0, tree.corners.along, tree.corners.across)])
    for box, begin, end in zip(boxes.box, boxes.begin, boxes.end, strict=True):
        assert end - begin <= 32
        held[begin:end] += 1
        within = corners[:, begin:end]
        assert (within >= box[:3] - 1e-12).all() and (within <= box[3:] + 1e-12).all()
    assert (held == 1).all()
