"""Probing against closed forms: faces, pockets that the program has cut itself, fixtures, tables that move, arms.

Walls stand on a grid of columns, so a probe may find them half a cell beside their place; heights are exact.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.units import MM
from tests.physics.runs import ARM_HOME, Ran, run_texts

CELL_SIZE = 0.5  # mm
HALF = 0.5 * CELL_SIZE + 1e-6
BALL = 4.0  # mm, across
MILL = """gcodesim: 1
machine: gantry_xyz
stock: {box: [60, 40, 20], zero: top-front-left, material: al6082_t6, resolution: 0.5}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 3, length: 60 mm}
  2: {type: probe, diameter: 4, length: 60 mm}
"""
POCKET = """G21 G90 G94 G17
T1 M6
G43 H1
S6000 M3
G0 X30 Y20
Z2
F600
G1 Z-5
G1 X23.13
Y15.2
X36.9
Y24.77
X23.13
Y20
X36.9
X30
G0 Z20
M5
T2 M6
G43 H2
G0 X30 Y20
Z2
F100
G38.2 Z-10
#31=#5063
G0 Z-3
F300
G38.2 X50
#32=#5061
G0 X30
G38.2 X10
#33=#5061
G0 X30
G38.2 Y35
#34=#5062
G0 Y20
G38.2 Y5
#35=#5062
G0 Y20
Z20
M2
"""
WALLS = {
    32: 36.9 + 3.0 - 0.5 * BALL,
    33: 23.13 - 3.0 + 0.5 * BALL,
    34: 24.77 + 3.0 - 0.5 * BALL,
    35: 15.2 - 3.0 + 0.5 * BALL,
}


def parameter(ran: Ran, number: int) -> float:
    """What the program stored [mm]."""
    assert ran.job.reading is not None
    return ran.job.reading.parameters.get(number, 0.0)


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_each_wall_of_a_pocket_is_found_within_half_a_cell(world: str, tmp_path: Path) -> None:
    ran = run_texts(POCKET, MILL, tmp_path, world=world)

    assert ran.misuse == []
    assert parameter(ran, 31) == pytest.approx(-5.0, abs=1e-5), "heights are exact"
    for number, place in WALLS.items():
        assert parameter(ran, number) == pytest.approx(place, abs=HALF)
    assert [probing.tripped for probing in ran.results.probings] == [True] * 5
    assert {probing.body for probing in ran.results.probings} == {"stock"}


def test_a_probe_removes_nothing() -> None:
    cutting, _, probing = POCKET.partition("T2 M6")
    cut = run_texts(cutting + "M2\n", MILL)
    probed = run_texts(POCKET, MILL)

    assert probing and probed.stock.removed == cut.stock.removed


def test_the_faces_of_a_block_are_found_where_they_are() -> None:
    program = """G21 G90 G94
T2 M6
G43 H2
G0 X-10 Y20
Z-5
F500
G38.2 X10
#31=#5061
G0 X-10
Z10
X30
G38.2 Z-5
#32=#5063
M2
"""
    ran = run_texts(program, MILL)
    assert parameter(ran, 31) == pytest.approx(-2.0, abs=1e-5)
    assert parameter(ran, 32) == pytest.approx(0.0, abs=1e-5)


def test_the_machine_comes_to_rest_behind_the_trip_and_goes_on_from_there() -> None:
    """At v and a the overshoot is v²/2a; under G64 the time law uses half of what the axis can do, as LinuxCNC does."""
    feed = 3000.0
    program = f"G21 G90 G94\nT2 M6\nG43 H2\nG0 X30 Y20\nZ20\nF{feed}\nG38.2 Z-15\n#31=#5063\nG91 G0 Z5\nG90\nM2\n"
    ran = run_texts(program, MILL)
    acceleration = 0.5 * float(ran.shop.kinematics.joints.acceleration[2]) / MM
    over = (feed / 60.0) ** 2 / (2.0 * acceleration)
    plan = ran.job.plan
    assert plan is not None
    top = float(plan.path.end[-1, 2] - plan.path.end[1, 2]) / MM  # from Z20 of the program

    assert over > 0.05
    assert parameter(ran, 31) == pytest.approx(0.0, abs=1e-5)
    assert top == pytest.approx(5.0 - over - 20.0, abs=1e-4)


def test_contact_is_left_by_g38_4() -> None:
    program = "G21 G90 G94\nT2 M6\nG43 H2\nG0 X30 Y20\nZ5\nF1200\nG38.2 Z-5\nF20\nG38.4 Z3\n#31=#5063\nM2\n"
    ran = run_texts(program, MILL)
    assert ran.results.status == "ok"
    assert parameter(ran, 31) == pytest.approx(0.0, abs=1e-4)


def test_a_fixture_is_touched_where_it_stands() -> None:
    cell = MILL + "fixtures:\n  stop: {min: [70, 0, -20], max: [80, 40, 8], in: G54}\n"
    program = "G21 G90 G94\nT2 M6\nG43 H2\nG0 X65 Y20\nZ4\nF200\nG38.2 X75\n#31=#5061\nG0 X65\nZ20\nM2\n"
    ran = run_texts(program, cell)
    assert parameter(ran, 31) == pytest.approx(68.0, abs=3e-3)
    assert ran.results.probings[0].body == "stop"
    assert ran.misuse == [], "what a probe touches it does not run into"


def test_a_rapid_into_the_fixture_is_a_collision_all_the_same() -> None:
    cell = MILL + "fixtures:\n  stop: {min: [70, 0, -20], max: [80, 40, 8], in: G54}\n"
    program = "G21 G90 G94\nT2 M6\nG43 H2\nG0 X65 Y20\nZ4\nF200\nG38.2 X75\nG0 X85\nZ20\nM2\n"
    ran = run_texts(program, cell)
    assert ("GS304", 8) in ran.misuse


def test_a_table_that_moves_brings_the_work_to_the_probe() -> None:
    cell = MILL.replace(
        "machine: gantry_xyz",
        "machine: {axes: {X: {travel: [-300, 300], speed: 10 m/min, acceleration: 2 m/s^2, side: table},"
        " Y: {travel: [-200, 200], speed: 10 m/min, acceleration: 2 m/s^2, side: table},"
        " Z: {travel: [-300, 0], speed: 10 m/min, acceleration: 2 m/s^2}}}",
    )
    program = "G21 G90 G94\nT2 M6\nG43 H2\nG0 X-10 Y20\nZ-5\nF500\nG38.2 X10\n#31=#5061\nG0 X-10\nZ10\nM2\n"
    ran = run_texts(program, cell)
    assert parameter(ran, 31) == pytest.approx(-2.0, abs=1e-5)


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_an_arm_probes_and_keeps_its_attitude(world: str) -> None:
    cell = f"""gcodesim: 1
robots: {{arm: {{model: kuka_kr10_r1100_2, home: {ARM_HOME}}}}}
work_offsets: {{G54: {{xyz: [650, 0, 250]}}}}
stock: {{box: [60, 40, 20], zero: top-front-left, in: G54, material: al6082_t6, resolution: 0.5}}
tools:
  2: {{type: ball_end_mill, diameter: 4, length: 60 mm}}
"""
    program = """G21 G90 G94
T2 M6
G43 H2
G0 X30 Y20 Z20
F600
G38.2 Z-5
#31=#5063
G0 Z10
X-10
Z-5
G38.2 X10
#32=#5061
G0 X-10
Z20
M2
"""
    ran = run_texts(program, cell, world=world)
    assert ran.results.status == "ok", ran.bad
    assert parameter(ran, 31) == pytest.approx(0.0, abs=1e-5)
    assert parameter(ran, 32) == pytest.approx(-2.0, abs=1e-5)
    plan = ran.job.plan
    assert plan is not None
    t = np.arange(0.0, plan.trajectory.duration, 4e-3)
    q = plan.joints(plan.trajectory.sample(t))
    assert np.all(np.abs(np.diff(q, axis=0)) / 4e-3 <= 1.02 * plan.kinematics.joints.speed), "no joint jumps"


def test_a_ball_end_mill_that_touches_off_takes_nothing_either() -> None:
    # at one rate: where nothing waits for a tick, steps are as long as the way asks for
    cell = MILL.replace("type: probe", "type: ball_end_mill") + "simulation: {rate: 250 Hz}\n"
    cutting = POCKET.partition("T2 M6")[0]
    cut = run_texts(cutting + "M2\n", cell)
    probed = run_texts(POCKET, cell)
    assert probed.misuse == [] and probed.stock.removed == cut.stock.removed


@pytest.mark.parametrize("move", ["G0 Z-2", "G1 Z-2 F100"])
def test_a_probe_that_runs_into_the_stock_is_told(move: str) -> None:
    ran = run_texts(f"G21 G90 G94\nT2 M6\nG43 H2\nG0 X30 Y20\nZ5\n{move}\nG0 Z5\nM2\n", MILL)
    assert ran.misuse == [("GS408", 6)]
    assert ran.stock.removed == 0.0


def test_a_stem_that_touches_is_told() -> None:
    """The ball is below the block, beside which only the stem is."""
    cell = MILL.replace("2: {type: probe, diameter: 4,", "2: {type: probe, diameter: 4, stem_diameter: 4,")
    ran = run_texts("G21 G90 G61\nT2 M6\nG43 H2\nG0 X-10 Y20\nZ-30\nG0 X-1\nX-10\nZ20\nM2\n", cell)
    assert ran.misuse == [("GS408", 6)]
