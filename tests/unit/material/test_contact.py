"""Where points count as inside a stock: between its faces, and within half a cell of its walls."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material.contact import SKIN, in_material
from gcodesim.material.stock import Stock

CELL = 1e-3
BOX = Stock.box((0.0, 0.0, -0.01), (0.04, 0.03, 0.0), CELL, "")


def inside(*points: tuple[float, float, float]) -> list[bool]:
    found: list[bool] = in_material(BOX, np.array(points)).tolist()
    return found


def test_heights_are_exact() -> None:
    middle = (0.02, 0.015)
    assert inside((*middle, -10 * SKIN), (*middle, 0.0), (*middle, 10 * SKIN)) == [True, False, False]
    assert inside((*middle, -0.01 + 10 * SKIN), (*middle, -0.01), (*middle, -0.011)) == [True, False, False]


@pytest.mark.parametrize(("axis", "low", "high"), [(0, 0.0, 0.04), (1, 0.0, 0.03)])
def test_walls_of_a_box_stand_where_its_columns_end(axis: int, low: float, high: float) -> None:
    """Bilinear share between column centres: half of it is reached at the border of the outer column."""
    for wall, outward in ((low, -1.0), (high, 1.0)):
        points = np.tile([0.02, 0.015, -0.005], (41, 1))
        way = np.linspace(-CELL, CELL, 41)
        points[:, axis] = wall + outward * way
        found = in_material(BOX, points)
        assert np.array_equal(found, found[np.argsort(way)])
        last = way[found].max()
        assert abs(last) <= 0.05 * CELL + 1e-9


def test_far_away_there_is_nothing() -> None:
    assert inside((1.0, 0.0, -0.005), (-1.0, -1.0, -0.005), (0.02, 0.015, -1.0)) == [False] * 3


def test_no_points_and_many() -> None:
    assert in_material(BOX, np.zeros((0, 3))).tolist() == []
    rng = np.random.default_rng(3)
    points = rng.uniform((-0.01, -0.01, -0.02), (0.05, 0.04, 0.01), (600_000, 3))
    found = in_material(BOX, points)
    assert np.array_equal(found[:1000], in_material(BOX, points[:1000]))
    assert np.array_equal(found[-1000:], in_material(BOX, points[-1000:]))
