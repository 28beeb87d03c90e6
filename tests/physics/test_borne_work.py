"""Two arms at a positioner: the program of one moves it, that of the other works on it."""

from __future__ import annotations

from math import pi
from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Job
from gcodesim.simulation import Options, prepare, run
from gcodesim.units import MM

CELL = """gcodesim: 1
robots:
  one: {model: kuka_kr10_r1100_2, stiffness: rigid}
  two: {model: kuka_kr10_r1100_2, base: {in: world, xyz: [1300, 0, 0], rpy: [0, 0, 180]}, stiffness: rigid}
externals:
  table:
    robot: one
    axes:
      A: {travel: [-90, 90 deg], speed: 90 deg/s, acceleration: 300 deg/s^2, at: [0, 0, 20]}
      C: {travel: unlimited, speed: 90 deg/s, acceleration: 300 deg/s^2, home: 30 deg}
    base: {in: world, xyz: [650, 0, 300]}
channels:
  main: {robot: one, m_codes: {M200: {wait: turned}, M201: {wait: milled}}}
  other:
    robot: two
    loaded_tool: 1
    work_offsets: {G54: {in: table, xyz: [0, 0, 40]}, G55: {in: world, xyz: [800, 0, 400]}}
    m_codes: {M200: {wait: turned}, M201: {wait: milled}}
stock: {plate: {box: [40, 60, 40], in: table, xyz: [-20, 5, 0], material: al6082_t6, resolution: 0.5}}
tools:
  1: {type: flat_end_mill, diameter: 8, flutes: 2, length: 60}
simulation: {world: kinematic}
"""
TURNS = "G21 G90\nM201\nG0 C90\nM200\nM201\nG0 A15 C180\nM200\nM201\nM2\n"
SLOT = "G0 X0 Y20 Z20\nG1 Z-2 F600\nG1 Y40 F1200\nG0 Z100\n"
WORK = f"G21 G90 G94 G61\nS12000 M3\n{SLOT}M201\nM200\n{SLOT}M201\nM200\n{SLOT}M201\nM5\nM2\n"


def planned(turns: str, work: str, cell: str = CELL) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    assert loaded.cell is not None, loaded.findings
    programs = {"other": SourceText("other.nc", work.encode())}
    return prepare(SourceText("one.nc", turns.encode()), loaded, Options(channels=programs))


def test_the_same_slot_on_work_that_was_turned_is_cut_once() -> None:
    """Three times the same block at three places of the table: 20 mm of 8 wide and 2 deep, with round ends."""
    results, _ = run(planned(TURNS, WORK))

    assert not [finding for finding in results.findings if finding.code != "GS195"]
    assert results.stocks["plate"].removed / MM**3 == pytest.approx(2.0 * (20.0 * 8.0 + pi * 16.0), rel=0.01)


def test_the_tip_is_where_the_program_says_on_the_turned_work() -> None:
    job = planned(TURNS, WORK)
    one, other = job, job.others[0]
    assert one.plan is not None and other.plan is not None and one.shop is not None and other.shop is not None
    cuts = np.flatnonzero(np.isfinite(other.plan.path.feed))
    time = other.plan.trajectory.row_end[cuts]
    q = one.plan.joints(one.plan.trajectory.sample(time))
    X_WC = one.shop.scene.track("one/table", {"one": q})
    tip = other.plan.tip(other.plan.joints(other.plan.trajectory.sample(time)), cuts)
    X_CT = np.linalg.inv(X_WC) @ other.shop.X_WB.matrix @ tip

    assert np.degrees(q[:, -2:]) == pytest.approx(np.array([[0, 30], [0, 30], [0, 90], [0, 90], [15, 180], [15, 180]]))
    there = np.array([[0.0, 20.0, 38.0], [0.0, 40.0, 38.0]] * 3) * MM
    assert np.abs(X_CT[:, :3, 3] - there).max() < 1e-9
    assert np.abs(X_CT[:, :3, 2] - [0.0, 0.0, -1.0]).max() < 1e-9


def test_the_arm_stands_while_it_waits_and_the_work_turns() -> None:
    """It goes to its new place by joints behind the wait, within the limits of these."""
    job = planned(TURNS, WORK)
    plan = job.others[0].plan
    assert plan is not None
    waits = [event for event in plan.trajectory.events if event.duration > 0.0]
    for wait in waits:
        q = plan.joints(plan.trajectory.sample(np.linspace(wait.time, wait.time + wait.duration, 20)))
        assert np.ptp(q, axis=0).max() == 0.0
    dt = 4e-3
    q = plan.joints(plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, dt)))
    joints = plan.kinematics.joints
    assert len(waits) == 2
    assert (np.abs(np.diff(q, axis=0)).max(axis=0) / dt <= 1.001 * joints.speed).all()
    assert (np.abs(np.diff(q, 2, axis=0)).max(axis=0) / dt**2 <= 1.02 * joints.acceleration).all()


def test_a_feed_behind_a_wait_begins_where_the_work_is() -> None:
    """What the program takes for its place on the work is sought first; the feed is a straight line there."""
    work = "G21 G90 G94\nG55\nG0 X0 Y0 Z50\nG54\nG0 X0 Y20 Z20\nM200\nG1 X30 F600\nM2\n"
    job = planned("G21 G90\nG0 C90\nM200\nM2\n", work)
    other = job.others[0]
    assert other.plan is not None
    row = int(np.flatnonzero(np.isfinite(other.plan.path.feed))[0])
    start, end = other.plan.path.start[row, :3], other.plan.path.end[row, :3]
    X_BW = job.others[0].shop.X_WB.inverse()  # type: ignore[union-attr]

    assert (end - start) / MM == pytest.approx(X_BW.rotate(np.array([0.0, 30.0, 0.0])), abs=1e-6)
    gap = np.linalg.norm(other.plan.path.end[row - 1, :3] - start)
    assert gap == pytest.approx(0.0, abs=1e-9)


def test_work_that_moves_meanwhile_is_told() -> None:
    job = planned("G21 G90\nG0 C120\nM2\n", WORK)

    (told,) = [finding for finding in job.findings if finding.code == "GS627"]
    assert "`table` moves while `other` works in G54" in told.message and "`robot: two`" in told.hint
    assert told.span.file == "other.nc"
    distance = 2.0 * 40.0 * np.sin(np.radians(45.0))  # of a point 40 mm off, turned from 30 to 120 deg
    assert told.value == pytest.approx(distance, abs=2.0)


@pytest.mark.parametrize(
    ("old", "new", "hint"),
    [
        ("G54: {in: table", "G54: {in: one/flange", "external axes carry, not on a link"),
        (
            "loaded_tool: 1",
            "orientation: {tool_axis: normal of plate}\n    loaded_tool: 1",
            "name another `tool_axis`",
        ),
    ],
)
def test_what_cannot_be_followed_says_what_can(old: str, new: str, hint: str) -> None:
    loaded = read_cell(SourceText("cell.yaml", CELL.replace(old, new).encode()), Path("cell.yaml"))

    assert loaded.cell is None
    assert [hint in finding.hint for finding in loaded.findings if finding.code == "GS712"] == [True]
