"""Peaks within a revolution against sums that are fine in angle and height, with contact known in closed form."""

import math

import numpy as np
import pytest

from gcodesim.material.stock import Stock
from gcodesim.processes.laws import Kienzle, LinearEdge
from gcodesim.processes.milling import Milling
from gcodesim.processes.window import Window
from gcodesim.tools import TOOLS
from gcodesim.units import DEG

STEEL = Kienzle.from_table(2500.0, 0.26)
ALUMINIUM = LinearEdge.from_table(631.0, 13.0, 99.0, 10.0, 273.0, 2.8)
D, OMEGA, CHIP = 10e-3, 400.0, 0.05e-3
FREE = 2.0


def mill(kind, flutes, helix):
    more = {"corner_radius": 2e-3} if kind == "bull_nose_end_mill" else {}
    return TOOLS[kind](diameter=D, flutes=flutes, helix=helix * DEG, **more)


def elements(cutter, depth, count=300):
    """Radius, height, kappa and width (n,) of fine elements of the edge below `depth` [m]."""
    found = []
    for arc, at_r, at_z, kappa0, kappa1, length, foot, head, _ in cutter.edge:
        share = (np.arange(count) + 0.5) / count
        if arc > 0.0:
            end = kappa1 if head <= depth else math.acos(max((at_z - depth) / arc, -1.0))
            kappa = kappa0 + share * (end - kappa0)
            found.append((at_r + arc * np.sin(kappa), at_z - arc * np.cos(kappa), kappa, arc * (end - kappa0) / count))
        elif foot < depth:
            s = share * min(length, (depth - foot) / math.sin(kappa0) if kappa0 > 0.0 else length)
            z = foot + s * math.sin(kappa0)
            found.append((at_r + s * math.cos(kappa0), z, np.full(count, kappa0), s[-1] / (count - 0.5)))
    return [np.concatenate([np.broadcast_to(row[i], count) for row in found]) for i in range(4)]


def loads_at(law, phi, elements, wall, slope=0.0):
    """Forces and torque (k, 4) of the elements (n,) of one edge that stand at the angles phi (k, n)."""
    r, sine, cosine, width = elements
    s, c = np.sin(phi), np.cos(phi)
    advance = math.cos(slope) * s * sine - math.sin(slope) * cosine
    here = (r * c <= wall) & (advance > 1e-4)
    chip = np.where(here, CHIP * advance, 1.0)
    grown = [np.where(here, width * (f * chip**p + e), 0.0) for f, p, e in law.packed]
    inward = grown[1] * sine + grown[2] * cosine
    parts = (-grown[0] * c - inward * s, grown[0] * s - inward * c, grown[1] * cosine - grown[2] * sine, grown[0] * r)
    return np.stack([part.sum(axis=1) for part in parts], axis=1)


def by_sum(cutter, law, depth, wall, slope=0.0, angles=720):
    """Greatest force and torque in a pitch, `angles` looks at it; material is where l <= `wall` [m]."""
    r, z, kappa, width = elements(cutter, depth)
    sine, cosine = np.sin(kappa), np.where(np.abs(np.cos(kappa)) < 1e-12, 0.0, np.cos(kappa))
    pitch = 2.0 * math.pi / cutter.flutes
    turned = (np.arange(angles) / angles)[:, None] * pitch - 2.0 * z * math.tan(cutter.helix) / D
    loads = np.zeros((angles, 4))
    for tooth in range(cutter.flutes):
        loads += loads_at(law, turned + tooth * pitch, (r, sine, cosine, width), wall, slope)
    return float(np.sqrt((loads[:, :3] ** 2).sum(axis=1)).max()), float(loads[:, 3].max())


def in_stock(cutter, law, depth, wall, cells, slope=0.0, up=False):
    """The same of one step in a block that ends at the wall, with cells of D / `cells`."""
    tip = np.array([10e-3 + 0.3 * D / cells, -wall, -depth])
    way = np.array([-1.0 if up else 1.0, 0.0, math.tan(slope)]) * math.cos(slope)
    velocity = way * CHIP * cutter.flutes * OMEGA / (2.0 * math.pi)
    window = Window(
        piece_start=tip[None],
        piece_end=(tip + 1e-3 * velocity)[None],
        piece_step=np.zeros(1, dtype=int),
        axis=np.array([[0.0, 0.0, 1.0]]),
        velocity=velocity[None],
        rapid=np.zeros(1, dtype=bool),
        signals={"spindle": np.full(1, OMEGA), "active": np.zeros(1, dtype=bool)},
        dt=1e-3,
    )
    process = Milling(cutter=cutter, law=law)
    state = process.begin()
    state.values[2] = FREE  # it stands in the cut that it has made
    found = process.run(Stock.box((0.0, -20e-3, -20e-3), (40e-3, 0.0, 0.0), D / cells), window, state)
    return float(found["peak_force"][0]), float(found["peak_torque"][0])


@pytest.mark.parametrize(("cells", "off"), [(10, 0.01), (20, 0.005)])
@pytest.mark.parametrize(("flutes", "helix"), [(1, 0.0), (2, 30.0), (3, 45.0), (4, 30.0), (6, 45.0), (6, -30.0)])
@pytest.mark.parametrize("law", [STEEL, ALUMINIUM], ids=["kienzle", "linear"])
def test_an_end_mill_at_a_quarter_of_its_width(law, flutes, helix, cells, off):
    """Up to a tenth was missing: an entry or exit was smeared over a 64th of a revolution."""
    cutter = mill("flat_end_mill", flutes, helix)
    for depth in (1e-3, 8e-3):
        wanted = by_sum(cutter, law, depth, 2.5e-3 - D / 2)

        assert in_stock(cutter, law, depth, 2.5e-3 - D / 2, cells) == pytest.approx(wanted, rel=off)


@pytest.mark.parametrize("kind", ["ball_end_mill", "bull_nose_end_mill"])
@pytest.mark.parametrize(("flutes", "helix"), [(1, 0.0), (2, 30.0), (4, 45.0)])
def test_round_ends_in_a_slot_and_at_half_their_width(kind, flutes, helix):
    cutter = mill(kind, flutes, helix)
    for wall, cells, off in ((D, 10, 0.005), (0.0, 40, 0.02)):
        wanted = by_sum(cutter, STEEL, 8e-3, wall)

        assert in_stock(cutter, STEEL, 8e-3, wall, cells) == pytest.approx(wanted, rel=off)


@pytest.mark.parametrize("cells", [10, 40])
@pytest.mark.parametrize("slope", [-0.1, -0.6])
@pytest.mark.parametrize("helix", [0.0, 30.0])
def test_a_ramp_beside_a_wall(helix, slope, cells):
    """The bottom cuts all the way round, the side in front only. Near the axis a cell is many angles wide.

    Up to 18 % were missing where a wall that goes through the axis was as soft there as the shares say.
    """
    cutter = mill("flat_end_mill", 3, helix)
    wanted = by_sum(cutter, STEEL, 4e-3, 0.0, slope=slope)

    assert in_stock(cutter, STEEL, 4e-3, 0.0, cells, slope=slope) == pytest.approx(wanted, rel=0.003)


@pytest.mark.parametrize("wall", [-0.7e-3, 0.3e-3])
def test_a_ramp_beside_a_wall_that_misses_the_axis(wall):
    cutter = mill("flat_end_mill", 1, 0.0)
    wanted = by_sum(cutter, STEEL, 4e-3, wall, slope=-0.2)

    assert in_stock(cutter, STEEL, 4e-3, wall, 10, slope=-0.2) == pytest.approx(wanted, rel=0.006)


@pytest.mark.parametrize("angle", [0.0, 0.785])
@pytest.mark.parametrize("wall", [-4.5e-3, -4e-3, -2.5e-3])
def test_a_wall_that_lies_anywhere_on_the_grid(wall, angle):
    """The wall of an earlier cut is where that tool left it, not at a border of columns; one and a half cells and up.

    At the default grid the force at half a millimetre of width was 60 % low, that at a quarter of the width 4 % off.
    """
    cutter, cell = mill("flat_end_mill", 2, 30.0), D / 24
    ux, uy = math.cos(angle), math.sin(angle)
    middle = np.array([20e-3 + 0.37 * cell, 20e-3 + 0.26 * cell, -4e-3])
    stock = Stock.box((0.0, 0.0, -20e-3), (40e-3, 40e-3, 0.0), cell)
    way, left = np.array([ux, uy, 0.0]), np.array([-uy, ux, 0.0])

    def cut(process, begin, end, steps):
        places = begin + np.linspace(0.0, 1.0, steps + 1)[:, None] * (end - begin)
        window = Window(
            piece_start=places[:-1],
            piece_end=places[1:],
            piece_step=np.arange(steps),
            axis=np.tile([0.0, 0.0, 1.0], (steps, 1)),
            velocity=np.diff(places, axis=0) / 4e-3,
            rapid=np.zeros(steps, dtype=bool),
            signals={"spindle": np.full(steps, OMEGA), "active": np.zeros(steps, dtype=bool)},
            dt=4e-3,
        )
        state = process.begin()
        state.values[2] = FREE
        return process.run(stock, window, state)

    wide = TOOLS["flat_end_mill"](diameter=80e-3, flutes=2)
    aside = middle + (wall + 40e-3) * left
    cut(Milling(cutter=wide, law=None), aside - 150e-3 * way, aside + 150e-3 * way, 1)
    step = 4e-3 * CHIP * cutter.flutes * OMEGA / (2.0 * math.pi)
    cut(Milling(cutter=cutter, law=None), middle - 40e-3 * way, middle, 1)
    found = cut(Milling(cutter=cutter, law=STEEL), middle, middle + 200 * step * way, 200)
    force, torque = by_sum(cutter, STEEL, 4e-3, wall)

    assert found["peak_force"][-50:].max() == pytest.approx(force, rel=0.01)
    assert found["peak_torque"][-50:].max() == pytest.approx(torque, rel=0.01)
    assert found["peak_force"][-50:].mean() == pytest.approx(force, rel=0.02)


@pytest.mark.parametrize("further", [-20e-6, 0.0, 5e-6, 0.1e-3])
def test_below_a_floor_an_edge_meets_another_wall_than_above(further):
    """A second level 0.5 mm wide, `further` into the wall of the first one: what is thin above is felt besides."""
    cutter, cell = mill("flat_end_mill", 3, 30.0), D / 40
    stock = Stock.box((0.0, 0.0, -20e-3), (40e-3, 40e-3, 0.0), cell)
    middle = np.array([20e-3 + 0.37 * cell, 20e-3 + 0.26 * cell, 0.0])
    way = np.array([4e-3 * CHIP * cutter.flutes * OMEGA / (2.0 * math.pi), 0.0, 0.0])

    def cut(law, aside, depth, begin, end):
        process = Milling(cutter=cutter, law=law)
        places = middle + (0.0, aside, -depth) + np.arange(begin, end + 1)[:, None] * way
        steps = len(places) - 1
        window = Window(
            piece_start=places[:-1],
            piece_end=places[1:],
            piece_step=np.arange(steps),
            axis=np.tile([0.0, 0.0, 1.0], (steps, 1)),
            velocity=np.diff(places, axis=0) / 4e-3,
            rapid=np.zeros(steps, dtype=bool),
            signals={"spindle": np.full(steps, OMEGA), "active": np.zeros(steps, dtype=bool)},
            dt=4e-3,
        )
        state = process.begin()
        state.values[2] = FREE
        return np.linalg.norm(process.run(stock, window, state).wrench[:, :3], axis=1)

    cut(None, 0.5e-3, 4e-3, -200, 200)
    cut(None, 0.0, 2e-3, -200, 200)
    found = cut(STEEL, -further, 4e-3, -100, 0)
    wanted = mean_by_sum(cutter, STEEL, 2e-3, -D / 2 + 0.5e-3 + further)
    if further > 0.0:
        wanted += mean_by_sum(cutter, STEEL, 2e-3, -D / 2 + further)

    assert found[-50:].mean() == pytest.approx(wanted, rel=0.015)


def mean_by_sum(cutter, law, depth, wall):
    """The size of the mean force of a level cut, to the right of a wall, by the sum over all elements and angles."""
    r, _, kappa, width = elements(cutter, depth)
    own = (r, np.sin(kappa), np.cos(kappa), width)
    phi = (np.arange(8192) + 0.5) / 8192 * 2.0 * math.pi
    mean = np.mean([loads_at(law, some[:, None], own, wall).mean(axis=0) for some in phi.reshape(8, -1)], axis=0)
    return float(np.linalg.norm(mean[:3])) * cutter.flutes
