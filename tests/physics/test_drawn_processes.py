"""Processes in whole runs with drawn numbers, each against a closed form that is written down here."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest

from gcodesim.material.stock import cells_along
from gcodesim.world.protocol import STANDARD_GRAVITY
from tests.physics.runs import Ran, run_texts

DRAWS = [pytest.param(seed, marks=() if seed < 2 else pytest.mark.slow) for seed in range(20)]
G = -STANDARD_GRAVITY[2]


def draw(seed: int, kind: str) -> np.random.Generator:
    return np.random.default_rng([seed, *kind.encode()])


def columns_across(ran: Ran, x: float) -> tuple[np.ndarray, np.ndarray]:
    """Middles of the columns along Y at `x` [m] of the only stock, and their tops [m], -inf where nothing is."""
    (placed,) = ran.shop.stocks.values()
    stock = placed.stock
    low, high = stock.bounds
    count = cells_along(high[1] - low[1], stock.resolution)
    y = low[1] + (high[1] - low[1]) * (np.arange(count) + 0.5) / count
    tops = [max((top for _, top in stock.intervals_at(x, each)), default=-np.inf) for each in y]
    return y, np.array(tops)


# ---- material that is added

PRINTER = """
gcodesim: 1
machine: gantry_xyz
dialect: marlin
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: [-25, -25, -2], max: [85, 25, 0], in: G54, resolution: {cell:.9f}}}
tools:
  0: {{type: extruder, bead_width: {width:.4f}, bead_height: {height:.4f}, filament_diameter: {filament}, length: 40}}
"""


@pytest.mark.parametrize("seed", DRAWS)
def test_bead(seed: int) -> None:
    """Its section is a rectangle with round ends, (w - h) h + pi h²/4, as high as the nozzle and as wide as named."""
    rng = draw(seed, "bead")
    width, filament, way = rng.uniform(0.8, 6.0), rng.choice([1.75, 2.85]), rng.uniform(30.0, 60.0)
    height = width * rng.uniform(0.25, 0.8)
    section = (width - height) * height + 0.25 * pi * height**2
    fed = section * way / (0.25 * pi * filament**2)
    cell = PRINTER.format(cell=max(width / 24.0, 0.06), width=width, height=height, filament=filament)
    text = f"G21\nG90\nM83\nG1 X0 Y0 Z{height:.5f} F6000\nG1 X{way:.4f} E{fed:.6f} F1800\nG1 Z20 F6000\n"
    ran = run_texts(text, cell)

    assert ran.misuse == []
    assert ran.stock.deposited * 1e9 == pytest.approx(section * way, rel=5e-3)
    y, tops = columns_across(ran, 0.5e-3 * way)
    laid, cell_size = np.maximum(tops, 0.0) * 1e3, float(np.diff(y).mean()) * 1e3
    assert laid.sum() * cell_size == pytest.approx(section, rel=0.01)
    assert laid.max() == pytest.approx(height, rel=1e-3)
    assert np.count_nonzero(laid > 0.02 * height) * cell_size == pytest.approx(width, abs=2.0 * cell_size)


@pytest.mark.parametrize("seed", DRAWS)
def test_spiral_wall(seed: int) -> None:
    """A helix of n turns is n √((pi D)² + h²) long; volume is that times the section of the bead."""
    rng = draw(seed, "spiral")
    width = rng.uniform(0.8, 3.0)
    height, diameter, turns = width * rng.uniform(0.3, 0.6), rng.uniform(12.0, 40.0), int(rng.integers(2, 7))
    speed, corners = rng.uniform(15.0, 40.0), 120
    path = turns * sqrt((pi * diameter) ** 2 + height**2)
    section = (width - height) * height + 0.25 * pi * height**2
    angle = np.linspace(0.0, 2.0 * pi * turns, corners * turns + 1)
    radius = 0.5 * diameter / sqrt(sin(pi / corners) / (pi / corners) * cos(pi / corners))  # chords of the same area
    x, y, z = radius * np.cos(angle), radius * np.sin(angle), height * (1.0 + angle / (2.0 * pi))
    fed = section * path / (0.25 * pi * 1.75**2) / (len(angle) - 1)
    lines = [f"G1 X{x[0]:.5f} Y{y[0]:.5f} Z{z[0]:.5f} F6000", f"G1 F{60.0 * speed:.3f}"]
    lines += [f"G1 X{a:.5f} Y{b:.5f} Z{c:.5f} E{fed:.7f}" for a, b, c in zip(x[1:], y[1:], z[1:], strict=True)]
    cell = PRINTER.format(cell=max(width / 8.0, 0.15), width=width, height=height, filament=1.75)
    ran = run_texts("\n".join(["G21", "G90", "M83", *lines, "G1 Z60 F6000", ""]), cell)

    assert ran.stock.deposited * 1e9 == pytest.approx(section * path, rel=5e-3)
    told = ran.results.as_json()["tools"][0]
    assert told["laid_length_mm"] == pytest.approx(path, rel=5e-3)
    assert told["extruded_mm3"] == pytest.approx(section * path, rel=1e-4)


@pytest.mark.parametrize("seed", DRAWS)
def test_particles(seed: int) -> None:
    """All that the pump gives lies in a disc of distance · tan(angle / 2), a quarter of it within half of that."""
    rng = draw(seed, "rays")
    angle, above, seconds = rng.uniform(8.0, 40.0), rng.uniform(15.0, 35.0), rng.uniform(0.5, 2.0)
    spot = above * tan(radians(0.5 * angle))
    flow = rng.uniform(0.1, 0.3) * pi * spot**2 / seconds  # that high, so that nothing grows towards the nozzle
    cell = f"""
gcodesim: 1
machine: gantry_xyz
work_offsets: {{G54: {{in: world, xyz: [400, 300, -200]}}}}
stock: {{min: [-20, -20, -3], max: [20, 20, 0], in: G54, resolution: 0.25}}
tools:
  1: {{type: extruder, bead_width: 2, bead_height: 1, flow: {flow:.5f} mm^3/s, length: 40,
      rays: {{angle: {angle:.5f} deg, distance: 80 mm, number: 40, seed: {seed + 1}}}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
"""
    ran = run_texts(
        f"G21 G90 G61\nT1 M6\nG43 H1\nG0 X0 Y0\nG0 Z{above:.4f}\nM10\nG4 P{seconds:.3f}\nM11\nG0 Z60\nM2\n", cell
    )
    (placed,) = ran.shop.stocks.values()
    middles = np.arange(-20.0 + 0.125, 20.0, 0.25)
    heaps = np.array(
        [[max(0.0, max(h for _, h in placed.stock.intervals_at(x * 1e-3, y * 1e-3))) for y in middles] for x in middles]
    )
    away = np.hypot(*np.meshgrid(middles, middles, indexing="ij"))

    assert ran.stock.deposited * 1e9 == pytest.approx(flow * seconds, rel=5e-3)
    assert heaps.sum() * 1e3 * 0.25**2 == pytest.approx(flow * seconds, rel=6e-3)
    assert away[heaps > 0.0].max() <= spot + 1.0
    assert heaps[away < 0.5 * spot].sum() / heaps.sum() == pytest.approx(0.25, abs=0.06)


# ---- film

SPRAY = """
gcodesim: 1
machine: gantry_xyz
frames: {{table: {{in: world, xyz: [400, 300, -450]}}}}
work_offsets: {{G54: {{in: table}}}}
stock: {{min: [0, 0, -2], max: [300, 200, 0], in: table, resolution: 2, film: {{}}}}
tools:
  8: {{type: spray_gun, cone: {cone:.5f} deg, efficiency: {share:.5f}, solids: {solids:.5f}, distance: {far:.4f},
      flow: {flow:.5f} cm^3/s{more}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
"""


def film_on_top(ran: Ran) -> tuple[np.ndarray, np.ndarray]:
    """Middles (n, 3) and thickness (n,) of the film on the upper side of the panel [m]."""
    film = ran.shop.coated["stock/stock"].film
    assert film is not None
    here = film.coat.normal[:, 2] > 0.9
    return film.coat.middle[here], film.coat.dry[here]


@pytest.mark.parametrize("seed", DRAWS)
def test_overlap(seed: int) -> None:
    """Parallel passes add up their stripes: flow solids efficiency / (speed σ √(2 pi)) exp(-y² / 2σ²) each."""
    rng = draw(seed, "overlap")
    share, solids, flow = rng.uniform(0.3, 0.9), rng.uniform(0.2, 0.9), rng.uniform(0.5, 4.0)
    far, cone, speed = rng.uniform(120.0, 250.0), rng.uniform(14.0, 26.0), rng.uniform(200.0, 450.0)
    sigma = 0.5 * far * tan(radians(0.5 * cone))
    pitch = sigma * rng.uniform(1.0, 3.0)
    ways = [100.0 + (k - 2.5) * pitch for k in range(6)]
    lines = ["G21 G90 G61", "T8 M6", "G43 H8"]
    for way in ways:
        lines += [f"G0 X-110 Y{way:.4f} Z{far:.4f}", "M10", f"G1 X410 F{60 * speed:.3f}", "M11"]
    cell = SPRAY.format(cone=cone, share=share, solids=solids, far=far, flow=flow, more="")
    ran = run_texts("\n".join([*lines, "G0 Z300", "M2", ""]), cell)

    middle, dry = film_on_top(ran)
    here = np.abs(middle[:, 0] - 0.15) < 0.05
    stripes = np.array([np.exp(-0.5 * ((1e3 * middle[here, 1] - way) / sigma) ** 2) for way in ways]).sum(axis=0)
    expected = flow * 1e3 * solids * share / (speed * sigma * sqrt(2.0 * pi)) * stripes  # [mm]
    assert 1e3 * dry[here] == pytest.approx(expected, abs=4e-3 * expected.max())


@pytest.mark.parametrize("seed", DRAWS)
def test_a_cone_that_leans(seed: int) -> None:
    """A gun that stands: what goes into a solid angle lies on r² / cos(incidence) of the plane."""
    rng = draw(seed, "leans")
    lean, cone, far = rng.uniform(5.0, 35.0), rng.uniform(12.0, 20.0), rng.uniform(110.0, 160.0)
    flow, share, seconds = rng.uniform(0.5, 3.0), rng.uniform(0.3, 0.9), rng.uniform(0.5, 1.5)
    cell = SPRAY.format(cone=cone, share=share, solids=1.0, far=far, flow=flow, more="")
    cell = cell.replace("frames: {", f"frames: {{lean: {{in: table, xyz: [150, 100, 0], rpy: [0, {lean:.5f}, 0]}}, ")
    cell = cell.replace(
        "machine: gantry_xyz", "robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}"
    )
    cell = cell.replace("xyz: [400, 300, -450]", "xyz: [550, -100, 200]")
    cell = cell.replace("G54: {in: table}", "G54: {in: lean}")
    cell += "orientation: {tool_axis: -Z of lean}\n"
    text = f"G21 G90 G61\nT8 M6\nG43 H8\nG0 X0 Y0 Z{far:.4f}\nM10\nG4 P{seconds:.3f}\nM11\nG0 Z{far + 30:.3f}\nM2\n"
    ran = run_texts(text, cell)

    middle, dry = film_on_top(ran)
    axis = np.array([sin(radians(lean)), 0.0, cos(radians(lean))])  # from the plane to the gun
    nozzle = np.array([150.0, 100.0, 0.0]) + far * axis
    to = 1e3 * middle - nozzle
    distance = np.linalg.norm(to, axis=1)
    down = -to @ axis
    sideways = far * np.sqrt(np.maximum(distance**2 - down**2, 0.0)) / down  # on the plane across the axis at `far`
    sigma = 0.5 * far * tan(radians(0.5 * cone))
    across = np.exp(-0.5 * (sideways / sigma) ** 2) / (2.0 * pi * sigma**2)
    incidence = nozzle[2] / distance
    solid = across * far**2 / (down / distance) ** 3  # a share of the flow for each solid angle
    expected = flow * 1e3 * share * seconds * solid * incidence / distance**2
    assert 1e3 * dry == pytest.approx(expected, abs=0.01 * expected.max())


# ---- material that is removed at a distance

BEAMS = """
gcodesim: 1
machine: gantry_xyz
frames: {{table: {{in: world, xyz: [400, 300, -400]}}}}
work_offsets: {{G54: {{in: table}}}}
stock: {{min: [0, 10, -8], max: [60, 30, 0], in: table, material: al6082_t6, resolution: {cell:.9f}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
tools: {{1: {tool}}}
"""
KERF = "G21 G90 G61\nT1 M6\nG43 H1\nG0 X10 Y20 Z0\nM10\nG1 X50 F{feed:.4f}\nM11\nG0 Z20\nM2\n"


@pytest.mark.parametrize("seed", DRAWS)
def test_jet(seed: int) -> None:
    """Rate over width and feed is the mean depth across the kerf; rate times time is the volume."""
    rng = draw(seed, "jet")
    width, feed, depth = rng.uniform(0.6, 2.5), rng.uniform(2.0, 8.0), rng.uniform(0.4, 3.0)
    rate = depth * width * feed
    tool = f"{{type: jet, diameter: {width:.5f}, removal_rate: {rate:.6f} mm^3/s, length: 60}}"
    ran = run_texts(KERF.format(feed=60.0 * feed), BEAMS.format(cell=width / 16.0, tool=tool))

    assert not ran.bad
    assert ran.stock.removed * 1e9 == pytest.approx(rate * 40.0 / feed, rel=3e-3)
    y, tops = columns_across(ran, 30e-3)
    cell = float(np.diff(y).mean())
    assert -tops.sum() * cell * 1e6 == pytest.approx(depth * width, rel=5e-3)
    assert np.count_nonzero(tops < -1e-9) * cell * 1e3 == pytest.approx(width, abs=2.1e3 * cell)


@pytest.mark.parametrize("seed", DRAWS)
def test_gaussian_spot(seed: int) -> None:
    """√(2 / pi) A P / (w v e) exp(-2 y² / w²), with w half the diameter, is the groove of one way."""
    rng = draw(seed, "spot")
    diameter, power, taken = rng.uniform(0.6, 3.0), rng.uniform(20.0, 400.0), rng.uniform(0.2, 1.0)
    feed, deepest = rng.uniform(2.0, 10.0), rng.uniform(0.05, 0.5)
    w = 0.5 * diameter
    energy = sqrt(2.0 / pi) * taken * power / (w * feed * deepest)
    tool = (
        f"{{type: laser, diameter: {diameter:.5f}, power: {power:.5f} W, length: 60, absorptivity: {taken:.6f}, "
        f"specific_energy: {energy:.6f} J/mm^3}}"
    )
    ran = run_texts(KERF.format(feed=60.0 * feed), BEAMS.format(cell=diameter / 24.0, tool=tool))

    y, tops = columns_across(ran, 30e-3)
    expected = deepest * np.exp(-2.0 * ((1e3 * y - 20.0) / w) ** 2)
    assert -1e3 * tops == pytest.approx(expected, abs=0.015 * deepest)


@pytest.mark.parametrize("seed", DRAWS)
def test_balance_of_energy(seed: int) -> None:
    """The volume is what the material takes up, over what it takes to remove it."""
    rng = draw(seed, "energy")
    kind = rng.choice(["laser", "plasma"])
    diameter, power, taken = rng.uniform(0.8, 2.5), rng.uniform(50.0, 500.0), rng.uniform(0.2, 1.0)
    feed, energy = rng.uniform(3.0, 10.0), rng.uniform(20.0, 60.0)
    share = "absorptivity" if kind == "laser" else "efficiency"
    tool = (
        f"{{type: {kind}, diameter: {diameter:.5f}, power: {power:.5f} W, length: 60, {share}: {taken:.6f}, "
        f"specific_energy: {energy:.6f} J/mm^3}}"
    )
    ran = run_texts(KERF.format(feed=60.0 * feed), BEAMS.format(cell=diameter / 10.0, tool=tool))

    assert ran.stock.removed * 1e9 == pytest.approx(taken * power * 40.0 / feed / energy, rel=3e-3)
    assert ran.results.tools[0]["beam_energy_J"] == pytest.approx(power * 40.0 / feed, rel=3e-3)


LEANING = """
gcodesim: 1
robots: {{arm: {{model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}}}
frames: {{table: {{in: world, xyz: [650, 0, 300]}}, lean: {{in: table, xyz: [30, 20, 0], rpy: [{lean:.5f}, 0, 0]}}}}
work_offsets: {{G54: {{in: lean}}}}
orientation: {{tool_axis: -Z of lean}}
stock: {{min: [0, 5, -8], max: [60, 35, 0], in: table, material: al6082_t6, resolution: {cell:.9f}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
tools: {{1: {{type: jet, diameter: {width:.5f}, removal_rate: {rate:.6f} mm^3/s, length: 60}}}}
"""


@pytest.mark.parametrize("seed", DRAWS)
def test_oblique_jet(seed: int) -> None:
    """It takes what it would upright; so the depth straight down is less by the cosine, and the kerf is wider by it."""
    rng = draw(seed, "oblique")
    lean, width, feed, depth = (
        rng.uniform(5.0, 45.0),
        rng.uniform(1.0, 2.5),
        rng.uniform(3.0, 8.0),
        rng.uniform(0.4, 1.5),
    )
    rate = depth * width * feed
    text = f"G21 G90 G61\nT1 M6\nG43 H1\nG0 X-20 Y0 Z0\nM10\nG1 X20 F{60 * feed:.4f}\nM11\nG0 Z40\nM2\n"
    ran = run_texts(text, LEANING.format(lean=lean, cell=width / 16.0, width=width, rate=rate))

    assert ran.stock.removed * 1e9 == pytest.approx(rate * 40.0 / feed, rel=5e-3)
    y, tops = columns_across(ran, 30e-3)
    cell = float(np.diff(y).mean()) * 1e3
    assert np.count_nonzero(tops < -1e-9) * cell >= width / cos(radians(lean)) - 2.1 * cell
    (placed,) = ran.shop.stocks.values()
    full = 8.0 * len(y)
    left = sum(1e3 * (top - bottom) for each in y for bottom, top in placed.stock.intervals_at(30e-3, each))
    assert (full - left) * cell == pytest.approx(depth * width, rel=0.01)


# ---- grips

HAND = """
gcodesim: 1
machine:
  axes:
    X: {{travel: [0, 1000 mm], speed: 1 m/s, acceleration: {a:.6f} m/s^2}}
    Y: {{travel: [0, 600 mm], speed: 1 m/s, acceleration: {a:.6f} m/s^2}}
    Z: {{travel: [-600 mm, 0], speed: 1 m/s, acceleration: {a:.6f} m/s^2}}
frames: {{table: {{in: world, xyz: [400, 300, -500]}}}}
work_offsets: {{G54: {{in: table}}}}
m_codes: {{M62 P1: {{gripper: close}}, M63 P1: {{gripper: open}}}}
loaded_tool: 1
tools:
  1: {tool}
parts:
  block: {{box: [{side:.4f}, 40, 60], zero: bottom-center, mass: {mass:.6f} kg, in: table, xyz: [0, 0, 0],
      friction: {friction:.6f}}}
"""
LIFT = "G21 G90 G17 G94 G61.1\nG43 H1\nG0 Z100\nG0 X0 Y0\nG1 Z{at} F3000\nM62 P1\nG4 P0.1\nG1 Z150 F60000\nM2\n"


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("kind", ["fingers", "suction"])
@pytest.mark.parametrize("seed", DRAWS)
def test_grip(seed: int, kind: str, world: str) -> None:
    """2 mu N or dp A against m (g + a): 2 % more holds, 2 % less does not, and the force told is right."""
    rng = draw(seed, f"grip {kind}")
    mass, friction, a = rng.uniform(0.2, 6.0), rng.uniform(0.15, 0.9), rng.uniform(1.0, 8.0)
    load = mass * (G + a)
    side, across = rng.uniform(40.0, 50.0), rng.uniform(20.0, 38.0)  # the cup is on the part
    holding = load / (2.0 * friction) if kind == "fingers" else load / (0.25 * pi * (1e-3 * across) ** 2) * 1e-3

    def lifted(share: float) -> Ran:
        tool = (
            f"{{type: finger_gripper, stroke: 60, force: {share * holding:.6f} N, length: 120}}"
            if kind == "fingers"
            else f"{{type: suction_gripper, length: 100, vacuum: {share * holding:.6f} kPa, "
            f"cups: [{{diameter: {across:.6f}}}]}}"
        )
        cell = HAND.format(a=a, tool=tool, side=side, mass=mass, friction=friction)
        return run_texts(LIFT.format(at=40 if kind == "fingers" else 60), cell, world=world)

    strong, weak = lifted(1.02), lifted(0.98)
    assert not strong.bad
    assert strong.results.as_json()["parts"]["block"]["falls"] == 0
    assert weak.misuse == [("GS560", 8)]
    told = weak.bad[0].value
    assert told == pytest.approx(load / (2.0 * friction) if kind == "fingers" else load, rel=0.01)
    assert weak.results.as_json()["parts"]["block"]["falls"] == 1
