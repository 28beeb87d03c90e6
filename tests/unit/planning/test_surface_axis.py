"""The tool axis from a surface: on the normal, over edges, with lead and tilt, on arms and five-axis machines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import Job, Options, prepare

MM = 1e-3
TOOL = "tools:\n  1: {type: spray_gun, cone: 15 deg, efficiency: 0.65, length: 100}\n"
PIPE = "{cylinder: [120, 200], in: bench, xyz: [0, 100, 0], rpy: [90, 0, 0]}"
PLATE = "{box: [200, 200, 20], in: bench, xyz: [-200, -100, -20]}"
ARM = """gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, stiffness: rigid}
frames: {bench: {in: world, xyz: [620, 0, 300]}}
work_offsets: {G54: {in: bench}}
"""
MILL = """gcodesim: 1
machine:
  axes:
    X: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Y: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2}
    Z: {travel: [-400, 400 mm], speed: 30 m/min, acceleration: 4 m/s^2, home: 350 mm}
    B: {travel: [-100, 100 deg], speed: 180 deg/s, acceleration: 900 deg/s^2, at: [0, 0, -120 mm]}
    C: {travel: unlimited, speed: 360 deg/s, acceleration: 1800 deg/s^2, at: [0, 0, -120 mm]}
frames: {bench: {in: machine, xyz: [0, 0, -100]}}
work_offsets: {G54: {xyz: [0, 0, -100 mm]}}
"""
ROUND = "G0 X-45 Y-60 Z75\nG1 Z53.619 F3000\nG3 X45 Z53.619 R70\nG1 Y-40\nG2 X-45 Z53.619 R70\nG0 Z150\n"
ALONG = "G0 X-100 Y0 Z30\nG1 Z5 F3000\nG1 X-20\n"


def cell(base: str, body: str, more: str = "") -> str:
    return base + f"orientation: {{tool_axis: normal of body{more}}}\nfixtures:\n  body: {body}\n" + TOOL


def job_of(moves: str, text: str) -> Job:
    held = ("M428\n", "M429\nG0 Z200\n") if "machine:" in text else ("", "")
    program = f"G21 G90 G54 G18\nT1 M6 G43\n{held[0]}{moves}{held[1]}M2\n"
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    assert loaded.cell is not None, [f.message for f in loaded.findings]
    return prepare(SourceText("program.nc", program.encode()), loaded, Options(world="kinematic"))


def sampled(job: Job, dt: float = 2e-3) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Joints, tips [m] and directions from tip to holder in G54, and which samples are feeds with the tip held."""
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    samples = plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, dt))
    q = plan.joints(samples)
    X_WG = (shop.placement.X_WM.inverse() @ shop.placement.X_W("G54")).matrix
    X = np.linalg.inv(X_WG) @ np.linalg.inv(shop.kinematics.table(q)) @ plan.tip(q, samples.row)
    if not shop.mover.joints_are_axes:
        X = np.linalg.inv(shop.placement.X_W("G54").matrix) @ shop.X_WB.matrix @ plan.tip(q, samples.row)
    held = np.array([s.control == "point" or not shop.mover.joints_are_axes for s in plan.path.states])
    feed = np.isfinite(plan.path.feed[samples.row]) & held[plan.path.state[samples.row]]
    return q, X[:, :3, 3], -X[:, :3, 2], feed


def codes(job: Job) -> list[str]:
    return [f.code for f in job.findings if f.code not in ("GS204", "GS206", "GS195", "GS231")]


@pytest.mark.parametrize(("base", "told"), [(ARM, ["GS212"]), (MILL, [])], ids=["arm", "five axes"])
def test_the_tool_stands_on_the_normal_all_along_within_the_limits_of_the_joints(base: str, told: list[str]) -> None:
    """The wrist of the arm passes its singularity on the top of the pipe."""
    job = job_of(ROUND, cell(base, PIPE))
    q, tips, axes, feed = sampled(job)
    normal = tips * [1.0, 0.0, 1.0] / np.linalg.norm(tips * [1.0, 0.0, 1.0], axis=1)[:, None]
    angle = np.degrees(np.arccos(np.clip((normal * axes).sum(axis=1), -1.0, 1.0)))

    assert codes(job) == told
    round_ = feed & (np.abs(tips[:, 0]) < 40.0 * MM)
    assert round_.sum() > 200
    assert angle[round_].max() < 0.3  # the cylinder is a prism of many sides
    assert angle[feed].max() < 2.0  # where a line meets the arc directions are averaged
    radius = np.linalg.norm(tips[round_] * [1.0, 0.0, 1.0], axis=1)
    assert radius.min() > 69.99 * MM and radius.max() < 70.01 * MM
    assert job.shop is not None
    joints = job.shop.kinematics.joints
    assert (np.abs(np.diff(q, axis=0)) / 2e-3 <= 1.001 * joints.speed).all()
    assert (np.abs(np.diff(q, 2, axis=0)) / 4e-6 <= 1.03 * joints.acceleration).all()


def test_lead_leans_the_holder_along_the_feed_and_tilt_to_the_right() -> None:
    job = job_of(ALONG, cell(ARM, PLATE, ", lead: 20 deg, tilt: 10 deg"))
    _, tips, axes, feed = sampled(job)
    inside = feed & (tips[:, 0] > -90.0 * MM) & (tips[:, 0] < -30.0 * MM)
    lead, tilt = np.radians(20.0), np.radians(10.0)
    want = [np.cos(tilt) * np.sin(lead), -np.sin(tilt), np.cos(tilt) * np.cos(lead)]  # +Y lies to the left of +X

    assert inside.sum() > 100
    assert np.abs(axes[inside] - want).max() < 1e-9


def test_over_an_edge_the_tool_turns_evenly_within_the_smooth_way() -> None:
    """5 mm beside a plate and round its edge on an arc: a quarter of a turn, no more than 4 mm before and behind."""
    job = job_of(ALONG + "G1 X0\nG3 X5 Z0 R5\nG1 Z-15\nG0 X80\n", cell(MILL, PLATE, ", smooth: 4 mm"))
    _, tips, axes, feed = sampled(job)
    angle = np.degrees(np.arctan2(axes[:, 0], axes[:, 2]))
    top, side = feed & (tips[:, 0] < -4.1 * MM) & (tips[:, 2] < 5.1 * MM), feed & (tips[:, 2] < -4.1 * MM)

    assert codes(job) == []
    assert np.abs(angle[top]).max() < 0.05
    assert np.abs(angle[side] - 90.0).max() < 0.05
    assert (np.diff(angle[feed & (tips[:, 2] < 5.001 * MM)]) > -0.05).all()


def test_a_thin_sheet_leaves_the_axis_open_and_a_feed_far_away_is_told() -> None:
    sheet = "{box: [200, 200, 0.2], in: bench, xyz: [-200, -100, -0.2]}"
    moves = ALONG.replace("Z5", "Z1") + "G1 X0\nG3 X0 Z-1.2 R1.1\nG1 X-10\n"
    round_the_edge = job_of(moves, cell(MILL, sheet, ", smooth: 8 mm"))
    far = job_of("G0 X-100 Y0 Z90\nG1 X-20 F3000\nG1 X-50\n", cell(ARM, PLATE))

    assert "GS218" in codes(round_the_edge)
    found = [f for f in far.findings if f.code == "GS217"]
    assert [(f.span.line, f.count) for f in found] == [(4, 2)]
    assert found[0].value == pytest.approx(90.0 * MM) and found[0].limit == pytest.approx(20.0 * MM)


def test_a_machine_that_cannot_turn_so_far_says_so() -> None:
    text = cell(MILL.replace("[-100, 100 deg]", "[-5, 5 deg]"), PIPE)
    job = job_of(ROUND, text)
    found = [f for f in job.findings if f.code == "GS219"]
    assert [f.span.line for f in found][:1] == [5]
    assert "upright on `body`, along X" in found[0].message
    # the tool leans about Y by as much as it points to the side; B turns the head by that
    x, z = (float(word[1:]) for word in found[0].message.split("along ")[1].split(":")[0].split() if word[0] in "XZ")
    leaning = np.arctan2(abs(x), z)
    assert "B would be at" in found[0].message and found[0].unit == "rad"
    assert found[0].value is not None and abs(found[0].value) == pytest.approx(leaning, abs=1e-3)
    assert found[0].limit is not None and abs(found[0].limit) == pytest.approx(np.radians(5.0))
    # it is told when B comes to that end
    assert found[0].time is not None and job.plan is not None
    place = job.plan.trajectory.sample(found[0].time + np.array([-0.01, 0.0]))
    before, then = np.degrees(np.abs(job.plan.joints(place)[:, 3]))
    assert before < then <= 5.0 + 1e-6 and then > 4.99


def test_an_arm_that_cannot_lean_so_far_names_the_joint_and_how_far_it_would_go() -> None:
    under = "G0 X0 Y-60 Z80\nG2 X0 Z-80 R80 F3000\n"
    job = job_of(
        under,
        cell(ARM.replace("300]", "500]"), "{cylinder: [100, 100], in: bench, rpy: [90, 0, 0]}", ", within: 50 mm"),
    )
    (found,) = [f for f in job.findings if f.code in ("GS202", "GS203", "GS216", "GS219")]
    assert found.code == "GS203" and found.span is not None and found.span.line == 4 and "joint_5" in found.message
    # as far as it goes on the block, and the time is when the joint is at its limit
    q = sampled(job)[0][:, 4]
    assert found.value == pytest.approx(q[np.abs(q).argmax()], abs=1e-2) and abs(found.value) > abs(found.limit) + 0.1
    assert job.plan is not None and found.time is not None
    then = job.plan.joints(job.plan.trajectory.sample(np.array([found.time])))[0, 4]
    assert then == pytest.approx(found.limit, abs=1e-3)


@pytest.mark.parametrize("smooth", [4, 8, 15, 25])
def test_an_axis_that_comes_to_the_end_of_its_travel_goes_there_and_no_further(smooth: int) -> None:
    text = cell(MILL.replace("[-100, 100 deg]", "[-20, 20 deg]"), PIPE, f", smooth: {smooth} mm")
    job = job_of(ROUND, text)
    q, _, _, feed = sampled(job)
    turned = np.degrees(np.abs(q[:, 3]))

    assert "GS219" in codes(job) and "GS201" not in codes(job)
    assert turned.max() <= 20.0 + 1e-6
    assert turned[feed].max() > 20.0 - 1e-3


def test_after_the_tip_is_let_go_axes_stand_where_the_program_says() -> None:
    job = job_of(ROUND, cell(MILL, PIPE))
    q, _, _, _ = sampled(job)
    assert np.abs(q[-1, 3:]).max() < 1e-9
    assert q[-1, :3] == pytest.approx([-45.0 * MM, -40.0 * MM, (200.0 - 100.0 + 100.0) * MM], abs=1e-5)


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (cell(ARM, PIPE).replace("normal of body", "normal of boddy"), "GS712"),
        (cell(MILL.replace(", at: [0, 0, -120 mm]", ""), PIPE), "GS719"),
        (cell(ARM, PIPE).replace("tool_axis: normal of body", "lead: 5 deg"), "GS719"),
        (cell(ARM, PIPE, ", words: Z(A) Y(B) X(C)"), "GS719"),
        (cell(ARM, PIPE, ", lead: 85 deg"), "GS710"),
        (
            cell(ARM, PIPE) + "externals: {table: {axes: {C: {travel: unlimited, speed: 9 deg/s}}}}\n",
            "GS719",
        ),
    ],
)
def test_faults_of_a_surface(text: str, code: str) -> None:
    loaded = read_cell(SourceText("cell.yaml", text.encode()), Path("cell.yaml"))
    assert [f.code for f in loaded.findings] == [code]
