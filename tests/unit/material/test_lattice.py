"""A stock with columns along x, y and z."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.material.axis_way import AxisWay
from gcodesim.material.lattice import ensure_lattice
from gcodesim.material.loops import loop_table
from gcodesim.material.solid_of_revolution import slabs_of_outline, slabs_of_shape
from gcodesim.material.stock_file import StockFileError, load_stock, stock_from_bytes
from gcodesim.units import MM, MM3
from tests.axis_ways import straight

LEAN = np.array([0.0, 0.6, 0.8])


def block(cell=1.0):
    return Stock.box((0, 0, -10 * MM), (20 * MM, 16 * MM, 0), cell * MM)


def slot(y=8.0, x=(-10.0, 30.0), z=-3.0, axis=LEAN):
    start, end = (np.array([at, y, z]) * MM for at in x)
    return straight(start, end, axis, axis)


def mill(stock, diameter=4.0):
    return slabs_of_shape(shape.flat(diameter * MM, 30 * MM), stock.cell)


def test_what_is_removed_is_what_the_volume_falls_by():
    stock = block()
    removed = sum(stock.sweep(slot(y), mill(stock)).sum() for y in (5.0, 8.0, 11.0))
    assert stock.volume == pytest.approx(20 * 16 * 10 * MM3 - removed, rel=1e-12)
    assert stock.sweep(slot(8.0), mill(stock)).sum() == pytest.approx(0.0, abs=1e-6 * MM3)


def test_a_way_in_many_pieces_removes_the_same():
    once, often = block(), block()
    whole = once.sweep(slot(), mill(once)).sum()
    points = np.linspace(-10, 30, 38)[:, None] * [MM, 0, 0] + [0, 8 * MM, -3 * MM]
    axes = np.tile(LEAN, (37, 1))
    parts = often.sweep(AxisWay(points[:-1], points[1:], axes, axes), mill(often))
    assert parts.sum() == pytest.approx(whole, rel=1e-9)
    assert (parts >= 0.0).all() and parts[0] == 0.0 and parts[18] > 0.0


def test_an_upright_cut_changes_all_columns():
    """The kernels of upright tools cut along Z; the columns across follow."""
    one, other = block(0.5), block(0.5)
    ensure_lattice(one)
    tip = np.array([[-5.0, 8.0, -4.0], [14.0, 8.0, -4.0]]) * MM
    tool = shape.ball(6 * MM, 20 * MM)
    one.remove(tip[:1], tip[1:], tool)
    removed = other.sweep(AxisWay(tip[:1], tip[1:], *np.tile([0.0, 0.0, 1.0], (2, 1, 1))), slabs_of_shape(tool, 5e-4))
    assert one.volume == pytest.approx(other.volume, rel=1e-9)
    assert one.volume == pytest.approx(20 * 16 * 10 * MM3 - removed.sum(), rel=1e-9)


def test_columns_across_are_made_of_what_was_cut_before():
    """An upright slot first, then a leaning tool that cuts elsewhere: the slot stays where it is."""
    stock = block(0.5)
    tip = np.array([[-5.0, 3.3, -4.0], [25.0, 3.3, -4.0]]) * MM
    stock.remove(tip[:1], tip[1:], shape.flat(3 * MM, 20 * MM))
    before = stock.volume
    removed = stock.sweep(slot(12.0), mill(stock)).sum()
    assert stock.volume == pytest.approx(before - removed, rel=1e-12)
    surface = stock.surface(0.0)
    x, y, z = surface.vertices.T
    side = y[(np.abs(x - 10 * MM) < 9.5 * MM) & (np.abs(y - 3.3 * MM) < 2 * MM) & (z > -3.5 * MM) & (z < -1e-6)]
    assert len(side)
    assert np.abs(np.abs(side - 3.3 * MM) - 1.5 * MM).max() < 0.01 * MM


def test_a_memento_restores_all_columns():
    stock = block()
    stock.sweep(slot(), mill(stock))
    volume, back = stock.volume, stock.memento()
    stock.sweep(slot(4.0), mill(stock))
    assert stock.volume < volume
    back()
    assert stock.volume == volume


def test_the_file_keeps_all_columns(tmp_path):
    stock = block()
    stock.sweep(slot(), mill(stock))
    stock.save(tmp_path / "a.stock")
    again = load_stock(tmp_path / "a.stock")
    again.save(tmp_path / "b.stock")
    assert again.volume == stock.volume
    assert (tmp_path / "a.stock").read_bytes() == (tmp_path / "b.stock").read_bytes()
    assert np.array_equal(again.surface().vertices, stock.surface().vertices)
    raw = (tmp_path / "a.stock").read_bytes()
    with pytest.raises(StockFileError):
        stock_from_bytes(raw[:-20], "a.stock")


def test_a_cut_through_leaves_two_pieces():
    stock = block()
    assert stock.piece_volumes() == pytest.approx([20 * 16 * 10 * MM3], rel=1e-2)
    stock.sweep(slot(8.0, z=-14.0), mill(stock, 3.0))
    pieces = stock.piece_volumes()
    assert len(pieces) == 2
    assert pieces.sum() == pytest.approx(stock.volume, rel=1e-2)


def test_loops_use_each_crossed_edge_once():
    table = loop_table()
    for corners in range(256):
        full = [corners >> c & 1 for c in range(8)]
        pairs = [(a, a | d) for a in range(8) for d in (1, 2, 4) if not a & d]
        crossed = sum(full[a] != full[b] for a, b in pairs)
        used = [e for loop in table[corners] for e in loop[2 : 2 + loop[0]]]
        assert len(used) == len(set(used)) == crossed


def test_an_outline_that_comes_back_down_is_refused():
    with pytest.raises(ValueError, match="comes back down"):
        slabs_of_outline([(0.0, 1.0), (1.0, 0.0), (1.0, 5.0), (0.0, 5.0)], 0.1)
