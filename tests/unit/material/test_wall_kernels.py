"""Walls beside the borders of columns: what single steps take, and what a wall at several places is worth."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.material import Stock, shape
from gcodesim.material.kernels import beyond_columns
from gcodesim.material.turning import turned
from gcodesim.material.wall_kernels import advance_wall, place_on_rim, shorten_walls

MM = 1e-3
MM3 = 1e-9
ROUNDING = 1e-15
"""Volume [m³] of a step that is rounding: heights of 0.1 m in single precision (4e-9 m) over a cell of 0.4 mm."""

CUTTERS = {
    "flat": shape.flat(4 * MM, 30 * MM),
    "ball": shape.ball(4 * MM, 30 * MM),
    "bull_nose": shape.bull_nose(4 * MM, 0.7 * MM, 30 * MM),
    "drill": shape.cone(3 * MM, 2.06, 30 * MM),
    "short": shape.flat(3 * MM, 1.5 * MM),
    "thin": shape.flat(0.4 * MM, 30 * MM),
}


def random_passes(rng, passes):
    """Tips (p, 3) of passes across a plate of 20 x 18, ever deeper, level or on slopes, some of them shaking."""
    z = 0.0
    for _ in range(passes):
        if rng.random() < 0.4:
            z -= rng.uniform(0.2, 2.0)
        begin, end = rng.uniform(-2.0, 20.0, (2, 2))
        lift = rng.uniform(-0.5, 0.5, 2) * (rng.random() < 0.3)
        steps = max(2, int(np.hypot(*(end - begin)) / rng.choice([0.1, 0.3, 1.0, 1000.0])))
        t = np.linspace(0.0, 1.0, steps + 1)[:, None]
        points = np.c_[begin + t * (end - begin), z + lift[0] + t * (lift[1] - lift[0])]
        yield (points + rng.normal(0.0, rng.choice([0.0, 1e-3, 2e-2]), points.shape)) * MM


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("cutter", sorted(CUTTERS))
def test_no_step_gives_volume_back(cutter, seed):
    """Whatever was cut before: each step removes at least nothing, and steps add up to what the stock has lost."""
    rng = np.random.default_rng([seed, *cutter.encode()])
    stock = Stock.box((0, 0, -20 * MM), (20 * MM, 18 * MM, 0), float(rng.choice([0.25, 0.4])) * MM)
    before, removed = stock.volume, 0.0
    for points in random_passes(rng, 25):
        volume = stock.remove(points[:-1], points[1:], CUTTERS[cutter]).volume
        assert volume.min() >= -ROUNDING
        removed += volume.sum()
    assert removed == pytest.approx(before - stock.volume, rel=1e-12)
    assert removed > 0.1 * stock.original[1].max(initial=0.0)


@pytest.mark.parametrize("turn", [np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, 1.0, -1.0])])
def test_no_step_gives_volume_back_on_the_other_side(turn):
    rng = np.random.default_rng(5)
    stock = Stock.box((0, 0, -20 * MM), (20 * MM, 18 * MM, 0), 0.4 * MM)
    for points in random_passes(rng, 12):
        stock.remove(points[:-1], points[1:], CUTTERS["flat"])
    stock = turned(stock, turn)
    corner = np.r_[stock.origin, stock.z_range[1]]
    before, removed = stock.volume, 0.0
    for points in random_passes(rng, 12):
        volume = stock.remove(points[:-1] + corner, points[1:] + corner, CUTTERS["flat"]).volume
        assert volume.min() >= -ROUNDING
        removed += volume.sum()
    assert removed == pytest.approx(before - stock.volume, rel=1e-12)


def wall_at(stock, levels):
    """Walls of slots along y whose right sides stand at x [mm] at depths z [mm], each cut in small steps; volumes."""
    volumes = []
    for x, z in levels:
        y = np.linspace(-5.0, 25.0, 301)
        points = np.c_[np.full(301, x - 2.0), y, np.full(301, z)] * MM
        volumes.append(stock.remove(points[:-1], points[1:], CUTTERS["flat"]).volume.sum() / MM3)
    return volumes


def plate():
    return Stock.box((0, 0, -12 * MM), (20 * MM, 20 * MM, 0), 0.5 * MM)


def test_deeper_passes_that_reach_less_far_count_at_once():
    """Three depths, each wall 20 µm inside the one above: every pass removes what it does on an exact part."""
    found = wall_at(plate(), [(10.24, -3), (10.22, -6), (10.20, -9)])
    # the left side is cut anew 20 µm further by each pass, from the top down to where it stood
    exact = [4.0 * 3 * 20, (4.0 * 3 + 0.02 * 3) * 20, (4.0 * 3 + 0.02 * 6) * 20]
    assert found == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize(("x", "finished"), [(10.1, 10.2), (9.8, 10.2), (9.8, 9.9)])
def test_finishing_in_several_depths_takes_its_share_at_each(x, finished):
    """An allowance of less than a cell over the whole depth, taken in three levels: a third each."""
    stock = plate()
    wall_at(stock, [(x, -9)])
    found = wall_at(stock, [(finished, -3), (finished, -6), (finished, -9)])
    assert found == pytest.approx([(finished - x) * 3 * 20] * 3, rel=1e-4)
    assert wall_at(stock, [(finished, -9), (x, -9), (finished, -3)]) == pytest.approx([0.0] * 3, abs=1e-6)


def test_facing_leaves_the_rest_of_a_wall():
    """2 mm off the top of a pocket 6 deep: what its walls are beside the grid stays for the other 4."""
    stock = plate()
    wall_at(stock, [(10.17, -6)])
    big = shape.flat(60 * MM, 30 * MM)
    stock.remove(np.array([[-40.0, 10, -2]]) * MM, np.array([[60.0, 10, -2]]) * MM, big)
    assert stock.volume / MM3 == pytest.approx(20 * (20 * 10 - 4 * 4), rel=1e-6)


def at_border(*cuts, walls=None):
    """Gains [m] of cuts (beyond, height, fresh, dip) at one border in x, and the walls."""
    walls = np.zeros((8, 4, 4), dtype=np.float32) if walls is None else walls
    return [advance_wall(walls, 0, 2, 1, 1, *cut) for cut in cuts], walls


def test_a_wall_keeps_two_places():
    gains, walls = at_border((0.25, 3.0, 3.0, 0.0), (0.125, 5.0, 2.0, 0.0), (0.5, 1.0, 0.0, 0.0))
    assert gains == pytest.approx([0.75, 0.25, 0.25])
    assert beyond_columns(walls) == pytest.approx(1.25)
    assert at_border((0.5, 1.0, 0.0, 0.0), walls=walls)[0] == [0.0]
    assert shorten_walls(walls, 1, 1, 1.0) == pytest.approx(-0.5)
    assert shorten_walls(walls, 1, 1, 4.0) == pytest.approx(-0.75)
    assert not walls[[0, 2, 6]].any()


def test_before_the_border_only_what_was_cut_just_now_stays():
    """A step that a ball or the stock's own shape has left has no wall: a tool that comes near it does not add any."""
    gains, walls = at_border((-0.25, 3.0, 1.0, 0.0), (-0.25, 3.0, 0.0, 0.0), (0.25, 3.0, 0.0, 0.0))
    assert gains == pytest.approx([-0.25, 0.0, 1.0])
    assert beyond_columns(walls) == pytest.approx(0.75)


def test_a_third_place_counts_with_the_nearer():
    gains, _ = at_border((0.5, 2.0, 2.0, 0.0), (0.0, 8.0, 6.0, 0.0), (0.3, 4.0, 0.0, 0.0), (0.1, 4.0, 0.0, 0.0))
    assert gains == pytest.approx([1.0, 0.0, 1.0, 0.0])


def test_a_sliver_at_the_top_moves_no_wall_below_it():
    """A face mill has left a step of some nanometres half a cell further than the walls of two levels below it."""
    gains, walls = at_border((0.25, 1e-6, 1e-6, 0.0), (-0.25, 2.0, 2.0, 0.0), (-0.375, 4.0, 2.0, 0.0))

    assert walls[:, 2, 1][[0, 2]] == pytest.approx([2.25, 1e-6])
    assert walls[:, 2, 1][[4, 6]] == pytest.approx([-0.3125, 4.0], abs=1e-5)  # the volume of both
    assert sum(gains) == pytest.approx(-1.25, abs=1e-5)


def test_the_foot_of_a_wall_on_a_slope_counts_at_the_border():
    gains, _ = at_border((0.25, 3.0, 3.0, 0.5), (0.125, 3.4, 0.4, 0.5), (0.125, 5.0, 2.0, 0.5))
    assert gains == pytest.approx([0.75, 0.0, 0.25])


def test_a_slanted_wall_counts_once():
    """Borders in x and in y see the same wall: a column loses what the one takes that takes most."""
    walls = np.zeros((8, 4, 4), dtype=np.float32)
    assert advance_wall(walls, 0, 2, 1, 1, 0.25, 4.0, 4.0, 0.0) == pytest.approx(1.0)
    assert advance_wall(walls, 1, 1, 2, 1, 0.125, 4.0, 4.0, 0.0) == 0.0
    assert advance_wall(walls, 1, 1, 2, 1, 0.375, 4.0, 4.0, 0.0) == pytest.approx(0.5)
    assert beyond_columns(walls) == pytest.approx(1.5)


@pytest.mark.parametrize("uf", [0.0, 0.6, -0.6, 1.0])
def test_the_place_on_a_rim_makes_it_furthest(uf):
    """Against all discs along the piece."""
    um = np.sqrt(1.0 - uf * uf)
    for side in (-1, 1):
        for offset in (-0.4, 0.2, 1.1):
            s = np.linspace(0.0, 1.0, 200001)
            half2 = 2.25 - (offset - uf * s) ** 2
            rim = np.where(half2 >= 0.0, um * s + side * np.sqrt(np.maximum(half2, 0.0)), -np.inf * side)
            best = s[np.argmax(side * rim)]
            if uf != 0.0 or um != 0.0:
                assert place_on_rim(side, offset, uf, um, 1.0, 1.5) == pytest.approx(best, abs=2e-5)
