"""A KR 10 with a 3 kg spindle in the world with dynamics: how well the tool of a whole run keeps its path."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gcodesim.canon import ToolChange
from gcodesim.log.reader import read_messages
from gcodesim.units import MM
from tests.physics.runs import Ran, run_texts

CELL = """
gcodesim: 1
robots:
  arm: {{model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], payload: {{mass: 3 kg, xyz: [0, 0, 60]}}}}
work_offsets: {{G54: {{in: world, xyz: [600, 0, 400]}}}}
orientation: {{tool_axis: -Z of G54, spin: free}}
tools:
  1: {{type: flat_end_mill, diameter: 10, length: 80, holder: {{diameter: 40, length: 50}}}}
  2: {{type: ball_end_mill, diameter: 8, length: 70}}
magazine: {{in: world, xyz: [200, 500, 300], pitch: 80, change_time: {change}}}
log: {{period: {period} ms}}
"""

CIRCLE = """G21 G90 G17 G94 G61
T1 M6
G43 H1
G0 X25 Y0 Z0
G3 I-25 F1200
M2
"""


@pytest.fixture(scope="module")
def circle(tmp_path_factory: pytest.TempPathFactory) -> Ran:
    out = tmp_path_factory.mktemp("circle")
    return run_texts(CIRCLE, CELL.format(change="1 s", period=4), out, world="bullet")


def test_a_circle_under_gravity_and_load(circle: Ran) -> None:
    """50 mm at 20 mm/s, not cutting: below 0.002 mm in the mean and 0.01 mm at most, against command and circle."""
    fields = ("pose.position.x", "pose.position.y", "pose.position.z")
    tcp, target = circle.column("/tcp", *fields), circle.column("/target", *fields)
    t = circle.times("/tcp")
    assert circle.job.plan is not None
    row = len(circle.job.plan.path) - 1
    start, end = (float(v[row]) for v in (circle.job.plan.trajectory.row_start, circle.job.plan.trajectory.row_end))
    on = (t >= start) & (t <= end)
    assert end - start == pytest.approx(np.pi * 50.0 / 20.0, rel=0.02)
    late = np.linalg.norm(tcp[on] - target[on], axis=1)
    X_WP = circle.shop.placement.work_offsets[1]
    p_P = (circle.shop.placement.X_WM @ X_WP).inverse().apply(tcp[on])
    off = np.hypot(np.hypot(p_P[:, 0], p_P[:, 1]) - 25.0 * MM, p_P[:, 2])
    for error in (late, off):
        assert error.mean() < 0.002 * MM
        assert error.max() < 0.01 * MM
    assert np.ptp(p_P[:, 0]) == pytest.approx(50.0 * MM, abs=0.02 * MM)
    assert not circle.bad


def poses(log: Path) -> dict[str, np.ndarray]:
    """Rows x y z qx qy qz qw over time of each frame in its parent, by child."""
    rows: dict[str, list[list[float]]] = {}
    for topic in ("/tf", "/tf_static"):
        for _, message in read_messages(log, topic):
            for frame in message.transforms:
                p, q = frame.translation, frame.rotation
                rows.setdefault(frame.child_frame_id, []).append([p.x, p.y, p.z, q.x, q.y, q.z, q.w])
    return {name: np.array(values) for name, values in rows.items()}


def turned(q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Vectors p (n, 3) turned by quaternions q (n, 4)."""
    twice = 2.0 * np.cross(q[:, :3], p)
    return p + q[:, 3:] * twice + np.cross(q[:, :3], twice)


def test_no_gap_between_flange_and_tool(circle: Ran) -> None:
    """The tool sits on the flange at the pose of its length, and the tip of that chain is the one that is logged."""
    assert circle.log is not None
    frames = poses(circle.log)
    tool = frames["tool"]
    changed = np.flatnonzero(np.abs(np.diff(tool, axis=0)).max(axis=1) > 0.0)
    assert len(changed) <= 1  # the tool change
    assert np.abs(tool[-1, :3] - [0.0, 0.0, 0.13]).max() < 1e-12
    flange = frames["arm/flange"]
    tip = flange[:, :3] + turned(flange[:, 3:], tool[:, :3])
    gap = np.linalg.norm(tip - frames["tcp"][:, :3], axis=1)
    assert gap.max() < 1e-9


def test_a_hundred_tool_changes_leave_the_flange_where_it_was(tmp_path: Path) -> None:
    program = "G21 G90\nG53 G0 X500 Y0 Z700\n" + "".join(f"T{1 + i % 2} M6\n" for i in range(100)) + "G4 P0.1\nM2\n"
    ran = run_texts(program, CELL.format(change="40 ms", period=20), tmp_path, world="bullet")
    assert ran.job.plan is not None
    first = min(timed.time for timed in ran.job.plan.trajectory.events if isinstance(timed.event, ToolChange))
    joints = ran.column("/joint_states", *[f"joints[{i}].position" for i in range(6)])
    t = ran.times("/joint_states")
    still = joints[t >= first]
    assert ran.results.times.tool_change == pytest.approx(4.0)
    assert len(still) > 100
    assert np.abs(still - still[0]).max() < 1e-9
