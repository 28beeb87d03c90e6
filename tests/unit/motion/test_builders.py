"""Paths from points, with the signatures of PyBullet Industrial."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from gcodesim.motion import (
    build_box_path,
    circular_interpolation,
    linear_interpolation,
    spline_interpolation,
)

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
HALF_Z = (0.0, 0.0, 1.0, 0.0)


def test_linear_interpolation_spreads_points_and_turns_evenly() -> None:
    path = linear_interpolation([0, 0, 0], [1, 2, 3], 5, UPRIGHT, (0, 0, sqrt(0.5), sqrt(0.5)))

    assert np.allclose(path.positions, np.linspace([0, 0, 0], [1, 2, 3], 5))
    assert np.allclose(np.diff(path.end[:, 5]), pi / 8)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("clockwise", [True, False])
def test_circular_interpolation_turns_the_way_it_says(axis: int, clockwise: bool) -> None:
    start, end = np.zeros(3), np.zeros(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    start[i], end[j] = 1.0, 1.0  # a quarter about the origin counterclockwise
    if clockwise:
        start, end = end, start

    points = circular_interpolation(start, end, 1.0, 40, axis, clockwise).positions

    assert np.allclose(np.hypot(points[:, i], points[:, j]), 1.0)
    turned = np.cross(points[:-1], points[1:])[:, axis]
    assert np.all(turned < 0) if clockwise else np.all(turned > 0)
    assert np.allclose(points[0], start) and np.allclose(points[-1], end)


def test_circular_interpolation_refuses_a_radius_that_does_not_reach() -> None:
    with pytest.raises(ValueError, match="too small"):
        circular_interpolation([0, 0, 0], [1, 0, 0], 0.4, 10)


def test_spline_passes_its_points_and_reproduces_a_cubic() -> None:
    x = np.linspace(0.0, 1.0, 30)
    through = np.stack([x, np.zeros(30), np.zeros(30)], axis=1)

    path = spline_interpolation(through, 11)

    assert np.allclose(path.positions, np.linspace([0, 0, 0], [1, 0, 0], 11))
    assert len(spline_interpolation(through[:3].T[:, :2].T, 4)) == 3  # two points are a line


def test_spline_takes_columns_as_pybullet_industrial_does() -> None:
    rows = np.random.default_rng(1).normal(size=(6, 3))

    assert np.allclose(spline_interpolation(rows.T, 20).positions, spline_interpolation(rows, 20).positions)


def test_box_path_is_closed_round_and_in_its_plane() -> None:
    path = build_box_path([0, 0, 1], [4.0, 2.0], UPRIGHT, 0.5, HALF_Z, 4001)
    points = path.positions

    outline = 2 * (3 + 1) + pi
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(outline, rel=1e-5)
    assert np.allclose(points[0], points[-1]) and np.allclose(points[:, 2], 1.0)
    area = 0.5 * np.abs(np.sum(points[:-1, 0] * points[1:, 1] - points[1:, 0] * points[:-1, 1]))
    assert area == pytest.approx(8 - (4 - pi) * 0.25, rel=1e-5)
    assert np.allclose(path.end[:, 5] % (2 * pi), pi)


def test_box_path_refuses_corners_that_do_not_fit() -> None:
    with pytest.raises(ValueError, match="does not fit"):
        build_box_path([0, 0, 0], [1.0, 1.0], UPRIGHT, 0.6, UPRIGHT, 10)
