"""Whole turning programs: volumes in closed form, forces by Kienzle, times of G96, gouges and collisions."""

from __future__ import annotations

import json
from math import cos, pi, radians, sin, tan
from pathlib import Path

import numpy as np
import pytest

from tests.physics.runs import run_texts

DATA = Path(__file__).parents[1] / "data" / "turning"
CASES = {case["name"]: case for case in json.loads((DATA / "cases.json").read_text())}
HEAD = "G21 G18 G7 G90 G40 G49\nT1 M6 G43\n"


def cell_of(stock: str, tools: str = "1: {type: turning_tool}", more: str = "") -> str:
    head = f"gcodesim: 1\nmachine: lathe_xz\nstock: {{{stock}}}\ntools:\n  {tools}\n"
    return f"{head}{more}simulation: {{world: kinematic, rate: 100 Hz}}\n"


def codes(ran) -> set[str]:
    return {finding.code for finding in ran.results.findings}


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_finished_part_has_its_volume(name: str) -> None:
    case = CASES[name]
    bar = case["stock"]["cylinder_mm"]
    tools = "\n  ".join(f"{k}: {{type: {tool['type'].replace(' ', '_')}}}" for k, tool in case["tools"].items())
    size = f"cylinder: [{bar['diameter']}, {bar['z'][1] - bar['z'][0]}], xyz: [0, 0, {bar['z'][0]}]"

    dialect = "dialect: fanuc_lathe\n" if case["dialect"] == "fanuc" else ""

    ran = run_texts((DATA / case["program"]).read_text(), cell_of(size, tools, dialect))

    stock = ran.results.stocks["stock"].as_json()
    assert stock["remaining_mm3"] == pytest.approx(case["expect"]["remaining_volume_mm3"], rel=5e-4)
    whole = stock["removed_mm3"] + stock["remaining_mm3"] + stock["in_chuck_mm3"] + stock["scrap_mm3"]
    assert whole == pytest.approx(case["stock"]["volume_mm3"], rel=1e-6)
    assert not {code for code in codes(ran) if code.startswith("GS4")}


def test_forces_of_longitudinal_turning_are_those_of_kienzle() -> None:
    """kc11 1700 N/mm², mc 0.25, depth 2 mm, feed 0.2 mm, lead angle 95 and 45 deg: h = f sin k, b = a / sin k."""
    for lead in (95.0, 60.0):
        tool = f"1: {{type: turning_tool, tip_angle: 55, lead_angle: {lead}, edge: 20}}"
        material = "materials:\n  mine: {kc11: 1700 N/mm^2, mc: 0.25, normal_ratio: 0.4, axial_ratio: 0}\n"
        ran = run_texts(
            HEAD + "G97 S1000 M3\nG95 F0.2\nG0 X36 Z2\nG1 Z-20\nG0 X50\nM5\nM2\n",
            cell_of("cylinder: [40, 50], xyz: [0, 0, -50], material: mine", tool, material),
        )

        h, b = 0.2 * sin(radians(lead)), 2.0 / sin(radians(lead))
        main = 1700.0 * h**0.75 * b
        rows = ran.execution.rows
        assert rows["main_force"].max() == pytest.approx(main, rel=0.01)
        assert rows["feeding_force"].max() == pytest.approx(0.4 * main * sin(radians(lead)), rel=0.02)
        assert rows["torque"].max() == pytest.approx(main * 0.019, rel=0.02)
        assert rows["power"].max() == pytest.approx(main * 0.019 * 2.0 * pi * 1000.0 / 60.0, rel=0.02)


def test_facing_at_a_constant_cutting_speed_takes_the_time_of_the_integral() -> None:
    """G96 S200 m/min with at most 2000 rpm, feed 0.2 mm a turn, from X60 to X0."""
    ran = run_texts(
        HEAD + "G96 S200 D2000 M3\nG95 F0.2\nG0 X60 Z2\nZ-1\nG1 X0\nG0 Z5\nM5\nM2\n",
        cell_of("cylinder: [50, 40], xyz: [0, 0, -40]"),
    )

    knee = 200e3 / (2.0 * pi * 2000.0)  # mm, radius at which the cap is reached
    turns = pi * (30.0**2 - knee**2) / 200e3 + knee / 2000.0  # min per mm, along the radius
    assert ran.results.times.feed == pytest.approx(60.0 * turns / 0.2, rel=0.01)


def test_the_back_edge_of_a_wide_insert_gouges_on_a_steep_slope() -> None:
    """Down a slope of 30 deg: a tip of 80 deg at a lead of 95 leaves 5 deg behind, one of 35 deg 52."""
    program = HEAD + "G97 S1000 M3\nG95 F0.1\nG0 X36 Z2\nG1 Z-10\nX24 Z-20.392\nZ-25\nG0 X60\nM5\nM2\n"
    found = {}
    for insert in ("CNMG120404", "VBMT160404"):
        tool = f"1: {{type: turning_tool, insert: {insert}}}"
        found[insert] = run_texts(program, cell_of("cylinder: [40, 60], xyz: [0, 0, -60]", tool))

    gouges = [f for f in found["CNMG120404"].results.findings if f.code == "GS431"]
    assert [f.span.line for f in gouges] == [7]
    assert "GS431" not in codes(found["VBMT160404"])


def test_what_a_back_edge_takes_is_what_lies_between_its_way_and_that_of_the_tip() -> None:
    """A sharp tip falls by 31 deg; by Pappus, the parallelogram of back edge and way, less what is air before."""
    program = HEAD + "G97 S1000 M3\nG95 F0.2\nG0 X36 Z2\nG1 Z-10\nX24 Z-20\nG0 X60\nM5\nM2\n"
    tool = "1: {type: turning_tool, nose_radius: 0, tip_angle: 80 deg, lead_angle: 95 deg, edge: 9 mm}"
    ran = run_texts(program, cell_of("cylinder: [40, 60], xyz: [0, 0, -60]", tool))

    tip = np.array([[-10.0, 18.0], [-20.0, 12.0]])
    edge = 9.0 * np.array([cos(radians(5.0)), sin(radians(5.0))])
    corners = np.array([tip[0], tip[1], tip[1] + edge, tip[0] + edge])
    z, r = np.meshgrid(np.arange(-20.0, 0.0, 0.01) + 0.005, np.arange(12.0, 18.0, 0.01) + 0.005, indexing="ij")
    within = np.ones(z.shape, dtype=bool)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        within &= (b[0] - a[0]) * (r - a[1]) >= (b[1] - a[1]) * (z - a[0])
    wanted = 2.0 * pi * float(r[within].sum()) * 1e-4

    gouges = [f for f in ran.results.findings if f.code == "GS431"]
    assert [f.span.line for f in gouges] == [7]
    assert gouges[0].value == pytest.approx(wanted, rel=0.02)


def test_tools_in_the_chuck_and_shanks_in_the_work_are_found() -> None:
    stock = "cylinder: [40, 60], xyz: [0, 0, -60], chuck: {diameter: 100, grip: 20}"
    near = HEAD + "G97 S1000 M3\nG95 F0.2\nG0 X38 Z2\nG1 Z-39.9\nG0 X60\nM5\nM2\n"
    deep = near.replace("Z-39.9", "Z-41")
    bore = "1: {type: boring_tool, width: 16}"
    tight = HEAD + "G97 S1000 M3\nG95 F0.2\nG0 X11 Z2\nG1 Z-20\nG0 X10\nZ5\nM5\nM2\n"

    assert "GS433" not in codes(run_texts(near, cell_of(stock)))
    assert [f.span.line for f in run_texts(deep, cell_of(stock)).results.findings if f.code == "GS433"] == [6]
    tube = "cylinder: [40, 60], bore: 10, xyz: [0, 0, -60]"
    assert "GS432" in codes(run_texts(tight, cell_of(tube, bore)))


def test_a_thread_is_told_beside_the_body_of_revolution() -> None:
    """M20 x 1.5, 0.92 mm deep from the face to the relief at Z-22: a triangle of 60 deg on its helix.

    The section at one mark of the spindle has one groove more or less at an end: 1 of 15.
    """
    case = CASES["thread_g76"]
    tools = "2: {type: grooving_tool}\n  3: {type: threading_tool}"
    ran = run_texts((DATA / case["program"]).read_text(), cell_of("cylinder: [20, 50], xyz: [0, 0, -50]", tools))

    section = 0.92**2 * tan(radians(30.0))
    helix = 2.0 * pi * (10.0 - 0.92 / 3.0) * 22.0 / 1.5
    assert ran.results.stocks["stock"].as_json()["thread_mm3"] == pytest.approx(section * helix, rel=1.0 / 15.0)


def test_a_thread_that_ends_in_the_bar_has_its_groove_there() -> None:
    """The way out goes up the groove that the tip has turned at the end: no rapid cuts (V of 60 degrees, 0.6 deep)."""
    program = "O1\nT0101\nG97 S500 M3\nG0 X24. Z4.\nG0 X18.8\nG32 Z-15. F1.5\nG0 X24.\nZ4.\nM5\nM30\n"
    stock = "cylinder: [20, 50], xyz: [0, 0, -50]"
    ran = run_texts(program, cell_of(stock, "1: {type: threading_tool}", "dialect: fanuc_lathe\n"))
    half = 0.6 * tan(radians(30.0))
    groove = pi * 2.0 * half * 0.6 * (10.0 - 0.6 / 3.0)  # Pappus: area of the V times the way of its centre

    assert "GS401" not in codes(ran)
    assert ran.results.stocks["stock"].as_json()["removed_mm3"] == pytest.approx(groove, rel=0.03)


def test_boring_and_drilling() -> None:
    tools = "1: {type: drill, diameter: 10}\n  2: {type: boring_tool}"
    program = (
        "G21 G18 G7 G90 G40 G49\nT1 M6 G43\nG97 S800 M3\nG95 F0.1\nG0 X0 Z3\nG1 Z-33.0043\nG0 Z100\nX50\n"
        "T2 M6 G43\nM3\nG0 X20 Z2\nG1 Z-20\nX9\nG0 Z5\nX50\nM5\nM2\n"
    )

    ran = run_texts(program, cell_of("cylinder: [30, 30], xyz: [0, 0, -30]", tools))

    tip = 5.0 / 1.6642795
    assert tip == pytest.approx(3.0043, abs=1e-3)
    expected = pi * (15.0**2 * 30.0 - 5.0**2 * 30.0 - (10.0**2 - 5.0**2) * 20.0)
    assert ran.results.stocks["stock"].as_json()["remaining_mm3"] == pytest.approx(expected, rel=5e-4)


def test_a_tool_that_is_put_in_inside_of_the_work_cuts_nothing_until_it_has_left() -> None:
    program = HEAD + "G97 S1000 M3\nG95 F0.2\nG0 X30 Z100\nT2 M6 G43\nG0 X50\nM5\nM2\n"
    tools = "1: {type: turning_tool, length: 50}\n  2: {type: turning_tool, length: 170}"

    ran = run_texts(program, cell_of("cylinder: [40, 60], xyz: [0, 0, -60]", tools))

    assert ran.results.stocks["stock"].as_json()["removed_mm3"] == 0.0
    assert "GS403" in codes(ran)


def fanuc(body: str) -> str:
    return f"%\nO0001\nG21 G18 G40 G99\nT0101\nG97 S1000 M3\n{body}G0 X100. Z100.\nM5\nM30\n%\n"


FANUC_PARTS = {
    # program between start and end, volume that it takes from a bar of 40 x 60 [mm³]
    "G90": ("G0 X42. Z2.\nG90 X36. Z-20. F0.2\nX32.\nX30.\n", pi * (20.0**2 - 15.0**2) * 20.0),
    "G90 with steps": ("G0 X42. Z2.\nG90 U-6. W-22. F0.2\n", pi * (20.0**2 - 18.0**2) * 20.0),
    "G90 R": (
        "G0 X42. Z0.\nG90 X40. Z-20. R-5. F0.2\n",
        pi * 20.0**2 * 20.0 - pi / 3.0 * 20.0 * (20.0**2 + 20.0 * 15.0 + 15.0**2),
    ),
    "G75": ("G0 X42. Z-20.\nG75 R0.5\nG75 X30. Z-26. P2000 Q2500 F0.1\n", pi * (20.0**2 - 15.0**2) * 9.0),
    "G72": (
        "G0 X42. Z2.\nG72 W2. R0.5\nG72 P10 Q20 U0.4 W0.1 F0.2\nN10 G0 Z-12.\nG1 X30. F0.1\nZ-5.\n"
        "N20 X20. Z0.5\nG70 P10 Q20\n",
        pi * 20.0**2 * 12.0
        - pi * 15.0**2 * 7.0
        - pi / 3.0 * 5.0 * (15.0**2 + 15.0 * 115.0 / 11.0 + (115.0 / 11.0) ** 2),
    ),
    "G73": (
        "G0 X50. Z5.\nG73 U4. W2. R3\nG73 P10 Q20 U0.4 W0.1 F0.2\nN10 G0 X30. Z1.\nG1 Z-20. F0.1\n"
        "N20 X42.\nG70 P10 Q20\n",
        pi * (20.0**2 - 15.0**2) * 20.0,
    ),
}


@pytest.mark.parametrize("name", sorted(FANUC_PARTS))
def test_cycles_of_fanuc_leave_the_part_that_they_describe(name: str) -> None:
    body, taken = FANUC_PARTS[name]
    tool = "grooving_tool" if name == "G75" else "turning_tool"

    ran = run_texts(
        fanuc(body), cell_of("cylinder: [40, 60], xyz: [0, 0, -60]", f"1: {{type: {tool}}}", "dialect: fanuc_lathe\n")
    )

    stock = ran.results.stocks["stock"].as_json()
    assert stock["initial_mm3"] - stock["remaining_mm3"] == pytest.approx(taken, rel=2e-3)


@pytest.mark.parametrize("nose", ["{X: -150 mm, Z: -600 mm}", "[-212.5, -880 mm]"])
def test_a_lathe_turns_the_same_wherever_its_axes_count_from(nose: str) -> None:
    """Facing at a constant cutting speed and turning: what is cut, when, and how near the ends of travel."""
    moves = "G0 X60 Z2\nZ-1\nG1 X0\nG0 Z2\nX46\nG1 Z-20\nG2 X52 Z-23 R3\nG28\n"
    program = f"{HEAD}G96 S200 D2000 M3\nG95 F0.2\n{moves}M5\nM2\n"
    cell = cell_of("cylinder: [50, 40], xyz: [0, 0, -40], chuck: {diameter: 90, grip: 10}")
    before = run_texts(program, cell)
    after = run_texts(program, cell.replace("lathe_xz", f"{{model: lathe_xz, nose: {nose}}}"))

    old, new = before.results.stocks["stock"].as_json(), after.results.stocks["stock"].as_json()
    assert new["remaining_mm3"] == pytest.approx(old["remaining_mm3"], rel=1e-9)
    assert after.results.times.feed == pytest.approx(before.results.times.feed, rel=1e-9)
    assert after.results.times.rapid == pytest.approx(before.results.times.rapid, rel=1e-9)
    margins = [[joint["margin"] for joint in ran.results.joints] for ran in (before, after)]
    assert margins[1] == pytest.approx(margins[0], abs=1e-6)
    assert not {code for code in codes(after) if code.startswith("GS4")}


def test_machine_zero_at_the_turret_is_a_safe_place() -> None:
    moves = "G53 G0 X0 Z0\nG0 X36 Z2\nG1 Z-10\nX50\nG53 G0 X0\nG53 G0 Z0\n"
    program = f"{HEAD}G97 S1000 M3\nG95 F0.2\n{moves}M5\nM2\n"
    cell = cell_of("cylinder: [40, 60], xyz: [0, 0, -60], chuck: {diameter: 100, grip: 20}")

    at_rest = cell.replace("lathe_xz", "{model: lathe_xz, nose: [-150, -600 mm]}")
    ran = run_texts(program, at_rest)

    assert not {code for code in codes(ran) if code.startswith(("GS2", "GS4"))}
    assert "GS433" in codes(run_texts(program, cell))  # where it is in the chuck
    margins = [joint["margin"] for joint in ran.results.joints]
    assert margins == pytest.approx([30.0 + 18.0, 80.0 + 60.0 - 10.0 + 100.0])  # a tool of 100 mm
