"""Stock set down on another side."""

from __future__ import annotations

from itertools import permutations, product

import numpy as np
import pytest

from gcodesim.material import Stock
from gcodesim.material.axis_way import AxisWay
from gcodesim.material.shape import flat
from gcodesim.material.solid_of_revolution import slabs_of_shape
from gcodesim.material.stock_file import load_stock, save_stock
from gcodesim.material.turning import turn_for, turned
from gcodesim.material.wall_kernels import TURNED_PLANES

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
    assert other.volume == pytest.approx(stock.volume, rel=1e-9 if exact else 2e-5)
    assert other.error_bound() == 0.0
    assert np.allclose(other.turn, R.T)


def leaning() -> Stock:
    """A block with a slot by a tool that leans."""
    stock = Stock.box((0, 0, -12 * MM), (40 * MM, 30 * MM, 0), 0.5 * MM)
    ends = np.array([[[3.1, -5.0, -5.0]], [[33.3, 41.7, -4.0]]]) * MM
    axis = np.array([[np.sin(0.5), 0.0, np.cos(0.5)]])
    stock.sweep(AxisWay(ends[0], ends[1], axis, axis), slabs_of_shape(flat(6 * MM, 50 * MM), stock.cell))
    return stock


@pytest.mark.parametrize("R", TURNS)
def test_what_a_leaning_tool_has_left_stays_where_it_is(R):
    """Columns in three directions change places; they were given up, and with them 0.1 % of what had been removed."""
    stock = leaning()
    other = turned(stock, R)
    points = np.random.default_rng(2).uniform([0, 0, -12 * MM], [40 * MM, 30 * MM, 0], (4000, 3))
    assert other.columns_along == 3 and other.error_bound() == 0.0
    assert other.volume == pytest.approx(stock.volume, rel=5e-5)  # faces are divided into triangles otherwise
    assert (full(stock, points) == full(other, points @ R.T)).mean() > 0.99
    corners = np.sort(np.array(stock.bounds) @ R.T, axis=0)
    assert np.allclose(other.bounds, corners, atol=1e-12)
    back = turned(other, R.T)
    assert back.volume == pytest.approx(stock.volume, rel=1e-9)


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
    """Where the second side meets the walls of the first, they are one wall."""
    stock = Stock.box((0, 0, -10 * MM), (24 * MM, 20 * MM, 0), resolution * MM)
    x, y = 12 + place[0], 10 + place[1]
    fresh = stock.volume
    stock.remove(*np.array([[[x, y, 1.0]], [[x, y, -4.0]]]) * MM, flat(8 * MM, 50 * MM))
    over = turned(stock, np.diag([1.0, -1.0, -1.0]))
    first = fresh - over.volume
    over.remove(*np.array([[[x, -y, 11.0]], [[x, -y, 3.0]]]) * MM, flat(8 * MM, 50 * MM))

    exact = np.pi * 16.0 * 10.0 * MM**3
    assert abs(fresh - over.volume - exact) < over.error_bound() + stock.error_bound()
    assert over.error_bound() < 2.0 * stock.error_bound()
    assert first == pytest.approx(0.4 * exact, abs=stock.error_bound())


def window(rng: np.random.Generator) -> np.ndarray:
    """A rectangle (5, 2) [mm] that begins and ends at a corner, turned by any angle or along the grid."""
    angle = np.radians(rng.choice([0.0, 90.0, rng.uniform(0.0, 90.0)]))
    R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * rng.uniform(4, 10, 2)
    return corners @ R.T + rng.uniform(-1, 1, 2)


def swept_area(corners: np.ndarray, diameter: float) -> float:
    """Area [mm²] under a disc that goes around a rectangle: Steiner's ring, without that of the inner rectangle."""
    sides = np.linalg.norm(np.diff(corners, axis=0), axis=1)[:2]
    inner = np.prod(np.maximum(sides - diameter, 0.0))
    return float(np.prod(sides) + diameter * sides.sum() + np.pi / 4.0 * diameter**2 - inner)


@pytest.mark.parametrize("seed", range(12))
def test_walls_cut_from_both_ends_are_as_exact_as_from_one(seed):
    """A frame is milled from above and, after turning over, from the other end, a bit too short or overlapping.

    What the second side took of straight walls was wrong by up to 2 %, from half a cell at the sides.
    """
    rng = np.random.default_rng(seed)
    height, diameter = rng.uniform(8, 20), rng.uniform(4, 8)
    corners, first = window(rng), rng.uniform(0.2, 0.8) * height
    second = min(height - first + rng.uniform(-1, 2), height + 1)
    stock = Stock.box((-22 * MM, -22 * MM, -height * MM), (22 * MM, 22 * MM, 0), 0.25 * MM)
    for depth, top in ((first, 0.0), (second, height)):
        if top:
            stock = turned(stock, np.diag([1.0, -1.0, -1.0]))
            corners = corners * [1, -1]
        path = np.vstack([[*corners[0], top + 1], np.c_[corners, np.full(5, top - depth)]]) * MM
        before = stock.volume
        removed = stock.remove(path[:-1], path[1:], flat(diameter * MM, 50 * MM)).volume.sum()
        exact = swept_area(corners, diameter) * (min(depth, height - first) if top else depth) * MM**3
        assert removed == pytest.approx(before - stock.volume, abs=1e-15)
        assert removed == pytest.approx(exact, rel=5e-4)
        assert abs(removed - exact) < stock.error_bound() < 2e-3 * exact


def test_a_pocket_keeps_its_volume_when_the_stock_is_laid_on_an_edge():
    """Floors between the new columns keep their place: half a cell of one was 9 mm³ here."""
    for R in TURNS:
        stock = milled()
        assert turned(stock, R).volume == pytest.approx(stock.volume, abs=0.3 * MM**3)


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
    assert len(stock.field.walls) == TURNED_PLANES
    save_stock(stock, tmp_path / "a.stock")
    again = load_stock(tmp_path / "a.stock")
    assert np.array_equal(again.turn, stock.turn) and again.volume == stock.volume
    assert np.array_equal(again.field.walls, stock.field.walls)
