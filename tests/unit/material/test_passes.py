"""Which pass of a tool made a face."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material import shape
from gcodesim.material.pass_kernels import PassPieces, nearest_pass
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


def drawn_passes(seed, *, lathe):
    """Two bodies by turns, short pieces and long ones, axes that turn, and a way back over the same places."""
    rng = np.random.default_rng(seed)
    passes = Passes(lathe=lathe)
    for number in range(8):
        points = np.cumsum(rng.normal(size=(30, 3)) * rng.choice([0.3, 8.0], size=(30, 1)), axis=0)
        points[:, 1] *= not lathe
        axes = rng.normal(size=(30, 3)) * 0.2 + UP
        axes = np.tile(UP, (30, 1)) if lathe else axes / np.linalg.norm(axes, axis=1)[:, None]
        straight = PassPieces(points[:-1] * MM, points[1:] * MM, axes[:-1], axes[1:], np.zeros(29, np.int32))
        passes.add((MILL, BALL)[number % 2], straight, np.arange(29) + 100 * number)
        passes.add((MILL, BALL)[number % 2], straight, np.arange(29) + 1000 + 100 * number)
    return passes, rng.normal(size=(150, 3)) * [20 * MM, 20 * MM, 20 * MM]


@pytest.mark.parametrize("lathe", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_no_pass_is_asked_in_vain_and_none_is_left_out(seed, lathe):
    """The tree over the passes answers as if each point had asked each of them, one after the other."""
    passes, points = drawn_passes(seed, lathe=lathe)
    pieces, rows, _ = passes._joined()
    bodies = passes._bodies()
    slack = 1.0 * MM
    wanted = [np.arange(2000) % 3 > 0]
    some = np.flatnonzero(wanted[0][rows])
    gaps = np.array([[nearest_pass(pieces, bodies, c, point, np.inf, -np.inf) for c in some] for point in points])
    near = gaps <= slack
    first, nearest = some[np.argmax(near, axis=1)], some[np.argmin(gaps, axis=1)]
    assert 10 < near.any(axis=1).sum() < 140
    told = passes.makers(points, slack, wanted)
    assert told.row.tolist() == rows[np.where(near.any(axis=1), first, nearest)].tolist()
    assert told.gap[~near.any(axis=1)].tolist() == gaps.min(axis=1)[~near.any(axis=1)].tolist()
    within = passes.makers(points, slack, wanted, within=True)
    assert within.row.tolist() == np.where(near.any(axis=1), rows[first], -1).tolist()
    assert (within.gap <= slack).tolist() == near.any(axis=1).tolist()
    deepest = passes.makers(points, -np.inf)
    every = [[nearest_pass(pieces, bodies, c, point, np.inf, -np.inf) for c in range(len(rows))] for point in points]
    assert deepest.gap.tolist() == np.min(every, axis=1).tolist()


def test_a_pass_that_comes_after_is_known_as_well():
    passes = Passes()
    passes.add(MILL, pieces([(0, 0, 5), (40, 0, 5)]), np.array([7]))
    assert row_at(passes, (20, 1, 5))[0] == 7
    passes.add(MILL, pieces([(0, 30, 5), (40, 30, 5)]), np.array([8]))
    assert row_at(passes, (20, 31, 5))[0] == 8
