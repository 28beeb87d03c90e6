"""A machine with a rotary table: the stock turns with it, in whole runs."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from gcodesim.units import MM
from tests.physics.runs import Ran, height_at, run_texts

CELL = """
gcodesim: 1
machine:
  axes:
    X: {travel: [0, 400 mm], speed: 20 m/min}
    Y: {travel: [0, 300 mm], speed: 20 m/min}
    Z: {travel: [-300, 0 mm], speed: 20 m/min}
    C: {travel: unlimited, speed: 360 deg/s, side: table%s}
work_offsets: {G54: {in: world, xyz: [200, 150, -200]}}
stock: {min: [-20, -20, -10], max: [20, 20, 0], in: G54, material: al6082_t6, resolution: 0.25}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 3, length: 50}
simulation: {world: kinematic}
"""
PLACED = CELL % ", at: [200, 150, 0]"
HEAD = "G21 G90 G17 G94 G61\nT1 M6\nG43 H1\nS8000 M3\n"  # four lines
TAIL = "G0 Z30\nM5\nM2\n"


def depth(ran: Ran, x: float, y: float) -> float:
    """Height of the material at (x, y) [mm] of the stock's own frame, in mm."""
    return height_at(ran, x * MM, y * MM) / MM


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_indexing_between_two_slots(world: str) -> None:
    """The same slot from -X to the middle before and after a quarter turn: two arms of the stock are cut."""
    slot = "G0 X-30 Y0 Z10\nG0 Z-2\nG1 X0 F900\nG0 Z10\n"
    ran = run_texts(HEAD + slot + "G0 C90\n" + slot + TAIL, PLACED, world=world)
    assert not ran.bad
    # the table turns right-handed about Z, so the work passes the other way round under the tool
    assert depth(ran, -15, 0) == pytest.approx(-2.0, abs=1e-6)
    assert depth(ran, 0, 15) == pytest.approx(-2.0, abs=1e-6)
    assert depth(ran, 15, 0) == pytest.approx(0.0, abs=1e-6)
    assert depth(ran, 0, -15) == pytest.approx(0.0, abs=1e-6)
    # each arm 20 x 6 and half a round end; what both have in common: a quarter of the square and the round ends
    arm = 20.0 * 6.0 + 0.5 * pi * 9.0
    common = 9.0 + 0.25 * pi * 9.0 * 3.0
    assert ran.stock.removed * 1e9 == pytest.approx(2.0 * (2.0 * arm - common), rel=0.01)


def test_a_ring_is_cut_by_turning_the_table() -> None:
    """The tool stands at radius 12 mm, the table makes a full turn: a ring as wide as the tool."""
    program = HEAD + "G0 X12 Y0 Z5\nG1 Z-3 F300\nG93 G1 C360 F6\nG94\n" + TAIL
    ran = run_texts(program, PLACED)
    want = pi * (15.0**2 - 9.0**2) * 3.0
    assert not ran.bad
    assert ran.stock.removed * 1e9 == pytest.approx(want, rel=0.01)
    angles = np.radians(np.arange(0, 360, 30))
    assert [depth(ran, 12 * np.cos(a), 12 * np.sin(a)) for a in angles] == pytest.approx([-3.0] * 12, abs=1e-6)


def test_an_axis_of_unknown_place_gives_time_only() -> None:
    """Without `at`: indexing in the air is fine, turning in the cut is a finding in its line."""
    blind = CELL % ""
    slot = "G0 X-30 Y0 Z10\nG0 Z-2\nG1 X0 F900\nG0 Z10\n"
    assert not run_texts(HEAD + slot + "G0 C90\n" + TAIL, blind).bad
    turning = HEAD + "G0 X-30 Y0 Z10\nG0 Z-2\nG1 X0 F900\nG93 G1 X5 C45 F20\nG1 X10 C90 F20\nG94\n" + TAIL
    ran = run_texts(turning, blind)
    assert ran.misuse == [("GS407", 8)]
    assert "axis C" in ran.bad[0].message


def leaning_slot(angle: float) -> float:
    """Volume [mm³] that a flat end mill of 6 mm takes of the stock, which leans by `angle` [deg] about its middle.

    Points of the stock, 0.2 mm apart, against the slot from its side up to x = 10, 2 mm below the middle of the top.
    """
    x, y, z = np.meshgrid(
        np.arange(-19.9, 20.0, 0.2), np.arange(-19.9, 20.0, 0.2), np.arange(-4.9, 5.0, 0.2), indexing="ij"
    )
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    across, up = c * y - s * z, s * y + c * z
    beyond = np.maximum(x - 10.0, 0.0)
    return float(((up >= 3.0) & (across**2 + beyond**2 <= 9.0)).sum() * 0.2**3)


@pytest.mark.parametrize("angle", [20, -35])
def test_a_tool_that_leans_cuts_what_it_sweeps(angle: int) -> None:
    """A table turned about X leans the stock."""
    cell = PLACED.replace("C: {", "A: {").replace("at: [200, 150, 0]", "at: [200, 150, -205]")
    ran = run_texts(HEAD + f"G0 X-30 Y0 Z30\nG0 A{angle}\nG0 Z-2\nG1 X10 F900\nG0 Z30\nM5\nM2\n", cell)

    assert ran.misuse == []
    assert ran.stock.removed * 1e9 == pytest.approx(leaning_slot(angle), rel=0.01)
    assert ran.stock.removed + ran.stock.remaining == pytest.approx(40e-3 * 40e-3 * 10e-3, rel=1e-9)
    assert ran.stock.error_bound < 0.1 * ran.stock.removed
