"""Stock set down on another side."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from gcodesim.material import Stock
from gcodesim.material.kernels import beyond_columns
from gcodesim.material.shape import flat
from gcodesim.material.stock_file import load_stock, save_stock
from gcodesim.material.turning import turn_for, turned

MM = 1e-3
TURNS = [
    R
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
    if np.linalg.det(R := np.diag(signs)[list(order)]) > 0.0
]


def milled() -> Stock:
    """A block with a slot along a slanted line, neither on the grid."""
    stock = Stock.box((0, 0, -12 * MM), (40 * MM, 30 * MM, 0), 0.5 * MM, "steel")
    path = np.array([[3.1, 4.3, -5.0], [33.3, 21.7, -5.0]]) * MM
    stock.remove(path[:1], path[1:], flat(6 * MM, 50 * MM))
    return stock


def full(stock: Stock, points: np.ndarray) -> np.ndarray:
    """Whether each point (p, 3) of the columns' frame is in material."""
    i, j = ((points[:, :2] - stock.origin) // stock.spacing).astype(int).T
    lo, hi = stock.field.columns.lo[i, j], stock.field.columns.hi[i, j]
    used = np.arange(lo.shape[1])[None] < stock.field.columns.number[i, j][:, None]
    return (used & (lo <= points[:, 2:]) & (points[:, 2:] < hi)).any(axis=1)


def test_there_are_24_turns():
    assert len(TURNS) == 24


@pytest.mark.parametrize("R", TURNS)
def test_every_turn_keeps_material_where_it_is(R):
    stock = milled()
    other = turned(stock, R)
    points = np.random.default_rng(1).uniform([0, 0, -12 * MM], [40 * MM, 30 * MM, 0], (4000, 3))
    agree = full(stock, points) == full(other, points @ R.T)
    exact = abs(R[2, 2]) == 1.0
    assert agree.mean() == 1.0 if exact else agree.mean() > 0.99
    assert other.volume == pytest.approx(stock.volume, rel=1e-9 if exact else 2e-3)
    assert other.error_bound() == 0.0
    assert np.allclose(other.turn, R.T)


@pytest.mark.parametrize("R", [R for R in TURNS if abs(R[2, 2]) == 1.0])
def test_turning_over_and_back_is_the_same_to_the_bit(R):
    stock = milled()
    back = turned(turned(stock, R), R.T)
    used = np.arange(stock.field.columns.lo.shape[2])[None, None] < stock.field.columns.number[:, :, None]
    assert np.array_equal(back.field.columns.number, stock.field.columns.number)
    for one, other in zip(back.field.columns[:2], stock.field.columns[:2], strict=True):
        assert np.array_equal(one[used], other[used])
    assert np.array_equal(back.field.walls, stock.field.walls)
    assert back.field.grid == pytest.approx(stock.field.grid, abs=1e-15)
    assert np.array_equal(back.turn, np.eye(3))


@pytest.mark.parametrize("resolution", [0.5, 0.35, 0.25, 0.2, 0.15])
@pytest.mark.parametrize("place", [(0.0, 0.0), (0.07, 0.11)])
def test_the_bound_of_a_hole_from_both_sides_holds(resolution, place):
    """Walls are kept from the top down: where the second side meets those of the first, parts of cells are lost."""
    stock = Stock.box((0, 0, -10 * MM), (24 * MM, 20 * MM, 0), resolution * MM)
    x, y = 12 + place[0], 10 + place[1]
    fresh = stock.volume
    stock.remove(*np.array([[[x, y, 1.0]], [[x, y, -4.0]]]) * MM, flat(8 * MM, 50 * MM))
    over = turned(stock, np.diag([1.0, -1.0, -1.0]))
    first = fresh - over.volume
    over.remove(*np.array([[[x, -y, 11.0]], [[x, -y, 3.0]]]) * MM, flat(8 * MM, 50 * MM))

    assert over.hung.sum() == pytest.approx(float(beyond_columns(stock.field.walls)), abs=1e-12)
    exact = np.pi * 16.0 * 10.0 * MM**3
    assert abs(fresh - over.volume - exact) < over.error_bound() + stock.error_bound()
    assert first == pytest.approx(0.4 * exact, abs=stock.error_bound())


@pytest.mark.parametrize("up", np.vstack([np.eye(3), -np.eye(3), [[0.4, 0.1, 0.9], [0.1, -0.9, 0.3]]]))
def test_the_axis_that_points_up_becomes_z(up):
    R = turn_for(up)
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert (R @ up)[2] == np.abs(up).max()


def test_only_quarter_turns():
    with pytest.raises(ValueError, match="quarter turns"):
        turned(milled(), np.diag([1.0, 1.0, -1.0]))


def test_a_file_keeps_the_side_it_lies_on(tmp_path):
    stock = turned(milled(), np.diag([1.0, -1.0, -1.0]))
    save_stock(stock, tmp_path / "a.stock")
    again = load_stock(tmp_path / "a.stock")
    assert np.array_equal(again.turn, stock.turn) and again.volume == stock.volume
