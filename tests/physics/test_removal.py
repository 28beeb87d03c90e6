"""Removed volume against closed forms: slots, grooves, arcs, bores, at several grids and offsets."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.material.axis_way import AxisWay
from gcodesim.material.solid_of_revolution import slabs_of_shape
from tests.tops import top_at

MM = 1e-3
MM3 = 1e-9


def plate(resolution_mm):
    """The block of the program cases: 80 x 50 x 15 mm, zero at the front left of its top."""
    return Stock.box((0, 0, -15 * MM), (80 * MM, 50 * MM, 0), resolution_mm * MM)


def cut(stock, points_mm, tool):
    points = np.asarray(points_mm, dtype=float) * MM
    return stock.remove(points[:-1], points[1:], tool).volume.sum() / MM3


def arc_points(center, radius, first, last, z, chords):
    angle = np.linspace(first, last, chords + 1)
    return np.c_[center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle), np.full(chords + 1, z)]


def test_through_slot_aligned_with_the_columns_is_exact():
    """V-PRG-01: both walls run through column centres; one owns its column, the other does not."""
    removed = cut(plate(0.4), [[-15, 25, -3], [95, 25, -3]], shape.flat(8 * MM, 30 * MM))
    assert removed == pytest.approx(1920.0, rel=1e-12)


@pytest.mark.parametrize("y", [25.0, 25.07, 25.1, 25.13])
@pytest.mark.parametrize("diameter", [7.3, 8.0, 12.0])
def test_through_slot_beside_the_grid(y, diameter):
    """V-PRG-01 at diameter / 20: walls that stand inside cells count where they stand."""
    removed = cut(plate(diameter / 20), [[-15, y, -3], [95, y, -3]], shape.flat(diameter * MM, 30 * MM))
    assert removed == pytest.approx(240.0 * diameter, rel=1e-5)


def test_half_circle_groove():
    """V-PRG-02: the lower half circle, 60 / 2 pi long, with two half-round ends."""
    exact = 810.530904626
    errors = []
    for resolution in (0.3, 0.1, 0.05):
        groove = arc_points((40, 25), 20, math.pi, 2 * math.pi, -2, 400)
        removed = cut(plate(resolution), groove, shape.flat(6 * MM, 30 * MM))
        assert removed == pytest.approx(exact, rel=1e-3)
        errors.append(abs(removed - exact))
    assert errors[2] < errors[0]


@pytest.mark.parametrize("resolution", [0.5, 0.25])
@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 77.3])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.11, 0.07)])
def test_turned_slot_stays_within_the_error_bound(resolution, angle, offset):
    """A slot 6 wide, 2 deep, 30 between centres, with round ends, at any angle."""
    exact = 2.0 * (6.0 * 30.0 + math.pi * 9.0)
    x, y = 40.0 + offset[0], 25.0 + offset[1]
    dx, dy = 15.0 * math.cos(math.radians(angle)), 15.0 * math.sin(math.radians(angle))
    stock = plate(resolution)
    removed = cut(stock, [[x - dx, y - dy, -2], [x + dx, y + dy, -2]], shape.flat(6 * MM, 30 * MM))
    bound = stock.error_bound() / MM3
    assert abs(removed - exact) <= bound
    assert bound < 0.5 * resolution * 2.0 * (2 * 30.0 + math.pi * 6.0) * 1.5
    assert removed == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("diameter", [6.0, 10.0])
@pytest.mark.parametrize("depth", [1.0, 3.0, 7.0])
def test_ball_groove(diameter, depth):
    """A straight groove of a ball end mill across the block: a circle's segment, above it straight walls."""
    r = diameter / 2
    h = min(depth, r)
    segment = r * r * math.acos((r - h) / r) - (r - h) * math.sqrt(2 * r * h - h * h)
    exact = 80.0 * (segment + diameter * max(depth - r, 0.0))
    errors, bounds = [], []
    for resolution in (0.4, 0.2, 0.1):
        stock = plate(resolution)
        removed = cut(stock, [[-9, 21.03, -depth], [89, 21.03, -depth]], shape.ball(diameter * MM, 30 * MM))
        errors.append(abs(removed - exact))
        bounds.append(stock.error_bound() / MM3)
        assert errors[-1] <= bounds[-1]
    assert errors[-1] < 0.01 * exact
    assert bounds[1] < 0.6 * bounds[0] and bounds[2] < 0.36 * bounds[0]


def test_sphere_dimple():
    """A ball plunged by less than its radius leaves a cap."""
    exact = math.pi * 2.0**2 * (3 * 5.0 - 2.0) / 3
    stock = plate(0.1)
    removed = cut(stock, [[40, 25, 5], [40, 25, -2]], shape.ball(10 * MM, 30 * MM))
    assert removed == pytest.approx(exact, rel=2e-3)
    assert abs(removed - exact) <= stock.error_bound() / MM3


def test_drilled_hole_has_a_cone_at_its_end():
    point = 4.0 / math.tan(math.radians(59))
    exact = math.pi * 16.0 * (10.0 - point) + math.pi * 16.0 * point / 3
    stock = plate(0.1)
    removed = cut(stock, [[40, 25, 5], [40, 25, -10]], shape.cone(8 * MM, math.radians(118), 40 * MM))
    assert removed == pytest.approx(exact, rel=5e-3)
    assert abs(removed - exact) <= stock.error_bound() / MM3


@pytest.mark.parametrize("steps", [1, 7, 400])
@pytest.mark.parametrize("diameter", [3.3, 6.8, 10.2])
def test_blind_hole_in_small_steps_and_out_again(diameter, steps):
    """Walls count down to the deepest place of the cylinder, however many steps go down and up beside them."""
    r, z = diameter / 2, diameter * 1.5
    point = r / math.tan(math.radians(59))
    exact = math.pi * r**2 * (z - point) + math.pi * r**2 * point / 3
    heights = np.r_[np.linspace(5, -z, steps + 1), np.linspace(-z, 5, steps + 1)[1:]]
    points = np.column_stack([np.full(len(heights), 40.0), np.full(len(heights), 25.0), heights])
    stock = plate(diameter / 20)
    removed = cut(stock, points, shape.cone(diameter * MM, math.radians(118), 40 * MM))
    assert removed == pytest.approx(exact, rel=1e-3)
    assert stock.volume / MM3 == pytest.approx(60_000.0 - removed, rel=1e-9)


def test_bull_nose_plunge_leaves_its_torus():
    """Depth equal to the corner radius: a disc and half a torus tube around it (Pappus)."""
    flat, corner = 3.0, 2.0
    exact = math.pi * flat**2 * corner + math.pi**2 / 2 * flat * corner**2 + 2 / 3 * math.pi * corner**3
    stock = plate(0.1)
    removed = cut(stock, [[40, 25, 5], [40, 25, -corner]], shape.bull_nose(10 * MM, corner * MM, 30 * MM))
    assert removed == pytest.approx(exact, rel=3e-3)


def test_bull_nose_groove_across():
    flat, corner = 3.0, 2.0
    exact = 80.0 * (2 * flat * corner + math.pi / 2 * corner**2)
    stock = plate(0.2)
    removed = cut(stock, [[-20, 25, -corner], [100, 25, -corner]], shape.bull_nose(10 * MM, corner * MM, 30 * MM))
    assert removed == pytest.approx(exact, rel=5e-3)


def test_ramping_flat_cutter_leaves_a_wedge():
    """Down a ramp across a whole side: the floor under the tool's trailing edge is the ramp moved back by a radius."""
    stock = Stock.box((0, 0, -10 * MM), (40 * MM, 4 * MM, 0), 0.1 * MM)
    removed = cut(stock, [[0, 2, 0], [40, 2, -4]], shape.flat(40 * MM, 30 * MM))
    # over (x, y) the lowest tip is the last that still covers it, at x + sqrt(20^2 - (y - 2)^2), at most 40
    y = (np.arange(4000) + 0.5) / 1000.0 - 2.0
    half = np.sqrt(400.0 - y**2)
    exact = np.mean(0.1 * ((40 - half) ** 2 / 2 + (40 - half) * half) + 4.0 * half) * 4.0
    assert removed == pytest.approx(exact, rel=1e-3)


def test_walls_of_short_steps_are_those_of_one_cut():
    """The strips beside the borders move with the tool: the front's are given back, the sides' stay."""
    points = np.array([[21.3, 20.2, -2]]) + np.linspace(0, 1, 211)[:, None] * np.array([[30.0, 9.0, 0.0]])
    tool = shape.flat(6 * MM, 30 * MM)
    at_once, in_steps = plate(0.3), plate(0.3)
    whole = cut(at_once, points[[0, -1]], tool)
    volumes = in_steps.remove(points[:-1] * MM, points[1:] * MM, tool).volume / MM3
    assert volumes.sum() == pytest.approx(whole, rel=1e-5)
    # and the rate of removal is steady, not in jumps of whole cells
    steady = volumes[20:-1]
    assert steady == pytest.approx(np.full(len(steady), 2.0 * 6.0 * math.hypot(30, 9) / 210), rel=0.1)
    assert steady.mean() == pytest.approx(2.0 * 6.0 * math.hypot(30, 9) / 210, rel=1e-3)


def beside_columns(stock):
    """Volume [mm3] that stands beside columns, at their walls."""
    return (stock.volume - stock.relief().lengths.sum() * stock.spacing.prod()) / MM3


def test_a_wall_that_is_cut_away_takes_its_strip_along():
    stock = plate(0.4)
    tool = shape.flat(7.3 * MM, 30 * MM)
    cut(stock, [[-15, 25.1, -3], [95, 25.1, -3]], tool)
    assert beside_columns(stock) != pytest.approx(0.0, abs=1.0)
    removed = cut(stock, [[40, 25, 5], [40, 25, -3]], shape.flat(200 * MM, 30 * MM))
    assert beside_columns(stock) == pytest.approx(0.0, abs=1e-6)
    assert removed == pytest.approx(80 * 50 * 3 - 240 * 7.3, rel=1e-4)
    assert stock.volume == pytest.approx(80 * 50 * 12 * MM3, rel=1e-12)


def test_removed_is_before_minus_after_also_when_pieces_cross():
    stock = plate(0.4)
    before = stock.volume
    rng = np.random.default_rng(7)
    points = rng.uniform((-5, -5, -14), (85, 55, 1), (60, 3))
    removed = sum(cut(stock, points, tool) for tool in (shape.ball(6 * MM, 9 * MM), shape.flat(5 * MM, 4 * MM)))
    assert removed == pytest.approx((before - stock.volume) / MM3, rel=1e-12)
    relief = stock.relief()
    assert (relief.lengths < relief.tops - stock.z_range[0] - 1e-9).any()  # short tools left overhangs


def test_a_short_tool_leaves_the_roof_standing():
    """An overhang: the tool runs in from the side, 3 high under a roof of 5."""
    stock = plate(0.5)
    removed = cut(stock, [[-10, 25, -8], [40, 25, -8]], shape.flat(10 * MM, 3 * MM))
    assert removed == pytest.approx(3.0 * (10.0 * 40.0 + math.pi / 2 * 25.0), rel=0.01)
    assert top_at(stock, 20 * MM, 25.1 * MM) == 0.0


def test_pocket_of_overlapping_rows():
    """Rows of a flat cutter at half its width: a rectangle with round corners, whatever the order of rows."""
    exact = 3.0 * (36.0 * 20.0 - (4 - math.pi) * 9.0)
    rows = [[[23, y, -3], [53, y, -3]] for y in np.linspace(18, 32, 7)]
    sides = [[[23, 18, -3], [23, 32, -3]], [[53, 18, -3], [53, 32, -3]]]
    removed, bounds = [], []
    for resolution in (0.6, 0.3):
        stock = plate(resolution)
        removed.append(sum(cut(stock, row, shape.flat(6 * MM, 30 * MM)) for row in rows + sides))
        bounds.append(stock.error_bound() / MM3)
        assert abs(removed[-1] - exact) <= bounds[-1]
    assert bounds[1] < 0.6 * bounds[0]


def cut_leaning(stock, starts, ends, axis, tool):
    return stock.sweep(AxisWay(starts, ends, axis, axis), slabs_of_shape(tool, stock.cell)).sum()


def test_tilted_ball_cuts_the_groove_of_an_upright_one():
    """Where only the ball touches, its axis does not matter."""
    tilt = np.array([[math.sin(0.5), 0.0, math.cos(0.5)]])
    centre = np.array([[5.0, 15.0, 1.0], [25.0, 15.0, 1.0]]) * MM
    half_angle = math.acos(1 / 3)
    exact = 20 * 9 * (half_angle - math.sin(half_angle) * math.cos(half_angle)) + math.pi * 4 * (9 - 2) / 3
    stock = Stock.box((0, 0, -8 * MM), (30 * MM, 30 * MM, 0), 0.2 * MM)
    tips = centre - 3 * MM * tilt
    removed = cut_leaning(stock, tips[:1], tips[1:], tilt, shape.ball(6 * MM, 25 * MM)) / MM3
    assert removed == pytest.approx(exact, rel=0.01)


def test_drill_lying_along_x_bores_a_round_hole():
    """A tool along -x into the side: a horizontal bore, an undercut in every column."""
    stock = Stock.box((0, 0, -20 * MM), (30 * MM, 20 * MM, 0), 0.2 * MM)
    axis = np.array([[1.0, 0.0, 0.0]])
    start, end = np.array([[35.0, 10.0, -10.0]]) * MM, np.array([[15.0, 10.0, -10.0]]) * MM
    removed = cut_leaning(stock, start, end, axis, shape.flat(8 * MM, 40 * MM)) / MM3
    assert removed == pytest.approx(math.pi * 16 * 15, rel=0.01)
    assert len(stock.intervals_at(20 * MM, 10 * MM)) == 2


def test_bead_volume_is_area_times_length_in_any_direction():
    area = (6 - 3) * 3 + math.pi * 9 / 4
    for angle in np.radians([0, 13, 30, 45, 90]):
        stock = Stock.empty((0, 0, 0), (220 * MM, 220 * MM, 10 * MM), 1 * MM)
        line = 110 * MM + np.linspace(-90, 90, 37)[:, None] * MM * np.array([[np.cos(angle), np.sin(angle), 0.0]])
        line[:, 2] = 3 * MM
        added = stock.add_bead(line[:-1], line[1:], 6 * MM, 3 * MM)
        assert added.volume.sum() / MM3 == pytest.approx(area * 180, rel=0.005)
        assert added.nominal.sum() / MM3 == pytest.approx(area * 180, rel=1e-9)
        assert stock.volume == pytest.approx(added.volume.sum(), rel=1e-9)


def test_bead_round_a_circle_and_in_layers():
    angle = np.linspace(0, 2 * math.pi, 181)
    stock = Stock.empty((0, 0, 0), (120 * MM, 120 * MM, 10 * MM), 0.5 * MM)
    nominal = added = 0.0
    for layer in range(3):
        ring = np.c_[60 + 40 * np.cos(angle), 60 + 40 * np.sin(angle), np.full(181, 3.0 * (layer + 1))] * MM
        laid = stock.add_bead(ring[:-1], ring[1:], 6 * MM, 3 * MM)
        nominal, added = nominal + laid.nominal.sum(), added + laid.volume.sum()
    assert added == pytest.approx(nominal, rel=0.005)
    assert top_at(stock, 100 * MM, 60 * MM) == pytest.approx(9 * MM, abs=1e-12)
