"""Pieces that came loose: what hangs together stays, what does not falls, and crumbs and printed parts stay."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material.loose import drop_loose
from gcodesim.material.shape import flat
from gcodesim.material.stock import Stock

MM = 1e-3


def plate() -> Stock:
    return Stock.box((0.0, 0.0, -5 * MM), (60 * MM, 40 * MM, 0.0), 0.5 * MM)


def frame_cut(stock: Stock, gap: float = 0.0, depth: float = 6.0, z_step: float = 6.0) -> None:
    """A 3 mm cutter goes round a square of 20 mm, all but a `gap` [mm] in its last side."""
    corners = np.array([[20, 10], [40, 10], [40, 30], [20, 30], [20, 10 + gap]]) * MM
    points = np.column_stack([corners, np.full(5, -depth * MM)])
    stock.remove(points[:-1], points[1:], flat(3 * MM, 20 * MM))


def test_a_square_that_is_cut_round_falls() -> None:
    stock = plate()
    frame_cut(stock)
    before = stock.volume
    (piece,) = drop_loose(stock)

    assert piece.volume == pytest.approx(17 * 17 * 5 * MM**3, rel=0.03)
    assert before - stock.volume == pytest.approx(piece.volume, rel=0.03)
    assert np.allclose(piece.low, [21.5 * MM, 11.5 * MM, -5 * MM], atol=0.5 * MM)
    assert np.allclose(piece.high, [38.5 * MM, 28.5 * MM, 0.0], atol=0.5 * MM)
    assert stock.intervals_at(30 * MM, 20 * MM) == []
    assert len(stock.intervals_at(5 * MM, 5 * MM)) == 1
    assert drop_loose(stock) == []


@pytest.mark.parametrize(("gap", "depth"), [(5.0, 6.0), (0.0, 4.8)])
def test_a_tab_and_a_skin_hold(gap: float, depth: float) -> None:
    stock = plate()
    frame_cut(stock, gap, depth)
    before = stock.volume

    assert drop_loose(stock) == []
    assert stock.volume == before


def test_a_lid_that_is_undercut_falls() -> None:
    """A slot below the surface from side to side parts the top, which is the smaller piece."""
    stock = plate()
    stock.grow()
    lo, hi, number = stock.field.columns
    hi[:, :, 0], lo[:, :, 1], hi[:, :, 1], number[:] = -2 * MM, -1 * MM, 0.0, 2
    (piece,) = drop_loose(stock)

    assert piece.volume == pytest.approx(60 * 40 * 1 * MM**3)
    assert stock.volume == pytest.approx(60 * 40 * 3 * MM**3)


def test_crumbs_stay() -> None:
    """What is less than sixteen columns says more of the grid than of the part."""
    stock = plate()
    _, hi, number = stock.field.columns
    number[40:80, 20:60] = 0
    hi[40:80, 20:60, 0] = -5 * MM
    number[60:63, 40:44] = 1
    hi[60:63, 40:44, 0] = 0.0

    assert drop_loose(stock) == []
    number[60:64, 40:44] = 1
    hi[60:64, 40:44, 0] = 0.0
    assert len(drop_loose(stock)) == 1


def test_a_stock_that_was_in_pieces_keeps_them() -> None:
    stock = plate()
    frame_cut(stock)
    field = stock.field
    apart = Stock(columns=field.columns, grid=field.grid, z_range=stock.z_range, resolution=stock.resolution)
    apart.remove(np.array([[5 * MM, 5 * MM, -6 * MM]]), np.array([[6 * MM, 5 * MM, -6 * MM]]), flat(3 * MM, 20 * MM))

    assert drop_loose(apart) == []
