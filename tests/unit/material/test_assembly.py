"""Stocks that stand in each other: beams and beads do to them what they do to one piece."""

from itertools import pairwise

import numpy as np
import pytest

from gcodesim.frames import Pose
from gcodesim.material.assembly import StockAssembly
from gcodesim.material.beam import PROFILES, BeamForm, BeamWay, strike_assembly, strike_stock
from gcodesim.material.stock import Stock
from gcodesim.units import MM

CELL = 0.25 * MM
FORM = BeamForm(PROFILES["top_hat"], 1.5 * MM, 0.0, 1.0, 0.0, -1.0 * MM, 40.0 * MM)


def whole():
    return Stock.box((-10 * MM, -8 * MM, -6 * MM), (10 * MM, 8 * MM, 0.0), CELL)


def divided(*heights):
    """The same box in slabs between these heights [mm], each in a frame of its own that stands at its underside."""
    slabs = [
        Stock.box((-10 * MM, -8 * MM, 0.0), (10 * MM, 8 * MM, (high - low) * MM), CELL)
        for high, low in pairwise(heights)
    ]
    at = np.array([[0.0, 0.0, low * MM] for low in heights[1:]])
    at -= at[-1]
    return StockAssembly(
        names=tuple(map(str, range(len(slabs)))),
        stocks=tuple(slabs[::-1]),
        materials=(None,) * len(slabs),
        X=tuple(Pose(p, np.eye(3)) for p in at[::-1]),
    )


def turned_slab(*rpy):
    """The box with its upper millimetre as a part that stands turned about the middle of its underside [deg]."""
    lower = Stock.box((-10 * MM, -8 * MM, -6 * MM), (10 * MM, 8 * MM, -1 * MM), CELL)
    X = Pose.from_xyz_rpy((0.0, 0.0, -1 * MM), tuple(np.radians(rpy)))
    low, high = X.inverse().box(np.array([-10 * MM, -8 * MM, -1 * MM]), np.array([10 * MM, 8 * MM, 0.0]))
    upper = Stock.box(tuple(low), tuple(high), CELL)
    return StockAssembly(
        names=("lower", "upper"), stocks=(lower, upper), materials=(None, None), X=(Pose.identity(), X)
    )


def way_of(lean, volume, z=0.0):
    axis = np.array([np.sin(lean), 0.0, np.cos(lean)])
    start, end = np.array([[-5 * MM, 1 * MM, z]]), np.array([[5 * MM, 1.3 * MM, z]])
    return BeamWay(start, end, axis[None], np.array([volume]), np.array([3.0]))


@pytest.mark.parametrize("lean", [0.0, 0.3, -0.5])
@pytest.mark.parametrize("heights", [(0, -1, -6), (0, -0.5, -1, -6)])
def test_slabs_lose_what_one_piece_loses(lean, heights):
    volume = 60.0 * MM**3  # 2 mm deep
    one, way = whole(), way_of(lean, volume)
    struck = strike_stock(one, FORM, way, "wear")
    parts = divided(*heights)
    shifted = way._replace(starts=way.starts - [0, 0, -6 * MM], ends=way.ends - [0, 0, -6 * MM])
    found = strike_assembly(parts, FORM, shifted, np.full((1, len(parts.stocks)), volume), "wear")

    assert struck.taken[0] == pytest.approx(volume, rel=1e-9)
    assert found.taken.sum() == pytest.approx(volume, rel=1e-9)
    assert found.met[0] == pytest.approx(struck.met[0], rel=1e-9)
    assert (found.taken > 0.0).all()
    lost = sum(float(stock.original.hi.max() - stock.original.lo.min()) for stock in parts.stocks)
    assert lost == pytest.approx(6 * MM)
    for x in np.linspace(-6 * MM, 6 * MM, 25):
        (column,) = (sum(high - low for low, high in one.intervals_at(x, 1.1 * MM)),)
        pieces = sum(high - low for stock in parts.stocks for low, high in stock.intervals_at(x, 1.1 * MM))
        assert pieces == pytest.approx(column, abs=1e-9 if lean == 0.0 else 0.6 * MM)


@pytest.mark.parametrize("rpy", [(0, 0, 90), (0, 0, 180), (180, 0, 0), (90, 0, 0), (0, -90, 0)])
@pytest.mark.parametrize("lean", [0.0, 0.3])
def test_a_part_that_stands_turned_by_quarters_loses_what_one_piece_loses(rpy, lean):
    volume = 60.0 * MM**3  # 2 mm deep
    one, parts, way = whole(), turned_slab(*rpy), way_of(lean, volume)
    struck = strike_stock(one, FORM, way, "wear")
    found = strike_assembly(parts, FORM, way, np.full((1, 2), volume), "wear")
    top = sum(
        min(high, 0.0) - max(low, -1 * MM)
        for x in one_columns(-10, 10)
        for y in one_columns(-8, 8)
        for low, high in one.intervals_at(x, y)
        if high > -1 * MM
    )

    assert found.taken.sum() == pytest.approx(volume, rel=1e-9)
    assert found.met[0] == pytest.approx(struck.met[0], rel=1e-9)
    own = 20 * 16 * MM**3 - top * CELL**2
    assert found.taken[0, 1] == pytest.approx(
        own, rel=0.07 if 90 in rpy[:2] or -90 in rpy[:2] else 0.02 if lean else 1e-9
    )


def one_columns(low, high):
    return np.arange(low * MM + 0.5 * CELL, high * MM, CELL)


def test_doses_of_parts_add_up_to_that_of_one_piece():
    volume = 60.0 * MM**3
    one, parts, way = whole(), divided(0, -1, -6), way_of(0.0, volume)
    strike_stock(one, FORM, way, "wear")
    strike_assembly(parts, FORM, way_of(0.0, volume, 6 * MM), np.full((1, 2), volume), "wear")
    assert sum(stock.doses["wear"] for stock in parts.stocks) == pytest.approx(one.doses["wear"], rel=1e-9)


def test_a_bead_lies_on_a_part_and_the_part_is_not_of_the_whole():
    plate = whole()
    block = Stock.box((-3 * MM, -3 * MM, -2 * MM), (3 * MM, 3 * MM, 1 * MM), CELL)
    names, materials = ("plate", "block"), (None, None)
    assembly = StockAssembly(names=names, stocks=(plate, block), materials=materials, X=(Pose.identity(),) * 2)
    before, own = plate.volume, plate.intervals_at(-9 * MM, 5 * MM)
    start, end = np.array([[-8 * MM, 0.0, 2 * MM]]), np.array([[8 * MM, 0.0, 2 * MM]])
    found = assembly.laid(lambda stock: stock.add_bead(start, end, 4 * MM, 2 * MM))

    assert plate.volume - before == pytest.approx(float(found.volume.sum()), rel=1e-6)
    assert plate.intervals_at(0.05 * MM, 0.05 * MM) == [(-6 * MM, 0.0), (pytest.approx(1 * MM), pytest.approx(2 * MM))]
    assert plate.intervals_at(-5 * MM, 0.05 * MM) == [(-6 * MM, pytest.approx(2 * MM))]
    assert plate.intervals_at(-9 * MM, 5 * MM) == own
    assert block.volume == pytest.approx(6 * 6 * 3 * MM**3)


@pytest.mark.parametrize(
    "rpy", [(0, 0, 90), (180, 0, 0), (90, 0, 0), (0, 0, 30), (25, 0, 0), (15, -20, 40), (80, 10, 0)]
)
def test_a_part_that_stands_turned_fills_its_room_in_the_whole(rpy):
    """A ball is the same from all sides; its columns are those along its own axis, so that heights differ by a cell."""
    plate, r = whole(), 4 * MM
    ball = Stock.box((-r, -r, -r), (r, r, r), CELL)
    X = Pose.from_xyz_rpy((1.07 * MM, 0.4 * MM, 2 * MM), tuple(np.radians(rpy)))
    for i in range(ball.field.columns.lo.shape[0]):
        for j in range(ball.field.columns.lo.shape[1]):
            x, y = (-r + (k + 0.5) * CELL for k in (i, j))
            half = np.sqrt(max(r * r - x * x - y * y, 0.0))
            ball.field.columns.lo[i, j, 0], ball.field.columns.hi[i, j, 0] = -half, half
            ball.field.columns.number[i, j] = int(half > 0.0)
    assembly = StockAssembly(
        names=("plate", "ball"), stocks=(plate, ball), materials=(None,) * 2, X=(Pose.identity(), X)
    )

    def look(stock):
        lo, hi, number = stock.field.columns
        inside = np.arange(lo.shape[2]) < number[:, :, None]
        above = np.where(inside, np.maximum(hi, 0.0) - np.maximum(lo, 0.0), 0.0).sum() * CELL * CELL
        return above, stock.intervals_at(1.07 * MM, 0.4 * MM)

    above, middle = assembly.laid(look)
    cap = np.pi * 36.0 * (3 * 4.0 - 6.0) / 3.0  # of a ball of 4 mm, 6 mm high (as much as lies above the plate)
    assert above / MM**3 == pytest.approx(cap, rel=5e-3)
    assert middle == [(pytest.approx(-6 * MM), pytest.approx(6 * MM, abs=CELL))]
    assert plate.volume == pytest.approx(20 * 16 * 6 * MM**3)


def test_what_was_done_can_be_taken_back():
    parts = divided(0, -1, -6)
    back, before = parts.memento(), [stock.volume for stock in parts.stocks]
    strike_assembly(parts, FORM, way_of(0.0, 60 * MM**3, 6 * MM), np.full((1, 2), 60 * MM**3), "wear")
    assert [stock.volume for stock in parts.stocks] != before
    back()
    assert [stock.volume for stock in parts.stocks] == before
