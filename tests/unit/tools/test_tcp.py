"""Bent tools: their tip goes where the program says, in its direction, on arms and on machines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gcodesim
from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Job
from gcodesim.simulation import check, prepare

CELL = """gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid}
frames:
  table: {xyz: [620, -25, 250]}
work_offsets: {G54: {in: table}}
orientation: ORIENTATION
tools:
  1: {type: flat_end_mill, diameter: 8, length: 60}
  2: {type: flat_end_mill, diameter: 8, length: 60, tcp: {xyz: [40, 10, 110], rpy: [0, 50, 20]}}
  3: {type: flat_end_mill, diameter: 8, length: 60, tcp: {xyz: [-60, 0, 100], rpy: [0, -30, 0]}}
"""
PROGRAM = """G21 G90 G17 G61
T1 M6
G0 X0 Y0 Z60
G1 X5 Z5 F3000
T2 M6
G1 X10 Y5 WORDS
G2 X20 Y15 I0 J10
G0 Z60
T3 M6
G0 X0 Y0 Z50
G1 Z2
M2
"""
POINTS = {3: (0, 0, 60), 4: (5, 0, 5), 6: (10, 5, None), 7: (20, 15, None), 10: (0, 0, 50), 11: (0, 0, 2)}


def _job(cell: str, program: str) -> Job:
    loaded = read_cell(SourceText("cell.yaml", cell.encode()), Path("cell.yaml"))
    return prepare(SourceText("program.ngc", program.encode()), loaded)


@pytest.mark.parametrize(
    ("orientation", "words"),
    [
        ("{tool_axis: -Z of G54, spin: free}", ""),
        ("{tool_axis: -Z of G54, spin: 30}", ""),
        ("{tool_axis: -Z of G54, words: Y(B) X(A)}", "A12 B-8"),
    ],
)
def test_the_tip_of_a_bent_tool_is_where_the_program_says(orientation: str, words: str) -> None:
    job = _job(CELL.replace("ORIENTATION", orientation), PROGRAM.replace("WORDS", words))
    assert not [finding for finding in check(job).findings if finding.level.name == "ERROR"]
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    path, trajectory = plan.path, plan.trajectory
    q = plan.joints(trajectory.sample(trajectory.row_end - 1e-9))
    tip = shop.X_BM.inverse().matrix @ plan.tip(q, np.arange(len(path)))
    read = tip[:, :3, 3] - shop.placement.work_offsets[1].p
    down = np.array([0.0, 0.0, -1.0])
    seen = set()
    for row in range(len(path)):
        line = path.span(row).line
        if line in POINTS and (row + 1 == len(path) or path.span(row + 1).line != line):
            seen.add(line)
            for got, want in zip(1e3 * read[row], POINTS[line], strict=True):
                assert want is None or got == pytest.approx(want, abs=1e-5)
            if not words:
                np.testing.assert_allclose(tip[row, :3, 2], down, atol=1e-9)
    assert seen == set(POINTS)


def test_joints_keep_their_speeds_and_do_not_jump_at_a_change_of_bend() -> None:
    job = _job(CELL.replace("ORIENTATION", "{spin: free}"), PROGRAM.replace("WORDS", ""))
    check(job)
    plan = job.plan
    assert plan is not None
    dt = 1e-3
    q = plan.joints(plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, dt)))
    speed = np.abs(np.diff(q, axis=0)) / dt
    assert (speed < 1.02 * plan.kinematics.joints.speed).all()


def test_an_angle_head_mills_a_slot_from_the_side(tmp_path: Path) -> None:
    """40 mm of a slot as wide as the tool, 3 mm deep, with half a circle at each end."""
    (tmp_path / "cell.yaml").write_text(
        "gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n"
        "stock: {box: [100, 60, 20], zero: top-front-left, material: al6082_t6, resolution: 0.25}\n"
        "tools:\n  1: {type: flat_end_mill, diameter: 6, length: 40, tcp: {xyz: [0, 90, 120], rpy: [-90, 0, 0]}}\n"
    )
    (tmp_path / "slot.nc").write_text(
        "G21 G90\nT1 M6\nS10000 M3\nG0 Y80\nG0 X20 Z-8\nG1 Y57 F300\nG1 X60\nG0 Y70\nM5\nM2\n"
    )
    results = gcodesim.simulate(tmp_path / "slot.nc", tmp_path / "cell.yaml")
    assert not [finding for finding in results.findings if finding.level.name != "NOTE"]
    stock = results.as_json()["stocks"]["stock"]
    assert stock["removed_mm3"] == pytest.approx(3.0 * (40.0 * 6.0 + np.pi * 9.0), abs=stock["error_bound_mm3"])
