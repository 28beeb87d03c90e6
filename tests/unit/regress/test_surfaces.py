"""Coarse and exact surfaces: differences have their place, and a wall by a hair beside its place is none."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.regress.surfaces import Coarse, coarse_of, compare_coarse, compare_stocks

MM = 1e-3


def stock(depth: float, *, x: float = 20.0, size: float = 48.0) -> Stock:
    """A box with one slot along Y: `depth` mm, 6 mm wide, centre at `x` mm."""
    made = Stock.box((0, 0, 0), (size * MM, 30 * MM, 10 * MM), 1 * MM)
    tip = (10.0 - depth) * MM
    made.remove(np.array([[x * MM, 5 * MM, tip]]), np.array([[x * MM, 25 * MM, tip]]), shape.flat(3 * MM, 30 * MM))
    return made


def test_text_and_back() -> None:
    before = coarse_of(stock(2.0))
    before.lowest[3, 4] = before.mean[3, 4] = np.nan
    after = Coarse.from_json(before.as_json())
    np.testing.assert_allclose(after.lowest, before.lowest, atol=0.51e-6)
    np.testing.assert_allclose(after.mean, before.mean, atol=0.51e-6)
    assert after.cell == pytest.approx(before.cell)


def test_mean_height_is_the_volume() -> None:
    made = stock(2.0)
    coarse = coarse_of(made)
    area = coarse.cell[0] * coarse.cell[1]
    columns = made.relief().lengths.sum() * made.spacing.prod()
    assert coarse.mean.sum() * area == pytest.approx(columns, rel=0.02)


@pytest.mark.parametrize(
    "compare", [compare_stocks, lambda n, a, b, t: compare_coarse(n, coarse_of(a), coarse_of(b), t)]
)
def test_a_deeper_slot_is_found_where_it_is(compare) -> None:
    assert compare("part", stock(2.0), stock(2.0), 0.01) is None
    assert compare("part", stock(2.0), stock(2.005), 0.01) is None
    change = compare("part", stock(2.0), stock(2.4), 0.01)
    assert change.deviation_mm == pytest.approx(0.4, abs=0.001)
    assert 17.0 <= change.x_mm <= 23.0 and 2.0 <= change.y_mm <= 28.0
    assert (change.old_mm, change.new_mm) == pytest.approx((8.0, 7.6), abs=0.001)


def test_a_wall_that_moves_over_the_middle_of_a_column_is_none() -> None:
    assert compare_stocks("part", stock(2.0, x=20.499), stock(2.0, x=20.501), 0.01) is None
    assert compare_stocks("part", stock(2.0, x=20.5), stock(2.0, x=23.5), 0.01) is not None


def test_a_groove_of_one_column_is_one() -> None:
    whole = Stock.box((0, 0, 0), (20 * MM, 20 * MM, 10 * MM), 1 * MM)
    grooved = whole.copy()
    groove = np.array([[7.5, 2.5, 9.0], [7.5, 17.5, 9.0]]) * MM
    grooved.remove(groove[:1], groove[1:], shape.flat(0.5 * MM, 10 * MM))
    change = compare_stocks("part", whole, grooved, 0.01)
    assert change.deviation_mm == pytest.approx(1.0) and change.x_mm == pytest.approx(7.5)
    assert compare_stocks("part", grooved, whole, 0.01).deviation_mm == pytest.approx(1.0)


def test_other_grids() -> None:
    assert compare_coarse("part", coarse_of(stock(2.0)), coarse_of(stock(2.0, size=50.0)), 0.01) is None
    assert compare_stocks("part", stock(2.0), stock(2.0, size=60.0), 0.01) is None
