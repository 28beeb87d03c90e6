"""Look-ups in the stock, against slow twins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material import Stock, kernels, shape
from tests.tops import top_at

MM = 1e-3


@pytest.fixture(scope="module")
def carved():
    """A small stock with floors, walls and an undercut."""
    stock = Stock.box((0, 0, -10 * MM), (30 * MM, 20 * MM, 0), 0.8 * MM)
    rng = np.random.default_rng(5)
    points = rng.uniform((0, 0, -9), (30, 20, -1), (12, 3)) * MM
    stock.remove(points[:-1], points[1:], shape.flat(5 * MM, 2 * MM))
    stock.remove(points[:-1], points[1:], shape.ball(4 * MM, 30 * MM))
    return stock


def slow_occupancy(stock, x, y, z0, z1):
    """Bilinear mean of the shares of the four columns around, by plain Python."""
    (lo, hi, number), grid = stock.field.columns, stock.field.grid
    u, v = (x - grid.x) / grid.dx - 0.5, (y - grid.y) / grid.dy - 0.5
    total = 0.0
    for i in (math.floor(u), math.floor(u) + 1):
        for j in (math.floor(v), math.floor(v) + 1):
            if 0 <= i < number.shape[0] and 0 <= j < number.shape[1]:
                for k in range(number[i, j]):
                    share = max(min(hi[i, j, k], z1) - max(lo[i, j, k], z0), 0.0) / (z1 - z0)
                    total += (1 - abs(u - i)) * (1 - abs(v - j)) * share
    return total


def test_occupancy_is_the_bilinear_mean(carved):
    rng = np.random.default_rng(6)
    for x, y, z in rng.uniform((-1, -1, -11), (31, 21, 1), (300, 3)) * MM:
        height = rng.uniform(0.01, 3) * MM
        expected = slow_occupancy(carved, x, y, z, z + height)
        assert carved.occupancy(x, y, z, z + height) == pytest.approx(expected, abs=1e-9)


def test_slices_add_up_to_what_single_questions_say(carved):
    rng = np.random.default_rng(8)
    out = np.empty(7)
    for x, y, z in rng.uniform((-1, -1, -11), (31, 21, 0), (200, 3)) * MM:
        dz = rng.uniform(0.05, 0.8) * MM
        total = kernels.fill_slices(carved.field, x, y, z, dz, out)
        expected = [slow_occupancy(carved, x, y, z + s * dz, z + (s + 1) * dz) for s in range(7)]
        assert out == pytest.approx(expected, abs=1e-9)
        assert total == pytest.approx(sum(expected), abs=1e-9)


def test_occupancy_is_continuous_and_half_at_a_wall():
    stock = Stock.box((0, 0, -10 * MM), (20 * MM, 20 * MM, 0), 1 * MM)
    across = np.linspace(-1, 1, 401) * MM
    shares = [stock.occupancy(x, 10 * MM, -5 * MM, -4 * MM) for x in across]
    assert np.abs(np.diff(shares)).max() < 0.006
    assert shares[0] == 0.0 and shares[-1] == 1.0
    assert stock.occupancy(0.0, 10 * MM, -5 * MM, -4 * MM) == pytest.approx(0.5)
    assert stock.occupancy(10 * MM, 10 * MM, -0.5 * MM, 0.5 * MM) == pytest.approx(0.5)


def test_intervals_and_heights(carved):
    lo, hi, number = carved.field.columns
    for x, y in np.random.default_rng(9).uniform((0, 0), (30, 20), (100, 2)) * MM:
        at = int(x / carved.field.grid.dx), int(y / carved.field.grid.dy)
        n = number[at]
        assert carved.intervals_at(x, y) == list(zip(lo[at][:n], hi[at][:n], strict=True))
        assert top_at(carved, x, y) == (hi[at][n - 1] if n else -np.inf)
    assert carved.intervals_at(-1 * MM, 5 * MM) == [] and top_at(carved, -1 * MM, 5 * MM) == -np.inf


def test_kernels_say_the_same_without_the_compiler(carved):
    arguments = (carved.field, 11.3 * MM, 7.7 * MM, -6 * MM, -3 * MM)
    assert kernels.occupancy.py_func(*arguments) == kernels.occupancy(*arguments)
    assert kernels.volume_of.py_func(carved.field) == kernels.volume_of(carved.field)
