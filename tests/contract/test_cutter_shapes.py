"""Every kind of cutter: what is cut along a sloping piece is the lowest envelope of the tool, found here by search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.material.axis_way import AxisWay
from gcodesim.material.solid_of_revolution import slabs_of_shape
from gcodesim.material.sweep_kernels import CONE, Shape

MM = 1e-3

SHAPES = {
    "flat": shape.flat(6 * MM, 30 * MM),
    "ball": shape.ball(6 * MM, 30 * MM),
    "bull_nose": shape.bull_nose(8 * MM, 1.5 * MM, 30 * MM),
    "almost_ball": shape.bull_nose(6 * MM, 2.999 * MM, 30 * MM),
    "drill": shape.cone(6 * MM, math.radians(118), 30 * MM),
    "engraver": shape.cone(6 * MM, math.radians(40), 30 * MM, tip_diameter=0.4 * MM),
    "short_flat": shape.cylinder(6 * MM, 1 * MM, 2.5 * MM),
}


def radius_profile(tool, rho):
    """Underside of the tool by its definition, a slow twin of the kernel."""
    beyond = np.maximum(rho - tool.flat, 0.0)
    if tool.kind == CONE:
        return beyond * tool.rise
    return tool.corner - np.sqrt(np.maximum(tool.corner**2 - beyond**2, 0.0))


def expected_envelope(tool, x, y, start, end):
    """Lowest and highest point of the sweep over points (x, y), NaN where the tool never is: golden-section search."""
    d = end - start
    length = math.hypot(d[0], d[1])
    ux, uy = d[0] / length, d[1] / length
    along, across = (x - start[0]) * ux + (y - start[1]) * uy, (y - start[1]) * ux - (x - start[0]) * uy
    with np.errstate(invalid="ignore"):
        half = np.sqrt(tool.radius**2 - across**2)
    low, high = np.maximum(0.0, along - half), np.minimum(length, along + half)
    reached = low <= high

    def height(s):
        rho = np.minimum(np.hypot(along - s, across), tool.radius)
        return start[2] + d[2] * s / length + tool.bottom + radius_profile(tool, rho)

    tops = start[2] + d[2] * np.where(d[2] > 0.0, high, low) / length + tool.top
    golden = (math.sqrt(5.0) - 1.0) / 2.0
    for _ in range(90):
        a, b = high - golden * (high - low), low + golden * (high - low)
        left = height(a) < height(b)
        low, high = np.where(left, low, a), np.where(left, b, high)
    middle = (low + high) / 2.0
    best = np.minimum(np.minimum(height(low), height(high)), height(middle))
    return np.where(reached, best, np.nan), np.where(reached, tops, np.nan)


def centres(stock):
    """Centres of columns along x (nx, 1) and y (1, ny) [m]."""
    (nx, ny), (dx, dy) = stock.relief().tops.shape, stock.spacing
    return stock.origin[0] + (np.arange(nx)[:, None] + 0.5) * dx, stock.origin[1] + (np.arange(ny)[None, :] + 0.5) * dy


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("rise", [-9.0, -1.3, 0.0, 0.4, 4.0])
def test_floor_of_a_sloping_cut_is_the_lowest_envelope(name, rise):
    tool = SHAPES[name]
    stock = Stock.box((0, 0, -40 * MM), (20 * MM, 20 * MM, 0), 0.37 * MM)
    start, end = np.array([4.0, 5.0, -12.0]) * MM, np.array([13.0, 11.0, -12.0 + rise]) * MM
    x, y = centres(stock)
    bottom, top = expected_envelope(tool, x, y, start, end)

    stock.remove(start[None], end[None], tool)

    inner = np.isfinite(bottom)
    columns = [[stock.intervals_at(float(a), float(b)) for b in y[0]] for a in x[:, 0]]
    floor = np.array([[column[0][1] for column in row] for row in columns])
    cut = floor < 0.0
    assert np.array_equal(cut, inner)
    # beside the very rim, where a wall is steeper than the nudge of the columns allows to compare
    rim = np.hypot(np.gradient(np.nan_to_num(bottom, nan=9.0))[0], np.gradient(np.nan_to_num(bottom, nan=9.0))[1]) > 1.0
    compare = inner & ~rim
    assert compare.sum() > 200
    assert np.abs(floor - bottom)[compare].max() < 1e-9
    through = inner & (top < 0.0)
    assert np.array_equal([[len(column) == 2 for column in row] for row in columns], through)
    if through.any():
        roof = np.array([[column[-1][0] for column in row] for row in columns])
        assert np.abs(roof - top)[through & ~rim].max() < 1e-9


def volume_of(shape: Shape) -> float:
    """Volume [m^3] of a shape, from its closed form."""
    radius, corner, flat_radius, rise = shape.radius, shape.corner, shape.flat, shape.rise
    height = shape.top - shape.bottom
    if corner > 0.0:
        body = math.pi * radius**2 * (height - corner)
        # a half torus tube around a disc (Pappus)
        ring = math.pi * flat_radius**2 * corner + math.pi**2 / 2 * flat_radius * corner**2
        return float(body + ring + 2 / 3 * math.pi * corner**3)
    if shape.kind == CONE:
        point = (radius - flat_radius) * rise
        frustum = math.pi * point / 3 * (radius**2 + radius * flat_radius + flat_radius**2)
        return float(math.pi * radius**2 * (height - point) + frustum)
    return float(math.pi * radius**2 * height)


@pytest.mark.parametrize("name", SHAPES)
def test_plunge_removes_the_volume_of_the_tool(name):
    tool = SHAPES[name]
    above, tip = np.array([[10.0, 10.0, 2.0]]) * MM, np.array([[10.0, 10.0, -35.0]]) * MM
    exact = volume_of(tool)
    errors = []
    for resolution in (0.4 * MM, 0.1 * MM):
        stock = Stock.box((0, 0, -40 * MM), (20 * MM, 20 * MM, 0), resolution)
        removed = stock.remove(tip, tip, tool).volume.sum()
        errors.append(abs(removed - exact))
        assert errors[-1] <= stock.error_bound()
    assert errors[1] < 0.01 * exact
    # coming down from above takes the way as well
    way = math.pi * tool.radius**2 * (-35.0 * MM + tool.top)
    stock.remove(above, tip, tool)
    assert stock.volume == pytest.approx(20 * 20 * 40 * MM**3 - exact + way, rel=2e-4)


@pytest.mark.parametrize("name", SHAPES)
def test_removal_does_not_depend_on_the_number_of_steps(name):
    tool = SHAPES[name]
    start, end = np.array([[-5.0, 3.0, -1.0]]) * MM, np.array([[18.0, 14.0, -6.0]]) * MM
    once = Stock.box((0, 0, -20 * MM), (20 * MM, 20 * MM, 0), 0.5 * MM)
    whole = once.remove(start, end, tool).volume.sum()
    points = start + (end - start) * np.linspace(0, 1, 78)[:, None]
    often = Stock.box((0, 0, -20 * MM), (20 * MM, 20 * MM, 0), 0.5 * MM)
    parts = often.remove(points[:-1], points[1:], tool).volume.sum()
    # the columns are the same; strips at walls (wall_kernels) may take another of nearly equal steps
    assert parts == pytest.approx(whole, rel=4e-3 if name == "short_flat" else 1e-3)
    one, other = once.relief(), often.relief()
    assert np.array_equal(np.isnan(one.tops), np.isnan(other.tops))
    assert np.nanmax(np.abs(one.tops - other.tops)) < 1e-10 and np.abs(one.lengths - other.lengths).max() < 1e-10
    assert parts == pytest.approx(20 * 20 * 20 * MM**3 - often.volume, rel=1e-9)


@pytest.mark.parametrize("name", SHAPES)
def test_an_upright_tool_cuts_the_same_as_a_tilted_one_that_stands_upright(name):
    tool = SHAPES[name]
    start, end = np.array([[5.0, 6.0, -4.0]]) * MM, np.array([[9.0, 11.0, -4.0]]) * MM
    upright = Stock.box((0, 0, -20 * MM), (15 * MM, 15 * MM, 0), 0.3 * MM)
    tilted = upright.copy()
    axis = np.array([[0.0, 0.0, 1.0]])
    expected = upright.remove(start, end, tool).volume.sum()
    removed = tilted.sweep(AxisWay(start, end, axis, axis), slabs_of_shape(tool, tilted.cell)).sum()
    # a hollow has edges all around, which one surface of three directions bevels
    assert removed == pytest.approx(expected, rel=0.01 if name == "short_flat" else 0.004)
    assert abs(removed - expected) <= tilted.error_bound()
