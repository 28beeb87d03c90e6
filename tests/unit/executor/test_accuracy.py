"""Distances from a path, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.executor.accuracy import BEHIND, distances


def line(n: int, step: float = 1e-3) -> np.ndarray:
    return np.column_stack([step * np.arange(1, n + 1), np.zeros(n), np.zeros(n)])


def test_a_tip_that_is_late_is_on_its_path() -> None:
    way = line(100)
    late = way - np.array([7.3e-3, 0.0, 0.0])

    assert distances(late[20:], way, 20) == pytest.approx(np.zeros(80), abs=1e-15)


def test_a_tip_that_is_beside_its_path_is_so_far_off() -> None:
    way = line(100)
    beside = way + np.array([-2.5e-3, 0.3e-3, -0.4e-3])

    assert distances(beside[20:], way, 20) == pytest.approx(np.full(80, 0.5e-3), rel=1e-12)


def test_a_corner_that_is_cut_is_measured_at_the_nearest_leg() -> None:
    way = np.concatenate(
        [line(20), line(20)[-1] + np.column_stack([np.zeros(20), 1e-3 * np.arange(1, 21), np.zeros(20)])]
    )
    corner = way[19]
    inside = np.tile(corner + np.array([-2e-3, 1e-3, 0.0]), (1, 1))

    assert distances(inside, way[:25], 24) == pytest.approx([1e-3])


def test_no_more_than_some_steps_back_count() -> None:
    way = line(3 * BEHIND)
    stuck = np.tile(way[0], (1, 1))

    found = distances(stuck, way, len(way) - 1)

    assert found[0] == pytest.approx((2 * BEHIND - 1) * 1e-3, rel=0.02)


def test_where_windows_end_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    way = np.cumsum(rng.normal(scale=1e-3, size=(200, 3)), axis=0)
    tips = way + rng.normal(scale=1e-4, size=(200, 3))
    whole = distances(tips, way, 0)
    second = distances(tips[120:], way[120 - BEHIND :], BEHIND)

    assert np.array_equal(whole[120:], second)
