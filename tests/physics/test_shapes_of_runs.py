"""Where whole runs lay, spray and burn, against sums of their own: a spiral wall, a leaning cone, a Gaussian spot."""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt, tan
from pathlib import Path

import numpy as np
import pytest

from tests.physics.runs import run_texts

MACHINE = """
gcodesim: 1
machine: gantry_xyz
work_offsets: {G54: {in: world, xyz: [400, 300, -300]}}
m_codes: {M10: {tool: activate}, M11: {tool: deactivate}}
"""


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
@pytest.mark.parametrize("flow", ["", ", flow: 321.3717 mm^3/s"])
def test_a_spiral_wall_has_the_volume_of_its_helix(world: str, flow: str) -> None:
    """A level turn and three that rise: section times helix, all of it in the stock or told as without room."""
    radius, width, height, turns = 20.0, 6.0, 3.0, 3
    cell = MACHINE + (
        "stock: {min: [-30, -30, -5], max: [30, 30, 0], in: G54, resolution: 0.5}\n"
        f"tools: {{1: {{type: extruder, bead_width: {width}, bead_height: {height}, length: 40{flow}}}}}\n"
    )
    rising = "".join(f"G3 X{radius} Y0 I-{radius} J0 Z{height * (k + 2)}\n" for k in range(turns))
    program = f"G21 G90 G17 G61\nT1 M6\nG43 H1\nG0 X{radius} Y0 Z{height}\nM10\nG1 F1200\n"
    ran = run_texts(f"{program}G3 X{radius} Y0 I-{radius} J0\n{rising}M11\nG0 Z60\nM2\n", cell, world=world)
    (tool,) = ran.results.tools

    area = (width - height) * height + 0.25 * pi * height**2
    path = 2 * pi * radius + turns * sqrt((2 * pi * radius) ** 2 + height**2)
    deposited = ran.stock.deposited * 1e9
    assert deposited + tool["crowded_out_mm3"] == pytest.approx(area * path, rel=5e-3)
    assert ran.stock.remaining - ran.stock.initial == pytest.approx(ran.stock.deposited, rel=1e-9)
    if flow:  # goes where there is room
        assert not ran.bad and tool["crowded_out_mm3"] == 0.0
    else:  # where the spiral begins to rise, half a turn of the bead below is in the way
        assert ran.misuse == [("GS523", 8)]
        assert tool["crowded_out_mm3"] == pytest.approx(0.5 * 2 * pi * radius * area, rel=0.15)


def test_a_gun_that_leans_lays_its_cone_where_rays_meet_the_plane() -> None:
    """Film at each place: the round spot of the cone, seen along the ray, on a plane that leans by 35 degrees."""
    lean, away, half, flow = 35.0, 200.0, 12.5, 2e3  # [deg, mm, deg, mm³/s]
    cell = f"""
gcodesim: 1
robots: {{arm: {{model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}}}
frames: {{table: {{in: world, xyz: [650, 0, 200]}}, lean: {{in: table, rpy: [{lean}, 0, 0]}}}}
work_offsets: {{G54: {{in: lean}}}}
orientation: {{tool_axis: -Z of lean}}
stock: {{min: [-150, -200, -4], max: [150, 200, 0], in: table, resolution: 4, film: {{}}}}
m_codes: {{M10: {{tool: activate}}, M11: {{tool: deactivate}}}}
tools: {{1: {{type: spray_gun, cone: {2 * half} deg, efficiency: 1, distance: {away}, flow: 2 cm^3/s}}}}
"""
    program = f"G21 G90 G61\nT1 M6\nG43 H1\nG0 X0 Y0 Z{away + 20}\nG0 Z{away}\nM10\nG4 P1\nM11\nG0 Z{away + 20}\nM2\n"
    ran = run_texts(program, cell)
    coat = ran.shop.coated["stock/stock"].film.coat
    here = coat.normal[:, 2] > 0.9
    p, dry = coat.middle[here] * 1e3, coat.dry[here] * 1e3

    axis = np.array([0.0, sin(radians(lean)), -cos(radians(lean))])  # `lean` turns about X
    ray = p + away * axis  # from the nozzle, which stands `away` up the axis, to each place
    depth = ray @ axis
    beside = np.linalg.norm(ray - depth[:, None] * axis, axis=1)
    sigma = 0.5 * depth * tan(radians(half))
    density = np.exp(-0.5 * (beside / sigma) ** 2) / (2 * pi * sigma**2) * -ray[:, 2] / depth
    inside = beside < 0.9 * depth * tan(radians(half))
    time = ran.results.tools[0]["sprayed_mm3"] / flow
    expected = flow * time * density
    assert dry[inside] == pytest.approx(expected[inside], abs=0.01 * expected.max())


def test_a_laser_leaves_the_dose_of_a_gaussian_spot(tmp_path: Path) -> None:
    """Across a track the map is the spot added up along it, and all of it is power times time."""
    power, radius, feed, cell_size = 60.0, 1.2, 10.0, 0.25  # [W, mm, mm/s, mm]
    cell = MACHINE + (
        f"stock: {{min: [0, 0, -6], max: [40, 20, 0], in: G54, resolution: {cell_size}}}\n"
        f"tools: {{1: {{type: laser, diameter: {2 * radius}, power: {power} W, length: 60, threshold: 1000 J/mm^2, "
        "absorptivity: 0.5, rayleigh: 10 m}}\n"
    )
    program = f"G21 G90 G61\nT1 M6\nG43 H1\nG0 X10 Y10 Z0\nM10\nG1 X30 F{60 * feed}\nM11\nG0 Z20\nM2\n"
    ran = run_texts(program, cell, tmp_path)
    dose = np.load(tmp_path / "stock.fluence.npy")

    y = (np.arange(dose.shape[0]) + 0.5) * cell_size - 10.0
    profile = (
        sqrt(2 / pi) * power / (radius * feed) * np.exp(-2 * (y / radius) ** 2)
    )  # the spot in the middle of a cell
    near = np.abs(y) < 1.5 * radius
    assert not ran.bad
    assert dose[near, dose.shape[1] // 2] == pytest.approx(profile[near], rel=0.03)
    assert dose.sum() * cell_size**2 == pytest.approx(power * 20.0 / feed, rel=0.01)
