"""The stock: how it is made, what it holds, how it grows."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from gcodesim.material import Stock, finest_resolution, memory_needed, shape

MM = 1e-3


def test_cells_divide_a_box_exactly_and_are_never_wider_than_asked():
    stock = Stock.box((-10 * MM, 2 * MM, -5 * MM), (21 * MM, 12 * MM, 1 * MM), 0.7 * MM, "steel")
    assert stock.field.columns.number.shape == (45, 15)
    assert (stock.spacing <= 0.7 * MM).all()
    assert stock.bounds[1][:2] == pytest.approx([21 * MM, 12 * MM], abs=1e-15)
    assert stock.volume == pytest.approx(31 * 10 * 6 * MM**3, rel=1e-12)
    assert stock.error_bound() == 0.0
    assert stock.material == "steel"


def test_a_length_that_is_a_whole_number_of_cells_stays_so():
    assert Stock.box((0, 0, 0), (0.3, 0.1, 0.1), 0.1 * MM).relief().tops.shape == (3000, 1000)


@pytest.mark.parametrize("maximum", [(0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, math.nan)])
def test_a_box_without_volume_is_refused(maximum):
    with pytest.raises(ValueError, match="stock of size"):
        Stock.box((0, 0, 0), maximum, 0.1)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_round_bars(axis):
    stock = Stock.cylinder((1 * MM, 2 * MM, 3 * MM), 30 * MM, 40 * MM, 0.2 * MM, axis=axis)
    assert stock.volume == pytest.approx(math.pi * 225 * 40 * MM**3, rel=2e-3)
    assert stock.error_bound() == 0.0


def test_memory_is_known_before_it_is_taken():
    stock = Stock.box((0, 0, 0), (80 * MM, 50 * MM, 10 * MM), 0.25 * MM)
    taken = sum(array.nbytes for array in (*stock.field.columns, stock.field.walls))
    assert memory_needed((80 * MM, 50 * MM, 10 * MM), 0.25 * MM) == pytest.approx(taken, rel=0.01)


@pytest.mark.parametrize("budget", [10_000, 1_000_000, 123_456_789])
def test_finest_resolution_fits_the_budget_and_a_finer_one_does_not(budget):
    size = (0.3, 0.2, 0.05)
    resolution = finest_resolution(size, budget)
    assert memory_needed(size, resolution) <= budget
    assert memory_needed(size, resolution * 0.85) > budget


def test_grown_columns_lose_nothing():
    """Slots at random heights by a thin tool: each overflow stops the kernel, and the sum is that of separate cuts."""
    rng = np.random.default_rng(3)
    tool = shape.flat(6 * MM, 0.4 * MM)
    heights = rng.permutation(np.arange(-19.0, -1.0, 1.0)) * MM
    starts = np.c_[np.full(18, -10 * MM), np.full(18, 10 * MM), heights]
    ends = starts + np.array([40 * MM, 0, 0])
    stock = Stock.box((0, 0, -20 * MM), (20 * MM, 20 * MM, 0), 0.5 * MM)
    result = stock.remove(starts, ends, tool)
    assert result.volume == pytest.approx(np.full(18, 20 * 6 * 0.4 * MM**3), rel=1e-9)
    assert int(stock.field.columns.number.max()) == 19
    assert stock.field.columns.lo.shape[2] == 24
    lo, hi, number = stock.field.columns
    used = np.arange(24) < number[:, :, None]
    assert (hi > lo)[used].all()
    gaps = (lo[:, :, 1:] - hi[:, :, :-1])[used[:, :, 1:]]
    assert (gaps > 0.0).all()


def test_nothing_is_removed_beside_above_and_twice():
    stock = Stock.box((0, 0, -10 * MM), (20 * MM, 20 * MM, 0), 0.5 * MM)
    tool = shape.ball(6 * MM, 20 * MM)
    outside = np.array([[-10.0, -10.0, -5.0], [-10.0, 30.0, -5.0], [10.0, 30.0, 0.0], [10.0, 10.0, 0.0]]) * MM
    assert stock.remove(outside[:-1], outside[1:], tool).volume[:2].sum() == 0.0
    points = np.array([[-5.0, 10.0, -2.0], [25.0, 12.0, -4.0]]) * MM
    assert stock.remove(points[:1], points[1:], tool).volume.sum() > 0.0
    before = stock.copy()
    assert stock.remove(points[:1], points[1:], tool).volume.sum() == 0.0
    assert np.array_equal(stock.field.columns.hi, before.field.columns.hi)


def test_removal_is_the_same_for_any_split_of_the_calls():
    rng = np.random.default_rng(11)
    points = rng.uniform((0, 0, -9), (30, 30, 0), (40, 3)) * MM
    tool = shape.bull_nose(6 * MM, 1 * MM, 8 * MM)
    at_once = Stock.box((0, 0, -10 * MM), (30 * MM, 30 * MM, 0), 0.5 * MM)
    volumes = at_once.remove(points[:-1], points[1:], tool).volume
    one_by_one = Stock.box((0, 0, -10 * MM), (30 * MM, 30 * MM, 0), 0.5 * MM)
    singles = [one_by_one.remove(a[None], b[None], tool).volume[0] for a, b in pairwise(points)]
    assert np.array_equal(volumes, singles)


def test_changed_patches_are_marked_and_others_not():
    stock = Stock.box((0, 0, -10 * MM), (64 * MM, 64 * MM, 0), 1 * MM)
    tip = np.array([[8.0, 40.0, -1.0]]) * MM
    stock.remove(tip, tip, shape.flat(6 * MM, 20 * MM))
    assert np.argwhere(stock.field.dirty).tolist() == [[0, 2]]


def test_shank_and_holder_are_reported_and_cut_nothing():
    stock = Stock.box((0, 0, -20 * MM), (40 * MM, 40 * MM, 0), 0.5 * MM)
    bodies = [shape.cylinder(10 * MM, 6 * MM, 30 * MM)]
    tool = shape.flat(6 * MM, 6 * MM)
    start, end = (
        np.array([[-10.0, 20.0, -5.0], [-10.0, 20.0, -8.0]]) * MM,
        np.array([[50.0, 20.0, -5.0], [50.0, 20.0, -8.0]]) * MM,
    )
    result = stock.remove(start, end, tool, bodies)
    # first pass: the shank stays 1 above the top; second: 2 deep, beside the slot of 6
    assert result.body_volume[0] == 0.0
    assert result.body_volume[1] == pytest.approx(2 * 4 * 40 * MM**3, rel=1e-9)
    assert result.body_depth[1] == pytest.approx(2 * MM, abs=0.26 * MM)
    assert stock.volume == pytest.approx((40 * 40 * 20 - 6 * 40 * 6 - 6 * 40 * 2) * MM**3, rel=1e-9)


def test_touch_asks_the_stock_as_it_is_now():
    stock = Stock.box((0, 0, -20 * MM), (40 * MM, 40 * MM, 0), 0.5 * MM)
    holder = shape.cylinder(20 * MM, 10 * MM, 50 * MM)
    at = np.array([[20.0, 20.0, -12.0], [20.0, 20.0, -8.0], [80.0, 20.0, -12.0]]) * MM
    volume, depth = stock.touch(at, at, holder)
    assert volume[0] == pytest.approx(math.pi * 100 * 2 * MM**3, rel=0.02)
    assert depth[0] == pytest.approx(2 * MM)
    assert volume[1:].tolist() == [0.0, 0.0]
    wide = shape.flat(60 * MM, 30 * MM)
    tip = np.array([[20.0, 20.0, -3.0]]) * MM
    stock.remove(tip, tip, wide)
    assert stock.touch(at[:1], at[:1], holder)[0][0] == 0.0


def test_inside():
    stock = Stock.box((0, 0, -20 * MM), (40 * MM, 40 * MM, 0), 0.5 * MM)
    tool = shape.ball(6 * MM, 20 * MM)
    assert stock.inside((20 * MM, 20 * MM, -1 * MM), tool)
    assert not stock.inside((20 * MM, 20 * MM, 0.0), tool)
    assert not stock.inside((44 * MM, 20 * MM, -5 * MM), tool)
    assert stock.inside((41 * MM, 20 * MM, -5 * MM), tool)


def test_tops_follow_what_is_added():
    stock = Stock.box((0, 0, -5 * MM), (40 * MM, 40 * MM, 0), 0.5 * MM)
    holder = shape.cylinder(20 * MM, 0.0, 50 * MM)
    at = np.array([[20.0, 20.0, 1.0]]) * MM
    assert stock.touch(at, at, holder)[0][0] == 0.0
    line = np.array([[10.0, 20.0, 2.0], [30.0, 20.0, 2.0]]) * MM
    stock.add_bead(line[:1], line[1:], 4 * MM, 2 * MM)
    assert stock.touch(at, at, holder)[0][0] > 0.0


def test_a_memento_of_packed_columns_gives_back_the_same_stock_each_time():
    stock = Stock.box((0, 0, -20 * MM), (20 * MM, 20 * MM, 0), 0.5 * MM)
    slots = np.array([[-10, 10, z] for z in (-18.0, -12.0, -6.0)]) * MM
    along = np.array([20 * MM, 0, 0])
    stock.remove(slots, slots + along, shape.flat(6 * MM, 1 * MM))
    before, intervals = stock.volume, [stock.intervals_at(x * MM, 10 * MM) for x in (3, 9, 15)]
    restore = stock.memento()

    for _ in range(2):
        stock.remove(slots, slots + 2.0 * along, shape.flat(6 * MM, 4 * MM))
        assert stock.volume < before
        restore()
        assert stock.volume == before
        assert [stock.intervals_at(x * MM, 10 * MM) for x in (3, 9, 15)] == intervals
