"""Lines to draw: cut from paths, and thinned to what a viewer takes."""

import numpy as np
import pytest

from gcodesim.log import DrawnMesh, Polylines


def test_no_segment_leads_from_one_line_to_the_next():
    lines = Polylines(np.arange(18.0).reshape(6, 3), np.array([0, 3]))

    assert lines.segments().tolist() == [[0, 1], [1, 2], [3, 4], [4, 5]]
    assert Polylines.none().segments().tolist() == []


def test_a_long_path_is_drawn_coarser_but_with_its_ends():
    t = np.linspace(0.0, 20.0, 50_001)
    spiral = np.stack([t * np.cos(t), t * np.sin(t), t], axis=1)
    lines = Polylines(np.concatenate([spiral, spiral + 5.0]), np.array([0, len(spiral)]))
    thin = lines.thinned(1000)

    assert 900 < len(thin.points) <= 1000
    assert thin.points[thin.starts].tolist() == lines.points[lines.starts].tolist()
    assert thin.points[-1].tolist() == lines.points[-1].tolist()
    step = np.linalg.norm(np.diff(thin.points, axis=0), axis=1)[thin.segments()[:, 0]]
    assert step.max() < 3 * step.mean()


def test_of_too_many_lines_the_longest_are_drawn():
    length = np.random.default_rng(2).permutation(1000) + 1.0
    points = np.zeros((1000, 2, 3))
    points[:, 1, 0] = length
    lines = Polylines(points.reshape(-1, 3), np.arange(0, 2000, 2)).thinned(200)

    assert len(lines.points) <= 200 and len(lines.starts) == 50
    assert lines.points[lines.segments()[:, 1], 0].min() == 951.0


def test_a_mesh_without_its_unused_points_is_the_same():
    rng = np.random.default_rng(6)
    points = rng.normal(size=(500, 3))
    triangles = rng.choice(np.arange(0, 500, 3), (200, 3))
    mesh = DrawnMesh(points=points, triangles=triangles)
    small = mesh.compact()
    assert (small.points[small.triangles] == points[triangles]).all()
    assert len(small.points) == len(np.unique(triangles))
    assert small.compact() is small  # all are used


@pytest.mark.parametrize("wrong", [-1, 3])
def test_a_triangle_outside_its_mesh_is_refused(wrong):
    with pytest.raises(ValueError, match="outside its mesh"):
        DrawnMesh(points=np.zeros((3, 3)), triangles=np.array([[0, 1, 2], [0, wrong, 1]])).compact()
