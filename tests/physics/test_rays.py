"""An extruder that throws particles along the rays of a cone: volume, spot, seed, walls, and a tool that leans."""

import math

import numpy as np
import pytest

from gcodesim.material.rain import NozzleRays, rain_on, rays_of
from gcodesim.material.stock import Stock
from gcodesim.units import DEG, MM, MM3
from tests.physics.runs import run_texts
from tests.unit.material.columns import bottoms_and_tops, raise_from

CELL = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: world, xyz: [400, 300, -200]}}
stock: {min: [-20, -30, -5], max: [80, 30, 0], in: G54, resolution: 0.5}
tools:
  1: {type: extruder, bead_width: 6, bead_height: 3, flow: 300 mm^3/s, length: 40, rays: {RAYS}}
m_codes:
  M10: {tool: activate}
  M11: {tool: deactivate}
"""
RUN = "G21 G90 G61\nT1 M6\nG43 H1\nG0 X0 Y0\nG0 Z30\nM10\nG1 X60 F1500\nM11\nG0 Z60\nM2\n"
UP = [0.0, 0.0, 1.0]


def cell_with(**rays):
    values = {"angle": "20 deg", "distance": "60 mm", **rays}
    return CELL.replace("{RAYS}", "{" + ", ".join(f"{k}: {v}" for k, v in values.items()) + "}")


def plate(low=-40.0, high=40.0):
    return Stock.box((low * MM, low * MM, -5.0 * MM), (high * MM, high * MM, 0.0), 0.5 * MM)


def thrown(stock, cone, axis=UP, volume=400.0, at=(0.0, 0.0, 30.0), first=0):
    tip = np.array([at]) * MM
    return rain_on(stock, cone, tip, tip, np.array([axis]), np.array([volume * MM3]), first)


@pytest.mark.parametrize("rays", [{}, {"number": 3}, {"number": 200}, {"angle": "60 deg"}, {"seed": 7}])
def test_what_is_thrown_is_in_the_stock(rays):
    """The volume is that of the pump, whatever the rays."""
    ran = run_texts(RUN, cell_with(**rays))
    told = ran.results.as_json()["tools"][0]

    assert ran.misuse == []
    assert ran.stock.deposited / MM3 == pytest.approx(told["extruded_mm3"], rel=1e-9)
    assert told["extruded_mm3"] == pytest.approx(300.0 * 60.0 / 25.0, rel=5e-3)


def test_the_spot_is_that_of_the_cone():
    cone = NozzleRays(spread=math.tan(10 * DEG), far=60 * MM, number=20_000, seed=1)
    starts, ways = rays_of(cone, np.zeros((1, 3)), np.zeros((1, 3)), np.array([UP]), 0)
    at = starts + ways * (30 * MM / -ways[:, 2])[:, None]
    away = np.hypot(at[:, 0], at[:, 1])

    assert np.allclose(np.linalg.norm(ways, axis=1), 1.0, atol=1e-12)
    assert away.max() == pytest.approx(30 * MM * math.tan(10 * DEG), rel=1e-3)
    assert np.mean(away < 15 * MM * math.tan(10 * DEG)) == pytest.approx(0.25, abs=0.01)  # evenly by area
    assert abs(at[:, :2].mean(axis=0)).max() < 0.05 * MM


def test_the_seed_places_the_rays_and_windows_do_not():
    cone = NozzleRays(spread=0.2, far=60 * MM, number=5, seed=3)
    tips, axes = np.zeros((8, 3)), np.tile(UP, (8, 1))
    whole = rays_of(cone, tips, tips, axes, 0)[1]
    second = rays_of(cone, tips[4:], tips[4:], axes[4:], 20)[1]
    other = rays_of(NozzleRays(spread=0.2, far=60 * MM, number=5, seed=4), tips, tips, axes, 0)[1]

    assert np.array_equal(whole[20:], second)
    assert not np.array_equal(whole, other)


def test_what_flies_past_is_lost_and_told():
    ran = run_texts(RUN, cell_with(distance="20 mm"))
    assert ran.stock.deposited == 0.0
    assert [code for code, _ in ran.misuse] == ["GS522"]


def test_a_tool_that_leans_throws_along_its_axis():
    stock, lean = plate(), 30.0 * DEG
    cone = NozzleRays(spread=0.0, far=80 * MM, number=100, seed=1)
    done = thrown(stock, cone, axis=[math.sin(lean), 0.0, math.cos(lean)], volume=10.0)

    assert done.volume.sum() / MM3 == pytest.approx(10.0, rel=1e-9)
    assert done.flight.min() / MM == pytest.approx(30.0 / math.cos(lean), rel=0.1)
    points = stock.surface().vertices
    heap = points[points[:, 2] > 0.5 * MM]
    assert heap[:, 0].mean() / MM == pytest.approx(-30.0 * math.tan(lean), abs=1.5)


def test_a_heap_is_no_steeper_than_it_can_lie():
    stock = plate()
    thrown(stock, NozzleRays(spread=0.0, far=60 * MM, number=4000, seed=1), volume=2000.0)
    top = stock.extent()[1][2] / MM
    cone = (3.0 * 2000.0 / math.pi) ** (1.0 / 3.0)  # a cone of 45 degrees with that volume

    assert stock.volume / MM3 == pytest.approx(80.0 * 80.0 * 5.0 + 2000.0, rel=1e-9)
    assert top == pytest.approx(cone, rel=0.25)


def test_particles_stay_at_a_wall():
    stock = plate()
    wall = Stock.box((0.0, -40 * MM, -5 * MM), (40 * MM, 40 * MM, 20 * MM), 0.5 * MM)
    done = thrown(
        wall, NozzleRays(spread=0.0, far=60 * MM, number=20, seed=1), axis=[-1.0, 0.0, 0.0], at=(-20.0, 0.0, 10.0)
    )
    assert done.volume.sum() == 0.0  # beside the grid of the wall there is no column to stay in

    both = plate()
    raise_from(both, 80, 20 * MM)
    done = thrown(
        both, NozzleRays(spread=0.0, far=60 * MM, number=20, seed=1), axis=[-1.0, 0.0, 0.0], at=(-20.0, 0.2, 10.0)
    )
    assert done.volume.sum() / MM3 == pytest.approx(400.0, rel=1e-9)
    assert stock.volume < both.volume


def test_the_number_of_rays_does_not_change_where_it_lies():
    """Identity: as many rays as one likes, the same heap within the grain of the particles."""
    heaps = []
    for number in (500, 5000):
        stock = plate()
        thrown(stock, NozzleRays(spread=0.3, far=60 * MM, number=number, seed=2), volume=3000.0)
        bottoms, height = bottoms_and_tops(stock)
        x = (np.arange(160) + 0.5) * 0.5 - 40.0
        spread = np.sqrt(np.average(x**2, weights=height.sum(axis=1)))
        heaps.append((stock.volume, spread))
        assert bottoms.min() == bottoms.max() == -5.0 * MM
    assert heaps[0][0] == pytest.approx(heaps[1][0], rel=1e-9)
    assert heaps[0][1] == pytest.approx(heaps[1][1], rel=0.02)
