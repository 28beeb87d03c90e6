"""Beads: intervals that unite, cross-sections, corners."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material import Stock
from gcodesim.material.bead_kernels import bead_thickness, unite
from gcodesim.material.field_kernels import Columns
from tests.tops import top_at

MM = 1e-3


def column(*intervals, room=4):
    lo, hi = np.zeros((1, 1, room)), np.zeros((1, 1, room))
    for k, (low, high) in enumerate(intervals):
        lo[0, 0, k], hi[0, 0, k] = low, high
    return Columns(lo, hi, np.full((1, 1), len(intervals), dtype=np.int32))


@pytest.mark.parametrize(
    ("held", "new", "expected", "added"),
    [
        ([], (1, 2), [(1, 2)], 1),
        ([(0, 1)], (1, 2), [(0, 2)], 1),
        ([(0, 1)], (1.5, 2), [(0, 1), (1.5, 2)], 0.5),
        ([(3, 4)], (1, 2), [(1, 2), (3, 4)], 1),
        ([(0, 1), (2, 3)], (0.5, 2.5), [(0, 3)], 1),
        ([(0, 1), (2, 3), (5, 6)], (1, 2), [(0, 3), (5, 6)], 1),
        ([(0, 4)], (1, 2), [(0, 4)], 0),
        ([(0, 1), (2, 3), (4, 5)], (-1, 9), [(-1, 9)], 7),
    ],
)
def test_unite(held, new, expected, added):
    columns = column(*held)
    lo, hi, count = columns
    assert unite(columns, 0, 0, *map(float, new), 1e-9) == pytest.approx(added)
    n = count[0, 0]
    assert list(zip(lo[0, 0, :n], hi[0, 0, :n], strict=True)) == expected


def test_unite_says_when_there_is_no_room_and_changes_nothing():
    columns = column((0, 1), (2, 3), room=2)
    assert unite(columns, 0, 0, 5.0, 6.0, 1e-9) == -1.0
    assert columns.number[0, 0] == 2 and columns.hi[0, 0].tolist() == [1, 3]


@pytest.mark.parametrize("cell", [0.1, 0.7, 2.0])
@pytest.mark.parametrize("phase", [0.0, 0.3, 0.5])
def test_thickness_over_the_cells_adds_up_to_the_area(cell, phase):
    centres = (np.arange(-60, 61) + phase) * cell * MM
    area = sum(bead_thickness(c, cell * MM, 5 * MM, 2 * MM) for c in centres) * cell * MM
    assert area == pytest.approx((3 * 2 + math.pi) * MM**2, rel=1e-9)


def test_a_wall_of_layers_is_one_solid():
    stock = Stock.empty((0, 0, 0), (60 * MM, 20 * MM, 30 * MM), 0.5 * MM)
    line = np.array([[5.0, 10.0, 0.0], [55.0, 10.0, 0.0]]) * MM
    for layer in range(1, 9):
        line[:, 2] = 2.5 * MM * layer + 3e-16
        stock.add_bead(line[:1], line[1:], 6 * MM, 2.5 * MM)
    assert stock.field.columns.number[60, 20] == 1
    assert top_at(stock, 30 * MM, 10 * MM) == pytest.approx(20 * MM, abs=1e-9)


@pytest.mark.parametrize("pieces", [1, 375])
@pytest.mark.parametrize("depth", [1e-3, 0.02, 0.2])
def test_a_bead_that_reaches_into_the_bed_loses_what_is_there_already(depth, pieces):
    """The bed takes a strip of the straight part and the segments of both half rounds; columns had no room for more."""
    stock = Stock.box((0, 0, 0), (60 * MM, 20 * MM, 5 * MM), 0.1 * MM)
    x = np.linspace(5.0, 35.0, pieces + 1)
    line = np.column_stack([x, np.full(len(x), 10.0), np.full(len(x), 8.0 - depth)]) * MM
    laid = stock.add_bead(line[:-1], line[1:], 6 * MM, 3 * MM)
    r = 1.5
    segments = r * r * math.acos(1.0 - depth / r) - (r - depth) * math.sqrt(2.0 * r * depth - depth * depth)
    lost = 30.0 * (3.0 * depth + segments)
    assert (laid.nominal.sum() - laid.volume.sum()) / MM**3 == pytest.approx(lost, rel=0.12, abs=0.05)


def test_a_nozzle_that_trembles_before_it_goes_lays_no_round_corner():
    """Half a disc of 42 mm³ was laid where a piece of a nanometre had gone the other way."""
    stock = Stock.empty((0, 0, 0), (60 * MM, 20 * MM, 10 * MM), 0.2 * MM)
    ends = np.array([[20.0, 10.0, 3.0], [20.0 - 1e-6, 10.0, 3.0], [40.0, 10.0, 3.0]]) * MM
    laid = stock.add_bead(ends[:-1], ends[1:], 6 * MM, 3 * MM)
    assert laid.volume.sum() == pytest.approx(laid.nominal.sum(), rel=1e-3)


@pytest.mark.parametrize("tail", [0.5e-3, 1e-6])
def test_a_corner_behind_a_short_last_piece_is_filled(tail):
    """Slowing down to a stop ends in pieces of any size."""
    corner = [(20.0, 20.0, 3.0), (40.0, 20.0, 3.0), (40.0, 40.0, 3.0)]
    with_tail = [corner[0], (40.0 - tail, 20.0, 3.0), *corner[1:]]
    volumes = []
    for places in (corner, with_tail):
        stock, ends = Stock.empty((0, 0, 0), (60 * MM, 60 * MM, 10 * MM), 0.2 * MM), np.array(places) * MM
        volumes.append(stock.add_bead(ends[:-1], ends[1:], 6 * MM, 3 * MM).volume.sum())
    assert volumes[1] == pytest.approx(volumes[0], rel=1e-3)


def test_neighbouring_beads_share_the_room_of_their_layer():
    """Rows one width apart: what the grid cannot separate is not lost."""
    stock = Stock.empty((0, 0, 0), (60 * MM, 60 * MM, 10 * MM), 1 * MM)
    added = nominal = 0.0
    for row in range(6):
        line = np.array([[5.0, 10.3 + 5 * row, 2.0], [55.0, 10.3 + 5 * row, 2.0]]) * MM
        laid = stock.add_bead(line[:1], line[1:], 5 * MM, 2 * MM)
        added, nominal = added + laid.volume.sum(), nominal + laid.nominal.sum()
    assert added == pytest.approx(nominal, rel=1e-3)


def test_outside_of_a_corner_holds_what_its_inside_lacks():
    """Two strands overlap on the inside of a corner, laid once; the mitre outside is as large: area times length."""
    stock = Stock.empty((0, 0, 0), (60 * MM, 60 * MM, 4 * MM), 0.1 * MM)
    path = np.array([[10.0, 10.0, 2.0], [40.0, 10.0, 2.0], [40.0, 40.0, 2.0]]) * MM
    laid = stock.add_bead(path[:-1], path[1:], 6 * MM, 2 * MM)
    assert top_at(stock, 41.5 * MM, 8.5 * MM) == pytest.approx(2 * MM, abs=0.02 * MM)
    assert top_at(stock, 42.9 * MM, 7.1 * MM) > 1.0 * MM
    assert top_at(stock, 43.2 * MM, 7.1 * MM) == -np.inf
    area = (4.0 * 2.0 + np.pi) * MM**2
    assert laid.volume.sum() == pytest.approx(area * 60 * MM, rel=1e-3)


def test_a_bead_that_is_higher_than_wide_is_refused():
    stock = Stock.empty((0, 0, 0), (60 * MM, 60 * MM, 4 * MM), 1 * MM)
    line = np.zeros((1, 3))
    with pytest.raises(ValueError, match="bead"):
        stock.add_bead(line, line, 1 * MM, 2 * MM)


def test_standing_still_lays_nothing():
    stock = Stock.empty((0, 0, 0), (60 * MM, 60 * MM, 4 * MM), 1 * MM)
    point = np.array([[30.0, 30.0, 2.0]]) * MM
    laid = stock.add_bead(point, point, 4 * MM, 2 * MM)
    assert laid.volume.sum() == 0.0 and laid.nominal.sum() == 0.0
