"""External axes of a machine tool: a rotary table that is set onto it is moved by its letters and carries the work."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.shop import PlacedStock
from gcodesim.simulation import Options, prepare
from tests.physics.runs import run_texts

MM = 1e-3
LINEAR = """
    X: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Y: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Z: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2, home: 250 mm}"""
TURNS = """
      A: {travel: [-100, 100 deg], speed: 180 deg/s, acceleration: 900 deg/s^2%s}
      C: {travel: unlimited, speed: 360 deg/s, acceleration: 1800 deg/s^2%s}"""
TOOLS = "tools:\n  1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}\n"
BUILT_IN = f"""gcodesim: 1
machine:
  axes:{LINEAR}{TURNS.replace("      ", "    ") % (", at: [20, 0, -120 mm]", ", at: [20, 0, -120 mm]")}
work_offsets: {{G54: {{xyz: [20, 0, -100 mm]}}}}
{TOOLS}"""
SET_ON = f"""gcodesim: 1
machine:
  axes:{LINEAR}
externals:
  trunnion:
    base: {{in: machine, xyz: [20, 0, -120 mm]}}
    axes:{TURNS % ("", "")}
work_offsets: {{G54: {{in: trunnion, xyz: [0, 0, 20 mm]}}}}
{TOOLS}"""
FIVE_AXES = "G21 G90 G54\nT1 M6\nM428\nG0 X0 Y0 Z30\nG1 X15 Z5 A30 C40 F2000\nG1 Y12 A-20 C-75\nM429\nG0 A0 C0\nM2\n"
ROUTER = """gcodesim: 1
machine: gantry_xyz
externals:
  rotary:
    axes: {A: {travel: unlimited, speed: 90 deg/s, acceleration: 300 deg/s^2}}
    base: {in: world, xyz: [300, 200, -250]}
work_offsets: {G54: {in: rotary}}
stock: {cylinder: [40, 40], in: rotary, xyz: [-20, 0, 0], rpy: [0, 90, 0], material: al6082_t6, resolution: 0.5}
fixtures: {vise: {box: [50, 50, 50], in: world, xyz: [500, 300, -300]}}
tools: {1: {type: flat_end_mill, diameter: 8, flutes: 2, length: 60}}
simulation: {world: kinematic}
"""
GROOVE = "G21 G90 G54\nT1 M6 G43\nS8000 M3\nG0 X0 Y0 Z30 A0\nG1 Z19 F600\nG1 A360 F3600\nG0 Z30\nM5\nM2\n"


def joints(program: str, cell: str) -> np.ndarray:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.nc", program.encode()), loaded, Options(world="kinematic"))
    assert job.plan is not None and not [f.message for f in job.findings if f.code.startswith("GS2")]
    return job.plan.joints(job.plan.trajectory.sample(np.arange(0.0, job.plan.trajectory.duration, 0.01)))


def test_a_trunnion_that_is_set_on_is_one_that_is_built_in() -> None:
    built_in, set_on = joints(FIVE_AXES, BUILT_IN), joints(FIVE_AXES, SET_ON)
    assert built_in.shape == set_on.shape
    assert np.abs(built_in - set_on).max() < 1e-12


def test_a_groove_around_a_bar_on_a_rotary_table_and_a_vise_that_stays() -> None:
    ran = run_texts(GROOVE, ROUTER)
    ring = pi * (20.0**2 - 19.0**2) * 8.0 * MM**3

    assert ran.stock.removed == pytest.approx(ring, rel=0.02)
    assert not ran.shop.scene.moves("fixture/vise")
    assert ran.shop.scene.moves("stock/stock")
    assert ran.shop.joint_names[-1] == "machine/A"


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (", acceleration: 300 deg/s^2}}", "}, U: {travel: [0, 1 m], speed: 1 m/s}}", 5),
        ("machine: gantry_xyz", "machine: mill_xyzac_trunnion", 5),
        ("    base:", "    free: true\n    base:", 5),
        ("    base:", "    carries: machine\n    base:", 6),
        ("    base:", "    robot: machina\n    base:", 6),
        ("  rotary:\n", "  link_X:\n", 4),
    ],
)
def test_where_an_external_axis_makes_no_sense_on_a_machine_tool(old: str, new: str, line: int) -> None:
    loaded = read_cell(SourceText("cell.yaml", ROUTER.replace(old, new).encode()), Path("cell.yaml"))
    found = [f.span.line for f in loaded.findings if f.code in ("GS719", "GS712") and f.span.line in (4, 5, 6)]
    assert found[:1] == [line]
    assert loaded.cell is None


def test_the_work_stands_on_one_table() -> None:
    twice = ROUTER.replace("externals:\n", "externals:\n  other: {axes: {B: {travel: unlimited, speed: 9 deg/s}}}\n")
    loaded = read_cell(SourceText("cell.yaml", twice.encode()), Path("cell.yaml"))
    assert "the work of a machine tool stands on one table" in next(iter(loaded.findings)).message


WRAPPED = """G21 G90 G54
T1 M6 G43
G0 X0 Y0 Z30 A0
G0 Z20
M62 P0
G1 A360 F1200
M63 P0
G0 Z30
M2
"""
BEAMS = {
    "jet": "{type: jet, diameter: 2, removal_rate: 20 mm^3/s, length: 60}",
    "laser": "{type: laser, diameter: 2, power: 100 W, specific_energy: 5 J/mm^3, absorptivity: 1, length: 60}",
}


@pytest.mark.parametrize("tool", BEAMS)
def test_a_beam_goes_around_a_bar_as_deep_everywhere(tool: str) -> None:
    """20 mm³/s for 18 s, and 20/300 s to gather way: as much from each sector, whichever way columns lie there."""
    cell = ROUTER.replace("{type: flat_end_mill, diameter: 8, flutes: 2, length: 60}", BEAMS[tool])
    ran = run_texts(WRAPPED, cell + "signals: {beam: {word: M62 P0}}\n")
    (placed,) = ran.shop.stocks.values()
    angle, volume = sectors_of_what_is_gone(placed)

    assert ran.misuse == []
    whole = 20.0 * (18.0 + 20.0 / 300.0) * MM**3
    assert ran.stock.removed == pytest.approx(whole, rel=1e-3)
    assert volume.sum() == pytest.approx(whole, rel=0.01)
    for middle in range(0, 360, 30):
        own = volume[np.abs((angle - middle + 180.0) % 360.0 - 180.0) < 15.0].sum()
        assert own == pytest.approx(30.0 * MM**3, rel=0.06), middle


def _within(z: np.ndarray, intervals: Iterable[tuple[float, float]]) -> np.ndarray:
    """Whether each height is in one of the intervals."""
    return np.array([(z >= low) & (z < high) for low, high in intervals]).any(axis=0) | np.zeros(len(z), dtype=bool)


def sectors_of_what_is_gone(placed: PlacedStock) -> tuple[np.ndarray, np.ndarray]:
    """Angles [deg] about the bar, from the top on, of bits that were cut, with their volumes [m³]."""
    stock, step = placed.stock, 0.02 * MM
    z = np.arange(-20 * MM + 0.5 * step, 20 * MM, step)
    (low, _), (dx, dy) = stock.bounds, stock.spacing
    found = []
    for i, j in np.argwhere(stock.original.number > 0):
        x, y = low[0] + (i + 0.5) * dx, low[1] + (j + 0.5) * dy
        was = zip(*(side[i, j, : stock.original.number[i, j]] for side in stock.original[:2]), strict=True)
        gone = z[_within(z, was) & ~_within(z, stock.intervals_at(x, y))]
        found.append(np.stack([np.full(len(gone), y), gone]))
    across, up = np.concatenate(found, axis=1)
    return np.degrees(np.arctan2(across, up)), np.full(len(up), dx * dy * step)
