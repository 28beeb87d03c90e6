"""An arm that works in systems which lean against each other: tip and axis of the tool go by the one in force."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import check, prepare

CELL = """gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}
frames:
  table: {xyz: [650, 0, 400], rpy: TABLE}
work_offsets:
  G54: {in: table}
  G55: {in: table, xyz: [0, -30, -20], rpy: [60, 0, 10]}
  G56: {in: table, xyz: [-30, 0, -20], rpy: [0, -40, 0]}
tools:
  1: {type: flat_end_mill, diameter: 8, length: 60}
  2: {type: flat_end_mill, diameter: 8, length: 90}
"""
PROGRAM = """G21 G90 G17 G61
T1 M6
G54 G0 X0 Y0 Z60
G1 Z5 F3000
G0 Z60
G55 X0 Y0 Z50
G1 X3 Y4 Z5
Z50
T2 M6
G91 G1 Z1
G90 Z10
G56 G0 X0 Y0 Z60
G1 Z5
Z60
G54 G0 X0 Y0 Z70
M2
"""


@pytest.mark.parametrize("table", ["[0, 0, 0]", "[0, 20, 30]"])
def test_tip_and_tool_follow_the_system(table: str) -> None:
    loaded = read_cell(SourceText("cell.yaml", CELL.replace("TABLE", table).encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.ngc", PROGRAM.encode()), loaded)
    assert not [finding for finding in check(job).findings if finding.level.name == "ERROR"]
    plan, shop = job.plan, job.shop
    assert plan is not None and shop is not None
    path, trajectory = plan.path, plan.trajectory
    q = plan.joints(trajectory.sample(trajectory.row_end - 1e-9))
    X_BF = plan.kinematics.forward(q)
    lengths, points = {1: 0.060, 2: 0.090}, {4: (0, 0, 5), 7: (3, 4, 5), 11: (None, None, 10), 13: (0, 0, 5)}
    for row in range(len(path)):
        state, wanted = path.state_of(row), points.get(path.span(row).line)
        if wanted is None:
            continue
        tip = X_BF[row, :3, 3] + lengths[state.tool] * X_BF[row, :3, 2]
        X_PB = (shop.X_BM @ shop.placement.work_offsets[state.system]).inverse()
        read = 1e3 * X_PB.apply(tip)
        for got, want in zip(read, wanted, strict=True):
            assert want is None or got == pytest.approx(want, abs=1e-6)
        np.testing.assert_allclose(X_PB.R @ X_BF[row, :3, 2], [0, 0, -1], atol=1e-9)


def test_a_change_of_length_moves_the_tip_along_the_tool() -> None:
    """The arm does not jump when the tool changes, so the next block begins where it stands."""
    loaded = read_cell(SourceText("cell.yaml", CELL.replace("TABLE", "[0, 0, 0]").encode()), Path("cell.yaml"))
    job = prepare(SourceText("program.ngc", PROGRAM.encode()), loaded)
    plan = job.plan
    assert plan is not None
    samples = plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, 1e-3))
    p = plan.kinematics.forward(plan.joints(samples))[:, :3, 3]
    assert np.linalg.norm(np.diff(p, axis=0), axis=1).max() < 5e-3
