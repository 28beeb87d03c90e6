"""After G28 an arm goes on from its home in joints, where the control has to know that it stands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.cell.loader import read_cell
from gcodesim.diagnostics import SourceText
from gcodesim.simulation import prepare

CELL = """gcodesim: 1
DIALECT
robots: {arm: {model: kuka_kr10_r1100_2}}
work_offsets: {G54: {in: world, xyz: [700, 0, 300]}}
tools: {1: {type: flat_end_mill, diameter: 8, flutes: 2, length: 60}}
"""


@pytest.mark.parametrize("home", ["G28", "G91 G28 Z0\nG90"])
@pytest.mark.parametrize(("dialect", "unit"), [("linuxcnc", 1.0), ("linuxcnc", 25.4), ("fanuc", 1.0)])
def test_a_feed_after_home_begins_there(home: str, dialect: str, unit: float) -> None:
    if dialect == "fanuc" and home == "G28":
        home = "G91 G28 X0 Y0\nG90"  # it wants to know which axes
    loaded = read_cell(SourceText("cell.yaml", CELL.replace("DIALECT", f"dialect: {dialect}").encode()), Path("a.yaml"))
    length = "G43 H1" if dialect == "linuxcnc" else "G43 H1 Z1."
    lines = [
        f"G90 G94 {'G20' if unit > 1.0 else 'G21'}",
        "T1 M6",
        length,
        "G0 X0 Y0 Z1.",
        home,
        "G1 X0.5 Y0 Z1. F30.",
        "M30",
    ]
    job = prepare(SourceText("a.nc", "\n".join(lines).encode()), loaded)
    assert job.plan is not None, [finding.message for finding in job.findings]
    path, kinematics = job.plan.path, job.plan.kinematics
    (feed,) = np.flatnonzero(np.isfinite(path.feed))
    flange = path.start[feed, :3] + np.array([0.0, 0.0, 0.06])

    assert not [finding for finding in job.findings if finding.code.startswith("GS2")]
    assert kinematics.forward(job.shop.home[None])[0, :3, 3] == pytest.approx(flange, abs=1e-9)  # type: ignore[union-attr]
    t = np.arange(0.0, job.plan.trajectory.duration, 1e-3)
    q = job.plan.joints(job.plan.trajectory.sample(t))
    assert (np.abs(np.diff(q, axis=0)) / 1e-3 <= kinematics.joints.speed * (1 + 1e-6)).all()
