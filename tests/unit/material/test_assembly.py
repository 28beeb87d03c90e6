"""Stocks that stand in each other: beams and beads do to them what they do to one piece."""

from itertools import pairwise

import numpy as np
import pytest

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
        at=at[::-1],
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
    assembly = StockAssembly(names=names, stocks=(plate, block), materials=materials, at=np.zeros((2, 3)))
    before, own = plate.volume, plate.intervals_at(-9 * MM, 5 * MM)
    start, end = np.array([[-8 * MM, 0.0, 2 * MM]]), np.array([[8 * MM, 0.0, 2 * MM]])
    found = assembly.laid(lambda stock: stock.add_bead(start, end, 4 * MM, 2 * MM))

    assert plate.volume - before == pytest.approx(float(found.volume.sum()), rel=1e-6)
    assert plate.intervals_at(0.05 * MM, 0.05 * MM) == [(-6 * MM, 0.0), (pytest.approx(1 * MM), pytest.approx(2 * MM))]
    assert plate.intervals_at(-5 * MM, 0.05 * MM) == [(-6 * MM, pytest.approx(2 * MM))]
    assert plate.intervals_at(-9 * MM, 5 * MM) == own
    assert block.volume == pytest.approx(6 * 6 * 3 * MM**3)


def test_what_was_done_can_be_taken_back():
    parts = divided(0, -1, -6)
    back, before = parts.memento(), [stock.volume for stock in parts.stocks]
    strike_assembly(parts, FORM, way_of(0.0, 60 * MM**3, 6 * MM), np.full((1, 2), 60 * MM**3), "wear")
    assert [stock.volume for stock in parts.stocks] != before
    back()
    assert [stock.volume for stock in parts.stocks] == before
