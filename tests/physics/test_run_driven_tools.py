"""Driven tools on a lathe with a C axis: volumes in closed form, and what was turned keeps its own."""

from __future__ import annotations

from math import acos, cos, pi, sin, sqrt

import numpy as np
import pytest

from tests.physics.runs import run_texts

HEAD = "G21 G90 G94 G18 G8 G40\n"
TOOLS = (
    "  1: {type: turning_tool}\n"
    "  2: {type: flat_end_mill, diameter: 8, length: 60, driven: true, tcp: {xyz: [-60, 0, 0], rpy: [0, -90, 0]}}\n"
    "  3: {type: flat_end_mill, diameter: 20, length: 60, driven: true, tcp: {xyz: [-60, 0, 0], rpy: [0, -90, 0]}}\n"
    "  4: {type: flat_end_mill, diameter: 6, length: 60, driven: true}\n"
)
BAR = pi * 20.0**2 * 50.0


def run(program: str, more: str = "", tools: str = TOOLS, head: str = HEAD, dialect: str = "linuxcnc"):
    stock = f"{{cylinder: [40, 50], xyz: [0, 0, -50], resolution: 0.2{more}}}"
    cell = f"gcodesim: 1\nmachine: lathe_xyzc\ndialect: {dialect}\nstock: {stock}\n"
    cell += f"tools:\n{tools}simulation: {{world: kinematic}}\n"
    ran = run_texts(head + program, cell)
    assert ran.results.status == "ok", [f.message for f in ran.results.findings]
    return ran


def taken(ran) -> float:
    """What is missing of the bar [mm³]; it and what is told as removed are the same."""
    stock = ran.results.stocks["stock"].as_json()
    left = stock["remaining_mm3"] + stock["in_chuck_mm3"] + stock["scrap_mm3"]
    assert BAR - left == pytest.approx(stock["removed_mm3"], abs=1e-3)
    return BAR - left


def bound(ran) -> float:
    return float(ran.results.stocks["stock"].as_json()["error_bound_mm3"])


def cross_hole(bar: float, hole: float) -> float:
    """Volume of a hole right through the axis of a bar, both radii [mm]: the integral over the hole's section."""
    y = hole * ((np.arange(20_000) + 0.5) / 10_000 - 1.0)
    return float((4.0 * np.sqrt(hole**2 - y**2) * np.sqrt(bar**2 - y**2)).mean() * 2.0 * hole)


def test_a_cross_hole() -> None:
    ran = run("T2 M6 G43\nS3000 M3\nG0 X30 Z-20\nG1 X-25 F300\nG0 X30\nM5\nM2\n")

    exact = cross_hole(20.0, 4.0)
    assert taken(ran) == pytest.approx(exact, rel=1e-3)
    assert abs(taken(ran) - exact) < bound(ran) < 0.005 * exact


def test_a_hexagon_by_indexing() -> None:
    """Six flats 17.5 mm from the axis, from beyond the end up to where the mill stops with its round side."""
    indexed = "".join(f"G0 Z15\nC{60 * k}\nX17.5\nG1 Z-8 F600\nG0 X30\n" for k in range(6))
    ran = run(f"T3 M6 G43\nS3000 M3\nG0 X30 Z15\n{indexed}M5\nM2\n")

    half = sqrt(20.0**2 - 17.5**2)
    y = half * ((np.arange(20_000) + 0.5) / 10_000 - 1.0)
    section = np.sqrt(20.0**2 - y**2) - 17.5
    exact = 6.0 * float((section * (8.0 + np.sqrt(10.0**2 - y**2))).mean() * 2.0 * half)
    assert taken(ran) == pytest.approx(exact, rel=5e-3)
    assert abs(taken(ran) - exact) < bound(ran)


def test_a_slot_in_the_face_by_turning_the_work() -> None:
    """A quarter of a ring, 12 mm from the axis, 3 mm deep, with both round ends."""
    ran = run("T4 M6 G43\nS4000 M3\nG0 X12 Z5\nG1 Z-3 F200\nG1 C90 F2000\nG0 Z5\nM5\nM2\n")

    exact = 3.0 * (0.5 * pi * 12.0 * 6.0 + pi * 3.0**2)
    assert taken(ran) == pytest.approx(exact, rel=2e-3)
    assert abs(taken(ran) - exact) < bound(ran)


def test_what_was_turned_keeps_its_volume() -> None:
    """First turned to 30 mm, then drilled across, then turned to 28 mm, which meets the hole."""
    turn = "T1 M6 G43\nG97 S1000 M3\nG0 X{0} Z2\nG1 Z-30 F200\nX22\nG0 Z5\n"
    hole = "T2 M6 G43\nS3000 M3\nG0 X30 Z-15\nG1 X-25 F300\nG0 X30\nG0 Z5\n"
    ran = run(turn.format(15) + hole + turn.format(14) + "M5\nM2\n")

    ring = pi * (20.0**2 - 14.0**2) * 30.0
    assert taken(ran) == pytest.approx(ring + cross_hole(14.0, 4.0), rel=2e-4)
    assert ran.results.stocks["stock"].turned.profiles[0][:, 1].max() == pytest.approx(0.02)


def test_a_turning_cut_is_steady_so_its_peak_is_its_force() -> None:
    material = ", material: al6082_t6"
    ran = run("T1 M6 G43\nG97 S1000 M3\nG95 F0.2\nG0 X18.5 Z2\nG1 Z-5\nG0 X30\nM5\nM2\n", material)

    turned = {tool["number"]: tool for tool in ran.results.as_json()["tools"]}[1]
    assert turned["max_force_N"] > 100.0
    assert turned["max_peak_force_N"] == turned["max_force_N"]
    assert turned["max_peak_torque_Nm"] == turned["max_torque_Nm"] > 1.0


def test_a_part_is_parted_off_with_its_hole() -> None:
    hole = "T2 M6 G43\nS3000 M3\nG0 X30 Z-10\nG1 X-25 F300\nG0 X30\n"
    part = "T5 M6 G43\nG97 S800 M3\nG0 X22 Z-23\nG1 X-0.1 F100\nG0 X30\nM5\nM2\n"
    ran = run(hole + part, tools=TOOLS + "  5: {type: parting_tool, width: 3}\n")

    stock = ran.results.stocks["stock"].as_json()
    assert stock["parted_off"]
    lengths = stock["profiles_z_r_mm"][0]
    length = max(z for z, _ in lengths) - min(z for z, _ in lengths)
    assert stock["remaining_mm3"] == pytest.approx(pi * 400.0 * length - cross_hole(20.0, 4.0), rel=2e-4)
    assert stock["in_chuck_mm3"] > 0.3 * BAR


def test_a_mill_that_is_not_driven_cuts_nothing_and_says_so() -> None:
    standing = TOOLS.replace("driven: true, ", "")
    ran = run("T2 M6 G43\nS3000 M3\nG0 X30 Z-20\nG1 X-25 F300\nG0 X30\nM5\nM2\n", tools=standing)

    assert taken(ran) == pytest.approx(0.0, abs=1e-3)
    hints = [f.hint for f in ran.results.findings if f.code == "GS435"]
    assert hints and all("driven: true" in hint for hint in hints)


def test_the_segment_of_a_flat_is_that_of_the_books() -> None:
    """The section that `test_a_hexagon_by_indexing` sums, in closed form."""
    half = sqrt(20.0**2 - 17.5**2)
    y = half * ((np.arange(20_000) + 0.5) / 10_000 - 1.0)
    summed = float((np.sqrt(20.0**2 - y**2) - 17.5).mean() * 2.0 * half)
    assert summed == pytest.approx(20.0**2 * acos(17.5 / 20.0) - 17.5 * half, rel=1e-6)


def test_a_rapid_across_the_spindle_is_told_and_one_along_what_is_cut_is_not() -> None:
    """A shallow flat by G0: how deep a tool is counts along its own axis, not along that of the stock."""
    stock = "{cylinder: [40, 50], xyz: [0, 0, -50], resolution: 0.5}"
    cell = f"gcodesim: 1\nmachine: lathe_xyzc\nstock: {stock}\ntools:\n{TOOLS}simulation: {{world: kinematic}}\n"
    way = "T3 M6 G43\nS3000 M3\nG0 X30 Z15\nX18.5\n{}G0 Z15\nG0 Z-8\nX30\nM5\nM2\n"
    wrong = run_texts(HEAD + way.format("G0 Z-8\n"), cell).results.findings
    right = run_texts(HEAD + way.format("G1 Z-8 F600\n"), cell).results.findings

    assert [(f.code, f.span.line) for f in wrong if f.code == "GS401"] == [("GS401", 6)]
    assert [f for f in right if f.code == "GS401"] == []


@pytest.mark.parametrize("code", ["G12.1", "G112"])
def test_a_hexagon_in_polar_coordinates(code: str) -> None:
    """26 mm across flats, 4 mm deep: X is a diameter and C a length; the mill goes all round outside of it."""
    corner = 2.0 * 13.0 / sqrt(3.0)
    tools = "  2: {type: flat_end_mill, diameter: 14, length: 60, driven: true}\n"
    around = "".join(f"X{2 * corner * cos(pi * k / 3):.4f} C{corner * sin(pi * k / 3):.4f}\n" for k in range(7))
    start = "T0202\nS4000 M3\nG0 X64. Z5.\nG1 Z-4. F900.\n"
    program = f"{start}{code}\nG42 G1 {around}X20. C8.6603\nG40 X64. C0.\nG13.1\nM5\nM30\n"
    ran = run(program, tools=tools, head="G21 G18 G40 G97 G98\n", dialect="fanuc_lathe")

    exact = 4.0 * (pi * 20.0**2 - 2.0 * sqrt(3.0) * 13.0**2)
    assert taken(ran) == pytest.approx(exact, rel=2e-3)
    assert abs(taken(ran) - exact) < bound(ran)
