"""Bent rapids (GS211) and tools that turn on the spot (GS212)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.jobs.job import Job
from gcodesim.simulation import prepare

MILL = """gcodesim: 1
machine:
  rapids: RAPIDS
  axes:
    X: {travel: [-300, 300 mm], speed: 10 m/min, acceleration: 1000 m/s^2}
    Y: {travel: [-300, 300 mm], speed: 20 m/min, acceleration: 1000 m/s^2}
    Z: {travel: [-300, 300 mm], speed: 5 m/min, acceleration: 1000 m/s^2}
"""
TRUNNION = (
    MILL.replace("RAPIDS", "linear")
    + """
    A: {travel: [-120, 120 deg], speed: 90 deg/s, at: [0, 0, -120 mm]}
    C: {travel: unlimited, speed: 180 deg/s, at: [0, 0, -120 mm]}
"""
)


def job_of(program: str, cell: str) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    return prepare(SourceText("a.ngc", ("G21 G90\n" + program + "M2\n").encode()), loaded)


def found(program: str, cell: str, code: str) -> list[Diagnostic]:
    return [finding for finding in job_of(program, cell).findings if finding.code == code]


def test_a_bent_rapid_is_told_with_how_far_it_passes_beside() -> None:
    """X needs twice as long for the same way as Y: the corner of the way is at half X, all of Y."""
    cell = MILL.replace("RAPIDS", "independent")
    notes = found("G0 X100\nG0 X0 Y100\nG0 X50 Y50\n", cell, "GS211")
    assert [(note.span.line, note.count) for note in notes] == [(3, 2)]
    assert notes[0].value == pytest.approx(0.1 / np.sqrt(2.0) / 2.0, rel=3e-2)  # (50, 100) from x + y = 100
    assert not found("G0 X100\nG0 X0 Y100\n", MILL.replace("RAPIDS", "linear"), "GS211")


def test_a_bent_rapid_is_the_way_that_is_run() -> None:
    job = job_of("G0 X100 Y100\n", MILL.replace("RAPIDS", "independent"))
    assert job.plan is not None
    trajectory = job.plan.trajectory
    middle = job.plan.joints(trajectory.sample(np.array([0.5 * trajectory.duration])))[0]
    np.testing.assert_allclose(middle[:2], [0.05, 0.1], atol=1e-4)


def test_under_jerk_each_axis_runs_its_own_curve() -> None:
    """D/v + v/a + a/j for each axis (Biagiotti, Melchiorri 2008, section 3.4); the slowest one makes the time."""
    cell = MILL.replace("RAPIDS", "independent").replace("1000 m/s^2}", "2 m/s^2, jerk: 200 m/s^3}")
    job = job_of("G0 X100 Y100\n", cell)
    assert job.plan is not None
    plan, times = job.plan, [0.1 / v + v / 2.0 + 2.0 / 200.0 for v in (10 / 60, 20 / 60)]
    assert plan.trajectory.duration == pytest.approx(times[0], rel=1e-9)
    q = plan.joints(plan.trajectory.sample(np.array([0.5 * times[1], times[1], 0.5 * times[0]])))
    assert q[0, 1] == pytest.approx(0.05, rel=1e-9) and q[1, 1] == pytest.approx(0.1, rel=1e-9)
    assert q[2, 0] == pytest.approx(0.05, rel=1e-9)


def test_a_turn_on_the_spot_is_told() -> None:
    told = found("M428\nG1 X10 A30 C0 F500\nX11 A-30 C180\n", TRUNNION, "GS212")
    assert [(warning.span.line, round(np.degrees(warning.value or 0.0))) for warning in told] == [(4, 180)]
    rewound = found("M428\nG0 X10 A30 C350\nG1 X11 C-10 F500\n", TRUNNION, "GS212")
    assert [warning.span.line for warning in rewound] == [4]


@pytest.mark.parametrize(
    "lines",
    [
        "M428\nG1 X10 A80 C0 F500\nX11 C90\n",  # the tool turns along
        "M428\nG1 X10 A30 C0 F500\nG0 X11 A-30 C180\n",  # in the air
        "G1 X10 A30 C0 F500\nX11 A-30 C180\n",  # the axes are commanded
        "M428\nG1 X10 A30 C0 F500\nX11 C40\n",
    ],
)
def test_ordinary_moves_are_not_told(lines: str) -> None:
    assert not found(lines, TRUNNION, "GS212")


ARM = """gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2}}
work_offsets: {G54: {in: world, xyz: [800, 0, 900]}}
orientation: {tool_axis: +X of G54, spin: 0}
tools: {1: {type: ball_end_mill, diameter: 8, flutes: 2, length: 60}}
"""


@pytest.mark.parametrize(
    ("beside", "feed", "expected"),
    [
        (2, 200, ["GS212"]),  # the wrist is straight 2 mm beside the way
        (50, 200, []),
        (2, 6000, ["GS204"]),  # too slow for that turn: one fault, one finding
    ],
)
def test_a_wrist_that_flips_in_a_feed_is_told(beside: float, feed: float, expected: list[str]) -> None:
    job = job_of(f"T1 M6\nG43 H1\nG0 X0 Y-{beside} Z-80\nG1 Z80 F{feed}\n", ARM)
    told = [finding for finding in job.findings if finding.code in ("GS204", "GS212")]
    assert [finding.code for finding in told] == expected
    assert all(finding.span.line == 5 and finding.time is not None for finding in told)


def test_a_wrist_that_flips_in_a_rapid_is_not_told() -> None:
    assert not [f for f in job_of("T1 M6\nG43 H1\nG0 X0 Y-2 Z-80\nG0 Z80\n", ARM).findings if f.code == "GS212"]
