"""An arm on a rail, and an arm with a turn-tilt table: external axes in whole runs."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.regress.surfaces import compare_stocks
from gcodesim.simulation import Job, Options, prepare
from gcodesim.units import MM
from tests.physics.runs import run_texts

RAIL = """gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [0, 0, 200]}, stiffness: rigid}
externals:
  rail: {carries: arm, axes: {U: {travel: [0, 3 m], speed: 1 m/s, acceleration: 2 m/s^2, home: 100 mm%s}}}
work_offsets: {G54: {in: world, xyz: [0, 600, 450]}}
stock: {box: [900, 40, 10], in: G54, zero: top-front-left, material: al6082_t6, resolution: 1}
tools:
  1: {type: flat_end_mill, diameter: 10, flutes: 2, length: 60}
"""
POSITIONER = """gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, stiffness: rigid}
externals:
  positioner:
    axes:
      A: {travel: [-90, 90 deg], speed: 90 deg/s, acceleration: 300 deg/s^2, at: [0, 0, 40]}
      C: {travel: unlimited, speed: 180 deg/s, acceleration: 600 deg/s^2}
    base: {in: world, xyz: [600, 0, 250]}
frames: {pallet: {in: positioner, xyz: [0, 0, 20]}}
work_offsets: {G54: {in: pallet, xyz: [0, 0, 30]}}
stock: {cylinder: [70, 30], in: pallet, material: al6082_t6, resolution: 0.5}
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 2, length: 60}
"""
HEAD = "G21 G90 G94\nT1 M6\nS12000 M3\n"


def planned(program: str, cell: str) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    return prepare(SourceText("program.nc", program.encode()), loaded, Options(world="kinematic"))


def tips(job: Job, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joints (n, j), the tip X_WT and the platform's or the world's X_W (n, 4, 4) at times `t`."""
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    samples = plan.trajectory.sample(t)
    q = plan.joints(samples)
    X_WT = shop.X_WB.matrix @ plan.tip(q, np.minimum(samples.row, len(plan.path) - 1))
    frame = shop.placement.platforms.get(1, "world")
    return q, X_WT, shop.scene.track(frame, {shop.name: q})


def test_an_arm_on_a_rail_cuts_what_it_does_not_reach_from_one_place() -> None:
    """A slot of 800 mm, 10 wide and 2 deep, with round ends."""
    program = HEAD + "G0 X50 Y20 Z30 U100\nG1 Z-2 F1000\nG1 X850 U900 F6000\nG0 Z30\nM5\nM2\n"
    ran = run_texts(program, RAIL % "")

    assert not ran.bad
    assert ran.stock.removed / MM**3 == pytest.approx(800.0 * 10.0 * 2.0 + pi * 25.0 * 2.0, rel=0.01)
    rail = next(joint for joint in ran.results.joints if joint["name"] == "rail/U")
    assert (rail["unit"], rail["least"], rail["most"]) == ("mm", 100.0, 900.0)


def test_the_tip_stays_while_the_rail_moves_under_the_arm() -> None:
    """U alone: its feed is that of the rail, and the arm makes up for it."""
    job = planned(HEAD + "G61\nG0 X200 Y20 Z30 U200\nG1 U800 F6000\nM2\n", RAIL % "")
    plan = job.plan
    assert plan is not None and not [f for f in job.findings if f.code.startswith("GS2")]
    begin, end = float(plan.trajectory.row_start[-1]), float(plan.trajectory.row_end[-1])
    q, X_WT, _ = tips(job, np.linspace(begin, end, 200))

    assert np.ptp(q[:, 0]) == pytest.approx(0.6, abs=1e-9)
    assert np.abs(X_WT[:, :3, 3] - np.array([200.0, 620.0, 480.0]) * MM).max() < 1e-7
    assert end - begin == pytest.approx(0.6 / 0.1 + 0.1 / 2.0, rel=0.02)  # at 0.1 m/s, ramps of 2 m/s²


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_a_slot_in_turning_work_is_that_in_resting_work(world: str) -> None:
    """The program is about the work: C and A that turn under a slot leave the same slot."""
    slot = HEAD + "G0 X-50 Y5 Z20{0}\nG0 Z-3\nG1 X50{1} F3000\nG0 Z30\nM5\nM2\n"
    still, turned = (
        run_texts(slot.format(*words), POSITIONER, world=world) for words in (("", ""), (" A10 C-20", " A-15 C50"))
    )

    assert not still.bad and not turned.bad
    one, two = (next(iter(ran.shop.stocks.values())).stock for ran in (still, turned))
    assert compare_stocks("stock", one, two, 0.5) is None
    assert turned.stock.removed == pytest.approx(still.stock.removed, rel=0.02)


def test_the_tip_keeps_its_line_in_turning_work_within_all_limits() -> None:
    program = HEAD + "G61\nG0 X-40 Y10 Z20 A0 C0\nG1 X30 Y-10 Z15 A25 C200 F9000\nG1 X0 Y0 Z20 A-10 C0\nM2\n"
    job = planned(program, POSITIONER)
    plan = job.plan
    assert plan is not None
    row = 1 + int(np.argmax(np.isfinite(plan.path.feed))) - 1
    t = np.linspace(plan.trajectory.row_start[row], plan.trajectory.row_end[row], 400)
    q, X_WT, X_WC = tips(job, t)
    X_CT = np.linalg.inv(X_WC) @ X_WT
    start, end = np.array([-40.0, 10.0, 70.0]) * MM, np.array([30.0, -10.0, 65.0]) * MM
    along = (end - start) / np.linalg.norm(end - start)
    beside = X_CT[:, :3, 3] - start
    beside -= (beside @ along)[:, None] * along
    assert np.abs(beside).max() < 1e-7
    assert np.abs(X_CT[:, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-9
    assert np.degrees(q[-1, -2:]) == pytest.approx([25.0, 200.0])

    dt = 2e-3
    q = tips(job, np.arange(0.0, plan.trajectory.duration, dt))[0]
    joints = plan.kinematics.joints
    speed = np.abs(np.diff(q, axis=0)) / dt
    assert (speed.max(axis=0) <= 1.02 * joints.speed).all()
    assert (q >= joints.lower - 1e-9).all() and (q <= joints.upper + 1e-9).all()


def test_travel_letters_and_words_of_external_axes() -> None:
    job = planned("G21 G90\nG0 X200 Y20 Z30 U3200\nG0 V5\nG0 A20\nM2\n", RAIL % "")
    found = {f.code: f for f in job.findings}

    assert "U would go to 3200.000 mm" in found["GS201"].message
    assert found["GS201"].span.line == 2
    assert found["GS207"].span.line == 4
    assert job.reading is not None and "V" in job.reading.not_simulated


@pytest.mark.parametrize(
    ("old", "new", "code", "line"),
    [
        ("carries: arm", "carries: leg", "GS712", 5),
        ("[0, 3 m]", "[3 m, 0]", "GS710", 5),
        ("home: 100 mm", "home: -1 m", "GS723", 5),
        ("axes: {U:", "axes: {Q:", "GS711", 5),
        ("  rail:", "  arm:", "GS719", 5),
        ("work_offsets: {G54: {in: world", "work_offsets: {G54: {in: rail", "GS712", 6),
    ],
)
def test_faults_of_externals(old: str, new: str, code: str, line: int) -> None:
    text = (RAIL % "").replace(old, new)
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))

    assert loaded.cell is None
    assert (code, line) in [(f.code, f.span.line) for f in loaded.findings]


def test_a_table_of_a_robot_is_told_to_a_machine_tool() -> None:
    """An arm may work there (`test_borne_work.py`)."""
    text = (
        "gcodesim: 1\nmachine: gantry_xyz\nrobots:\n  one: {model: kuka_kr10_r1100_2}\n"
        "externals:\n  table: {robot: one, axes: {C: {travel: unlimited, speed: 90 deg/s}}}\n"
        "channels:\n  main: {robot: one, work_offsets: {G54: {in: table}}}\n"
        "  other: {robot: machine, work_offsets: {G54: {in: table}}}\n"
    )
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))

    (fault,) = loaded.findings
    assert (fault.code, fault.span.line) == ("GS712", 9)
    assert "`one`" in fault.message and "its own table" in fault.hint


def test_a_letter_is_there_once() -> None:
    text = POSITIONER + "orientation: {words: Z(C) X(B)}\n"
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))

    assert loaded.cell is None
    assert [(f.code, f.span.line) for f in loaded.findings] == [("GS719", 8)]


def test_what_an_external_axis_moves_has_its_name() -> None:
    job = planned(HEAD + "G0 X0 Y0 Z20 A0 C0\nM2\n", POSITIONER)
    assert job.shop is not None
    assert job.shop.joint_names[-2:] == ("positioner/A", "positioner/C")
    assert job.shop.scene.standing_on("stock/stock")[0] == "arm/positioner"


def within_limits(job: Job) -> np.ndarray:
    """Joints (n, j) every 4 ms; their speeds, accelerations and places are within their limits."""
    plan = job.plan
    assert plan is not None
    dt = 4e-3
    q = tips(job, np.arange(0.0, plan.trajectory.duration, dt))[0]
    joints = plan.kinematics.joints
    assert (q >= joints.lower - 1e-9).all() and (q <= joints.upper + 1e-9).all()
    assert (np.abs(np.diff(q, axis=0)).max(axis=0) / dt <= 1.001 * joints.speed).all()
    assert (np.abs(np.diff(q, 2, axis=0)).max(axis=0) / dt**2 <= 1.02 * joints.acceleration).all()
    return q


def test_a_free_rail_goes_along_where_the_arm_does_not_reach() -> None:
    """1.8 m to and fro: no place of the rail does for all of it, and no word moves it."""
    program = HEAD + "G0 X50 Y20 Z30\nG1 X1850 F6000\nG1 X1800\nG1 X60\nG0 Z40\nM2\n"
    job = planned(program, RAIL % ", free: true")
    assert not [f for f in job.findings if f.code.startswith("GS2")]
    q = within_limits(job)

    assert np.ptp(q[:, 0]) > 0.3
    plan = job.plan
    assert plan is not None
    row = np.flatnonzero(np.isfinite(plan.path.feed))[0]
    X_WT = tips(job, np.linspace(plan.trajectory.row_start[row] + 0.1, plan.trajectory.row_end[row] - 0.1, 100))[1]
    assert np.abs(X_WT[:, 1:3, 3] - np.array([620.0, 480.0]) * MM).max() < 1e-7


def test_a_free_table_turns_the_work_to_the_arm() -> None:
    """A full circle around the work with the tool at its side, which an arm beside a resting table cannot run."""
    ring = "".join(
        f"G1 X{55 * np.cos(a):.4f} Y{55 * np.sin(a):.4f} Z10. I{np.cos(a):.6f} J{np.sin(a):.6f} K0.05\n"
        for a in np.radians(np.arange(0, 361, 10))
    )
    program = "%\nO1\nG21 G90 G94 G54\nT1 M6\nG43.5 H1\nG0 X80. Y0. Z10. I1. J0. K0.05\nF3000.\n" + ring + "M30\n%\n"
    free = POSITIONER.replace("xyz: [600, 0, 250]}", "xyz: [700, 0, 500]}\n    free: true")
    fanuc = free.replace("gcodesim: 1\n", "gcodesim: 1\ndialect: fanuc\n")
    job = planned(program, fanuc)
    assert not [f.message for f in job.findings if f.code in ("GS202", "GS203", "GS205", "GS216")]
    q = within_limits(job)
    assert np.ptp(q[:, -1]) > np.radians(60.0)


@pytest.mark.parametrize(("length", "told"), [(700, []), (1300, [("GS305", 5), ("GS305", 11)])])
def test_the_body_of_a_vehicle_goes_with_it_and_hits_what_it_drives_into(length: int, told: list[object]) -> None:
    """A bench whose edge is 450 mm before the vehicle's middle; a hull of 700 mm stops before it, one of 1300 not."""
    top = Path(__file__).parents[2]
    cell = (top / "cells" / "agv.yaml").read_text().replace("[700, 500, 250]", f"[{length}, 500, 250]")
    job = planned((top / "programs" / "agv.nc").read_text(), cell)

    assert [(f.code, f.span.line) for f in job.findings if f.level > Severity.NOTE] == told
    assert all(f.message.startswith("hull hits bench_") for f in job.findings if f.code == "GS305")


def test_a_free_table_finds_its_way_between_places_far_apart() -> None:
    """Round a boss with the tool 63 degrees down: on the coarse grid C leaps by 120 degrees from rung to rung."""
    cell = """gcodesim: 1
dialect: fanuc
robots: {arm: {model: staubli_tx2_90, stiffness: rigid}}
externals:
  table:
    free: true
    axes:
      A: {travel: [-90, 90 deg], speed: 90 deg/s, acceleration: 300 deg/s^2, at: [0, 0, 40]}
      C: {travel: [-360, 360 deg], speed: 120 deg/s, acceleration: 400 deg/s^2}
    base: {in: world, xyz: [699.6, -5.4, 119.4]}
work_offsets: {G54: {in: table, xyz: [0, 0, 60]}}
tools: {1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}}
"""
    lines = ["%", "O1", "G21 G90 G94 G54", "T1 M6", "G43.5 H1"]
    for k in range(30):
        turn = 0.2462 + 2.0 * pi * k / 29
        x, y = 0.89216 * np.cos(turn), 0.89216 * np.sin(turn)
        word = "G0" if k == 0 else "G1 F6000" if k == 1 else "G1"
        lines.append(
            f"{word} X{65.185 * x:.4f} Y{65.185 * y:.4f} Z{30 * np.sin(3 * turn):.4f} I{x:.6f} J{y:.6f} K0.451682"
        )
    job = planned("\n".join([*lines, "G49", "M30", "%", ""]), cell)

    assert not [f.message for f in job.findings if f.code in ("GS202", "GS203", "GS205", "GS216")]
