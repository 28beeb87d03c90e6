"""Which pass of a tool made a face."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material import shape
from gcodesim.material.pass_kernels import PassPieces
from gcodesim.material.passes import Passes
from gcodesim.material.solid_of_revolution import outline_of_slabs, slabs_of_shape

MM = 1e-3
UP = (0.0, 0.0, 1.0)
MILL = outline_of_slabs(slabs_of_shape(shape.cylinder(6 * MM, 0.0, 20 * MM), 0.1 * MM))
BALL = outline_of_slabs(slabs_of_shape(shape.ball(6 * MM, 20 * MM), 0.1 * MM))


def pieces(points, axis=UP):
    points = np.array(points, dtype=float) * MM
    axes = np.tile(np.array(axis, dtype=float), (len(points) - 1, 1))
    return PassPieces(points[:-1], points[1:], axes, axes, np.zeros(len(points) - 1, np.int32))


def row_at(passes, point, slack=0.01):
    found = passes.makers(np.array([point], dtype=float) * MM, slack * MM)
    return int(found.row[0]), float(found.gap[0]) / MM


def test_the_outlines_of_tools_are_theirs():
    assert np.abs(MILL[:, 0]).max() == pytest.approx(3 * MM)
    assert (MILL[:, 1].min(), MILL[:, 1].max()) == pytest.approx((0.0, 20 * MM))
    below = BALL[BALL[:, 1] <= 3 * MM]
    assert np.hypot(below[:, 0], below[:, 1] - 3 * MM) == pytest.approx(np.full(len(below), 3 * MM), abs=2e-6)


def test_the_pass_whose_floor_a_face_is_made_it_and_not_one_above():
    passes = Passes()
    passes.add(MILL, pieces([(0, 0, 5), (40, 0, 5)]), np.array([7]))
    passes.add(MILL, pieces([(0, 0, 3), (40, 0, 3)]), np.array([9]))
    passes.add(MILL, pieces([(0, 0, 3), (40, 0, 3)]), np.array([11]))  # a second time: nothing is left to cut
    assert row_at(passes, (20, 1, 3)) == (9, pytest.approx(0.0, abs=1e-6))
    assert row_at(passes, (20, 3, 5.5)) == (7, pytest.approx(0.0, abs=1e-6))


def test_where_no_pass_made_a_face_the_nearest_is_told():
    passes = Passes()
    passes.add(MILL, pieces([(0, 0, 5), (40, 0, 5)]), np.array([7]))
    passes.add(BALL, pieces([(0, 20, 5), (40, 20, 5)]), np.array([8]))
    assert row_at(passes, (20, 10, 5)) == (7, pytest.approx(7.0, abs=1e-4))
    assert row_at(passes, (20, 14, 8)) == (8, pytest.approx(3.0, abs=1e-4))
    only = passes.makers(np.array([(20, 10, 5)]) * MM, 0.01 * MM, [np.arange(9) == 8])
    assert only.row[0] == 8
    assert Passes().makers(np.zeros((1, 3)), 1e-6).row[0] == -1


def test_straight_neighbours_of_a_row_become_one_piece():
    passes = Passes()
    passes.add(MILL, pieces([(x, 0, 5) for x in range(11)]), np.array([1] * 6 + [2] * 4))
    joined, rows, _ = passes._joined()
    assert rows.tolist() == [1, 2]
    assert joined.ends[:, 0] == pytest.approx([6 * MM, 10 * MM])


def test_a_leaning_tool_is_asked_along_its_axis():
    lean = np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0)
    passes = Passes()
    passes.add(MILL, pieces([(0, 0, 0), (0, 10, 0)], lean), np.array([4]))
    across = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
    point = 8 * lean + 3 * across + [0, 5, 0]
    assert row_at(passes, point) == (4, pytest.approx(0.0, abs=1e-6))
    assert row_at(passes, point + 2 * across)[1] == pytest.approx(2.0, abs=1e-4)


def test_on_a_lathe_a_blade_makes_a_face_all_around():
    blade = np.array([(0.0, 0.0), (5.0, 3.0), (5.0, 6.0), (0.0, 3.0)]) * MM  # (r, z)
    passes = Passes(lathe=True)
    passes.add(blade, pieces([(8, 0, 30), (8, 0, 10)]), np.array([5]))
    for turn in (0.0, 1.0, 2.5):
        assert row_at(passes, (8 * np.cos(turn), 8 * np.sin(turn), 20)) == (5, pytest.approx(0.0, abs=1e-6))
