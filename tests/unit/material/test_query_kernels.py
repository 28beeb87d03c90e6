"""Look-ups in the stock, against slow twins."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.material import Stock, kernels, shape

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


def columns(stock):
    return stock.lo, stock.hi, stock.count, stock.grid


def slow_occupancy(stock, x, y, z0, z1):
    """Bilinear mean of the shares of the four columns around, by plain Python."""
    u, v = (x - stock.grid[0]) / stock.grid[2] - 0.5, (y - stock.grid[1]) / stock.grid[3] - 0.5
    total = 0.0
    for i in (math.floor(u), math.floor(u) + 1):
        for j in (math.floor(v), math.floor(v) + 1):
            if 0 <= i < stock.count.shape[0] and 0 <= j < stock.count.shape[1]:
                for k in range(stock.count[i, j]):
                    share = max(min(stock.hi[i, j, k], z1) - max(stock.lo[i, j, k], z0), 0.0) / (z1 - z0)
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
        total = kernels.fill_slices(*columns(carved), x, y, z, dz, out)
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


def test_heights_and_points(carved):
    for x, y in np.random.default_rng(9).uniform((0, 0), (30, 20), (100, 2)) * MM:
        i, j = int(x / carved.grid[2]), int(y / carved.grid[3])
        n = carved.count[i, j]
        top = carved.hi[i, j, n - 1] if n else -np.inf
        assert carved.height_at(x, y) == top
        for z in (-9.5 * MM, -5 * MM, -1 * MM):
            held = any(carved.lo[i, j, k] <= z <= carved.hi[i, j, k] for k in range(n))
            assert kernels.is_material(*columns(carved), x, y, z) == held
    assert carved.height_at(-1 * MM, 5 * MM) == -np.inf


def test_highest_under_a_disc(carved):
    x = (np.arange(carved.count.shape[0]) + 0.5) * carved.grid[2]
    y = (np.arange(carved.count.shape[1]) + 0.5) * carved.grid[3]
    tops = np.where(
        carved.count > 0,
        np.take_along_axis(carved.hi, np.maximum(carved.count - 1, 0)[:, :, None], 2)[:, :, 0],
        -np.inf,
    )
    for cx, cy in np.random.default_rng(10).uniform((-3, -3), (33, 23), (50, 2)) * MM:
        under = np.hypot(x[:, None] - cx, y[None, :] - cy) <= 4 * MM
        expected = tops[under].max() if under.any() else -np.inf
        assert kernels.highest_under(carved.hi, carved.count, carved.grid, cx, cy, 4 * MM) == expected


def test_kernels_say_the_same_without_the_compiler(carved):
    arguments = (*columns(carved), 11.3 * MM, 7.7 * MM, -6 * MM, -3 * MM)
    assert kernels.occupancy.py_func(*arguments) == kernels.occupancy(*arguments)
    assert kernels.volume_of.py_func(*columns(carved)) == kernels.volume_of(*columns(carved))
