"""Fewer triangles: closed, with the volume of before, nowhere farther off than was allowed."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.material.decimation import CLOSE, decimated
from gcodesim.material.surface import Surface
from tests.unit.material.test_surface import MM, assert_closed, block

WAY = np.array([[-5, 15, -4], [20, 22, -6], [33, 20, -3]]) * MM
BALL = shape.ball(8 * MM, 30 * MM)


def cut(tool, resolution: float = 0.4) -> Surface:
    stock = block(resolution)
    stock.remove(WAY[:-1], WAY[1:], tool)
    return stock.surface()


def farthest(one: Surface, other: Surface) -> float:
    """Greatest distance [m] of some points of one surface from the other: corners and points inside of each face."""
    from gcodesim.material.deviation_kernels import FAR
    from gcodesim.material.distance_kernels import skin_distances
    from gcodesim.material.distance_tree import skin_tree

    shares = np.random.default_rng(3).dirichlet((1.0, 1.0, 1.0), 8)
    inside = np.einsum("sk,fkc->sfc", shares, one.vertices[one.faces]).reshape(-1, 3)
    points = np.ascontiguousarray(np.concatenate([one.vertices, inside]))
    found = np.zeros(len(points))
    skin_distances(skin_tree(other.vertices, other.faces), points, FAR, found)
    return float(found.max())


@pytest.mark.parametrize("tool", [BALL, shape.cone(8 * MM, 2.0, 20 * MM), shape.flat(8 * MM, 30 * MM)])
@pytest.mark.parametrize("tolerance", [0.02 * MM, 0.3 * MM])
def test_it_is_closed_as_large_and_within_the_tolerance(tool, tolerance: float) -> None:
    fine = cut(tool)
    coarse = decimated(fine, tolerance)

    assert_closed(coarse)
    assert coarse.volume == pytest.approx(fine.volume, rel=CLOSE)
    assert max(farthest(fine, coarse), farthest(coarse, fine)) <= tolerance
    assert len(coarse.faces) < len(fine.faces) * (0.7 if tolerance < 0.1 * MM else 0.4)


def test_what_was_flat_is_exactly_there() -> None:
    """Floor, top and sides of a slot keep their places, though the walls of its round ends are moved."""
    stock = block(0.25)
    stock.remove(np.array([[10, 15, -4]]) * MM, np.array([[30, 15, -4]]) * MM, shape.flat(8 * MM, 30 * MM))
    fine = stock.surface()
    coarse = decimated(fine, 0.1 * MM)

    assert len(coarse.faces) < len(fine.faces) / 10
    assert set(np.round(coarse.vertices[:, 2] / MM, 9)) == {-15.0, -4.0, 0.0}
    assert (coarse.vertices.min(axis=0) == fine.vertices.min(axis=0)).all()
    assert (coarse.vertices.max(axis=0) == fine.vertices.max(axis=0)).all()


def test_sheets_that_meet_in_a_point_stay_closed() -> None:
    """Two pyramids with one tip: its faces are no single fan, so it stays."""
    base = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * MM
    up, down = (np.column_stack([base, np.full(4, z)]) for z in (2 * MM, -2 * MM))
    points = np.concatenate([np.zeros((1, 3)), up, down])
    faces = [[1, 2, 3], [1, 3, 4], [6, 5, 7], [7, 5, 8]]
    faces += [[0, 1 + (k + 1) % 4, 1 + k] for k in range(4)] + [[0, 5 + k, 5 + (k + 1) % 4] for k in range(4)]
    tips = Surface(vertices=points, faces=np.array(faces, dtype=np.int32), cut=np.zeros(len(faces), dtype=np.uint8))
    assert_closed(tips)
    coarse = decimated(tips, 0.1 * MM)

    assert_closed(coarse)
    assert coarse.volume == pytest.approx(tips.volume, rel=CLOSE) and coarse.volume > 0.0
    assert [0.0, 0.0, 0.0] in coarse.vertices.tolist()


def test_a_box_has_twelve_triangles() -> None:
    stock = Stock.box((0, 0, 0), (10 * MM, 8 * MM, 5 * MM), 0.5 * MM)
    stock.remove(np.array([[-9, 4, 3]]) * MM, np.array([[19, 4, 3]]) * MM, shape.flat(12 * MM, 30 * MM))

    assert len(decimated(stock.surface(), 0.01 * MM).faces) == 12
