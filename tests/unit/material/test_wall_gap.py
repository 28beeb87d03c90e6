"""How far outside a rim material begins, by the walls that tools have left and the sides of a block."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.compiled import as_python
from gcodesim.material.stock import Stock
from gcodesim.material.wall_gap_kernels import NOTHING, Rim, first_away, gap_outside
from tests.physics.swept_cut import Pass
from tests.physics.test_force_accuracy import D, cut, mill, placed

CELL = D / 24.0
RIM = 0.5 * D
gap_at, away = as_python(gap_outside), as_python(first_away)


def slot(angle: float, end: float, depth: float, stock: Stock | None = None) -> Stock:
    """A block with a slot of a flat mill that comes from behind and ends at `end` [m]."""
    found = Stock.box((-40e-3, -40e-3, -20e-3), (40e-3, 40e-3, 0.0), CELL) if stock is None else stock
    way = Pass(mill("flat_end_mill"), placed([(-20e-3, 0.0, -depth), (end, 0.0, -depth)], angle))
    cut(found, way.cutter, None, way.places)
    return found


def rim_at(angle: float, x: float) -> Rim:
    (place,) = placed([(x, 0.0, 0.0)], angle)
    return Rim(float(place[0]), float(place[1]), RIM, math.cos(angle), math.sin(angle))


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.785, 2.0])
def test_the_front_of_the_tool_itself_has_no_gap(angle: float) -> None:
    field, rim = slot(angle, 0.0, 3e-3).view((0.0, 0.0, 1.0)), rim_at(angle, 0.0)
    for turn in np.linspace(-1.5, 1.5, 41):
        found = gap_at(field, rim, math.cos(angle + turn), math.sin(angle + turn), -1e-3)
        assert found.size < 1e-4 * CELL


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.785, 2.0])
@pytest.mark.parametrize("back", [20e-6, 0.2e-3, 0.5e-3])
def test_a_wall_of_earlier_levels_is_as_far_as_it_is(angle: float, back: float) -> None:
    """A second level whose tool stands a way behind the end of the first one, above the floor of that and below it."""
    stock = slot(angle, -back, 6e-3, slot(angle, 0.0, 3e-3))
    field, rim = stock.view((0.0, 0.0, 1.0)), rim_at(angle, -back)
    for turn in (-0.6, -0.2, 0.0, 0.4, 0.7):
        way = (math.cos(angle + turn), math.sin(angle + turn))
        across = back * math.sin(turn)
        expected = back * math.cos(turn) + math.sqrt(RIM * RIM - across * across) - RIM
        upper = gap_at(field, rim, *way, -1e-3)
        assert upper.size == pytest.approx(expected, abs=0.06 * CELL)
        assert upper.foot == pytest.approx(-3e-3, abs=1e-9)
        assert gap_at(field, rim, *way, -4e-3).size < 1e-4 * CELL


def test_the_side_of_a_block_and_nothing() -> None:
    field = Stock.box((0.0, -40e-3, -20e-3), (40e-3, 40e-3, 0.0), CELL).view((0.0, 0.0, 1.0))
    near, far = Rim(-RIM - 0.3e-3, 0.13e-3, RIM, 1.0, 0.0), Rim(-RIM - 3e-3, 0.13e-3, RIM, 1.0, 0.0)

    assert gap_at(field, near, 1.0, 0.0, -1e-3).size == pytest.approx(0.3e-3, abs=0.02 * CELL)
    assert gap_at(field, far, 1.0, 0.0, -1e-3).size == NOTHING
    assert gap_at(field, near._replace(ux=-1.0), -1.0, 0.0, -1e-3).size == NOTHING


@pytest.mark.parametrize("seed", range(6))
def test_the_quick_look_agrees_with_the_gaps(seed: int) -> None:
    """What it says is at the rim in all directions has no gap in any; the first one that it names may have one."""
    rng = np.random.default_rng(seed)
    angle, back = rng.uniform(0.0, 6.28), rng.choice([0.0, rng.uniform(0.0, 0.4e-3)])
    stock = slot(angle, -back, 6e-3, slot(angle, 0.0, 3e-3))
    field, rim = stock.view((0.0, 0.0, 1.0)), rim_at(angle, -back)
    phi = (np.arange(32) + 0.5) / 32.0 * math.pi
    sines, cosines = np.sin(phi), np.cos(phi)
    for height in (-1e-3, -4e-3):
        lower = np.full(32, height)
        first = away(field, rim, (sines, cosines), (lower, lower))
        turned = angle + 0.5 * math.pi - phi
        gaps = [gap_at(field, rim, math.cos(a), math.sin(a), height).size for a in turned]
        assert max(gaps[:first], default=0.0) < 1e-3 * CELL
        assert first == 32 or back > 0.0
