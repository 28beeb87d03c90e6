"""Pieces that a cut parts: what hangs together stays, what does not falls, and crumbs and old pieces stay."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gcodesim.material.axis_way import AxisWay
from gcodesim.material.loose import PartedPiece, Parting
from gcodesim.material.loose_kernels import BodyWays
from gcodesim.material.shape import flat
from gcodesim.material.solid_of_revolution import slabs_of_outline
from gcodesim.material.stock import Stock

MM = 1e-3


def plate() -> Stock:
    return Stock.box((0.0, 0.0, -5 * MM), (60 * MM, 40 * MM, 0.0), 0.5 * MM)


def parted_by(stock: Stock, cut: Callable[[Stock], None], reach: float = 100.0) -> list[PartedPiece]:
    """What comes loose in a cut that stays within `reach` [mm] of the middle."""
    parting = Parting(stock)
    middle, beside = np.array([[30.0, 20.0, 0.0]]) * MM, np.full((1, 2), reach * MM)
    kept = parting.keep(BodyWays(middle, middle, -beside, beside))
    cut(stock)
    parted = parting.parted(kept)
    return [] if parted is None else parting.take_out(parted)


def frame_cut(stock: Stock, gap: float = 0.0, depth: float = 6.0) -> None:
    """A 3 mm cutter goes round a square of 20 mm, all but a `gap` [mm] in its last side."""
    corners = np.array([[20, 10], [40, 10], [40, 30], [20, 30], [20, 10 + gap]]) * MM
    points = np.column_stack([corners, np.full(5, -depth * MM)])
    stock.remove(points[:-1], points[1:], flat(3 * MM, 20 * MM))


@pytest.mark.parametrize("reach", [100.0, 14.0])
def test_a_square_that_is_cut_round_falls(reach: float) -> None:
    stock = plate()
    before = {}

    def cut(stock: Stock) -> None:
        frame_cut(stock)
        before["volume"] = stock.volume

    (piece,) = parted_by(stock, cut, reach)

    assert piece.volume == pytest.approx(17 * 17 * 5 * MM**3, rel=0.03)
    assert before["volume"] - stock.volume == pytest.approx(piece.volume, rel=1e-12)
    assert np.allclose(piece.low, [21.5 * MM, 11.5 * MM, -5 * MM], atol=0.5 * MM)
    assert np.allclose(piece.high, [38.5 * MM, 28.5 * MM, 0.0], atol=0.5 * MM)
    assert stock.intervals_at(30 * MM, 20 * MM) == []
    assert len(stock.intervals_at(5 * MM, 5 * MM)) == 1


@pytest.mark.parametrize(("gap", "depth"), [(5.0, 6.0), (0.0, 4.8)])
def test_a_tab_and_a_skin_hold(gap: float, depth: float) -> None:
    assert parted_by(plate(), lambda stock: frame_cut(stock, gap, depth)) == []


def test_a_lid_that_is_undercut_falls() -> None:
    """A slot below the surface from side to side parts the top, which is the smaller piece."""

    def cut(stock: Stock) -> None:
        stock.grow()
        lo, hi, number = stock.field.columns
        hi[:, :, 0], lo[:, :, 1], hi[:, :, 1], number[:] = -2 * MM, -1 * MM, 0.0, 2

    stock = plate()
    (piece,) = parted_by(stock, cut)

    assert piece.volume == pytest.approx(60 * 40 * 1 * MM**3)
    assert stock.volume == pytest.approx(60 * 40 * 3 * MM**3)


@pytest.mark.parametrize(("wide", "fall"), [(3, 0), (4, 1)])
def test_crumbs_stay(wide: int, fall: int) -> None:
    """What is less than sixteen columns says more of the grid than of the part."""

    def cut(stock: Stock) -> None:
        _, hi, number = stock.field.columns
        ring = np.ones((40, 40), dtype=bool)
        ring[20 : 20 + wide, 20:24] = False
        number[40:80, 20:60][ring] = 0
        hi[40:80, 20:60, 0][ring] = -5 * MM

    assert len(parted_by(plate(), cut)) == fall


def test_a_stock_that_was_in_pieces_keeps_them() -> None:
    stock = plate()
    frame_cut(stock)
    row = np.array([[5 * MM, 5 * MM, -6 * MM], [6 * MM, 5 * MM, -6 * MM]])

    assert parted_by(stock, lambda stock: stock.remove(row[:1], row[1:], flat(3 * MM, 20 * MM)) and None) == []


def test_what_is_put_back_is_as_it_was() -> None:
    """Columns, walls and what a later cut finds; also where the cut needed room for more intervals."""
    stock, other = plate(), plate()
    for each in (stock, other):
        frame_cut(each, depth=2.0)
    parting = Parting(stock)
    middle, beside = np.array([[30.0, 20.0, 0.0]]) * MM, np.full((1, 2), 12 * MM)
    kept = parting.keep(BodyWays(middle, middle, -beside, beside))
    frame_cut(stock)
    stock.grow()
    parting.put_back(kept)

    assert stock.volume == other.volume
    assert np.array_equal(stock.field.walls, other.field.walls)
    assert np.array_equal(stock.field.tops, other.field.tops)
    frame_cut(stock)
    frame_cut(other)
    assert stock.volume == other.volume


def test_a_piece_goes_out_of_the_columns_of_all_directions() -> None:
    """A slitting saw on a level axis cuts a corner off; what is left has the volume of the rest."""
    stock = plate()
    slabs = slabs_of_outline(((10 * MM, 0.0), (10 * MM, 1 * MM)), stock.cell)
    x = np.array([[12.0, -15.0, -10.0], [12.0, 55.0, -10.0]]) * MM
    along = np.array([[1.0, 0.0, 0.0]])
    before = {}

    def cut(stock: Stock) -> None:
        stock.sweep(AxisWay(starts=x[:1], ends=x[1:], axes_start=along, axes_end=along), slabs)
        before["volume"] = stock.volume

    (piece,) = parted_by(stock, cut)

    assert piece.volume == pytest.approx(12 * 40 * 5 * MM**3, rel=0.01)
    assert before["volume"] - piece.volume == pytest.approx(47 * 40 * 5 * MM**3, rel=0.01)
    assert stock.volume == pytest.approx(47 * 40 * 5 * MM**3, rel=0.01)
    surface = stock.surface()
    assert surface.vertices[:, 0].min() == pytest.approx(13 * MM, abs=0.3 * MM)


def test_what_cannot_part_is_told_beforehand() -> None:
    parting = Parting(plate())

    assert not parting.may_part(-4.9 * MM, from_above=True)
    assert parting.may_part(-5 * MM, from_above=True)
    assert parting.may_part(-1 * MM, from_above=False)
    assert parting.may_part(-1 * MM, from_above=True)  # below an undercut anything may hang on a thread
