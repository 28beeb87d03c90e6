"""Tool centre point control: the tip keeps to its path and feed, and no joint goes beyond its limits."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim.canon import Axes, Event, LinearFeed, PathMode, PointControl, Rapid, ToolChange, ToolOffset
from gcodesim.diagnostics import Span
from gcodesim.frames import Array, Pose
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.motion import build_tool_path
from gcodesim.planning import AxisPosing, Plan, plan_path
from gcodesim.planning.axis_attitude import AxisAttitude

DATA = Path(__file__).parents[2] / "data" / "five_axis"
LENGTH = 0.06
LINEAR = {"speed": 0.5, "acceleration": 4.0}
ROTARY = {"speed": 3.0, "acceleration": 20.0}
PIVOT = (0.0, 0.0, 0.160)
MACHINES: dict[str, tuple[Axis, Axis]] = {
    "trunnion": (Axis(letter="A", point=(0.0, 0.0, -0.05), **ROTARY), Axis(letter="C", point=(0.0, 0, 0), **ROTARY)),
    "head and table": (
        Axis(letter="B", point=PIVOT, side="tool", vector=(0, -1, 0), **ROTARY),
        Axis(letter="C", point=(0.0, 0.0, 0.0), vector=(0, 0, -1), **ROTARY),
    ),
    "head": (
        Axis(letter="C", point=PIVOT, side="tool", **ROTARY),
        Axis(letter="B", point=PIVOT, side="tool", vector=(0, -1, 0), **ROTARY),
    ),
    "nutating": (
        Axis(letter="B", point=PIVOT, side="tool", vector=(0, 1, 1), **ROTARY),
        Axis(letter="C", point=(0.02, 0.01, 0.0), **ROTARY),
    ),
}


def machine(*rotary: Axis) -> Cartesian:
    return Cartesian(chain=chain_of_axes([*(Axis(letter=letter, **LINEAR) for letter in "XYZ"), *rotary]))


def at(line: int) -> Span:
    return Span("tip.nc", line, 1, line, 2)


def run(name: str, ends: list[Axes], *, mode: Any = "exact_stop", feed: float = 0.03, **more: Any) -> Plan:
    """Lines between `ends` under tool centre point control, from the first of them on."""
    kinematics = machine(*MACHINES[name])
    tool = ToolPoint.of(kinematics)
    assert tool is not None
    offset = (0.0, 0.0, LENGTH, 0.0, 0.0, 0.0)
    home = tool.joints(np.array([ends[0]]), np.array([offset[:3]]))[0]
    events: list[Event] = [
        PathMode(span=at(1), mode=mode, **more),
        ToolChange(span=at(1), tool=1),
        ToolOffset(span=at(1), offset=offset),
        PointControl(span=at(2), on=True, at=ends[0]),
        *(
            LinearFeed(span=at(line), block=line, end=end, feed=feed, word="G1") if line % 7 else
            Rapid(span=at(line), block=line, end=end, word="G0")
            for line, end in enumerate(ends[1:], start=3)
        ),
    ]  # fmt: skip
    posing = AxisAttitude(tool=tool)
    path = build_tool_path(events, posing.start(kinematics, home))
    frames = {1: Pose(np.array([0.0, 0.0, LENGTH]), np.eye(3))}
    return plan_path(path, kinematics, posing, home=home, tool_frames=frames)


def drawn(name: str, count: int = 24) -> list[Axes]:
    rng = np.random.default_rng(len(name))
    letters = [3 + "ABC".index(axis.letter) for axis in MACHINES[name]]
    points = np.zeros((count, 6))
    points[:, :3] = rng.uniform(-0.03, 0.03, (count, 3))
    points[:, letters] = rng.uniform(-0.6, 0.6, (count, 2))
    points[5:9, :3] = points[5, :3]  # only the attitude changes
    points[12:15, 3:] = points[12, 3:]  # only the tip moves
    return [(x, y, z, a, b, c) for x, y, z, a, b, c in points.tolist()]


def sampled(plan: Plan, dt: float = 0.5e-3) -> tuple[Any, Array]:
    samples = plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration, dt))
    return samples, plan.joints(samples)


def tips_in_work(plan: Plan, q: Array, row: Any) -> Array:
    X_BC = plan.kinematics.table(q)
    p = plan.tip(q, row)[:, :3, 3]
    tips: Array = np.einsum("nji,nj->ni", X_BC[:, :3, :3], p - X_BC[:, :3, 3])
    return tips


@pytest.mark.parametrize("name", MACHINES)
def test_the_tip_runs_along_straight_lines_in_the_work_at_its_feed(name: str) -> None:
    plan = run(name, drawn(name))
    samples, q = sampled(plan)

    np.testing.assert_allclose(tips_in_work(plan, q, samples.row), samples.position[:, :3], atol=1e-9)
    path, row = plan.path, samples.row
    way = path.end[row, :3] - path.start[row, :3]
    size = np.linalg.norm(way, axis=1)
    off = np.cross(samples.position[:, :3] - path.start[row, :3], way)[size > 1e-9] / size[size > 1e-9, None]
    assert np.abs(off).max() < 1e-9
    cutting = np.isfinite(path.feed[row]) & (size > 1e-9)
    assert np.linalg.norm(samples.velocity[cutting, :3], axis=1).max() <= 0.03 * (1 + 1e-9)


@pytest.mark.parametrize("mode", ["exact_stop", "exact_path", "blend"])
@pytest.mark.parametrize("name", MACHINES)
def test_no_joint_goes_beyond_its_limits(name: str, mode: str) -> None:
    """Differences of samples 0.5 ms apart: the mean of a speed, and of an acceleration, over that time."""
    more = {"tolerance": 0.5e-3} if mode == "blend" else {}
    plan = run(name, drawn(name), mode=mode, feed=0.3, **more)
    dt = 0.5e-3
    _, q = sampled(plan, dt)
    speed, joints = np.diff(q, axis=0) / dt, plan.kinematics.joints

    assert (np.abs(speed) <= joints.speed * (1.0 + 1e-9)).all()
    if mode != "exact_path":  # there the path has corners that are passed at once
        acceleration = np.diff(speed, axis=0) / dt
        assert (np.abs(acceleration) <= joints.acceleration * (1.0 + 1e-6)).all()
        assert (np.abs(acceleration).max(axis=0) / joints.acceleration).max() > 0.6  # and they are used


@pytest.mark.parametrize(("key", "name", "letters"), [("headhead", "head", "bc"), ("head", "head and table", "bc")])
def test_joints_of_a_dome_are_those_of_linuxcnc(key: str, name: str, letters: str) -> None:
    with (DATA / "blade.csv").open() as file:
        rows = list(csv.DictReader(file))
    told = np.array([[float(row[f"{key}_{letter}"]) for letter in f"xyz{letters}"] for row in rows])
    ends: list[Axes] = []
    for row in rows:
        x, y, z = (float(row[f"tip_{letter}"]) * 1e-3 for letter in "xyz")
        ends.append((x, y, z, 0.0, *np.radians([float(row[f"{key}_b"]), float(row[f"{key}_c"])]).tolist()))
    plan = run(name, ends)
    trajectory = plan.trajectory
    q = plan.joints(trajectory.sample(trajectory.row_end))[:, plan.kinematics.joints.names.index("X") :][:, :3]

    np.testing.assert_allclose(q[:, :2] * 1e3, told[1:, :2], atol=1e-5)
    np.testing.assert_allclose(q[:, 2] * 1e3 - LENGTH * 1e3, told[1:, 2], atol=1e-5)


def test_without_turned_axes_it_is_the_program_of_the_axes() -> None:
    """At zero the tip is the controlled point; both forms have the same joints and nearly the same time."""
    ends: list[Axes] = [(x, y, 0.0, 0.0, 0.0, 0.0) for x, y in ((0, 0), (0.02, 0), (0.02, 0.03), (0, 0))]
    plan = run("trunnion", ends)
    events: list[Event] = [
        PathMode(span=at(1), mode="exact_stop"),
        ToolOffset(span=at(1), offset=(0.0, 0.0, LENGTH, 0.0, 0.0, 0.0)),
        *(LinearFeed(span=at(k), block=k, end=end, feed=0.03, word="G1") for k, end in enumerate(ends[1:], start=3)),
    ]
    kinematics, home = plan.kinematics, np.array([0.0, 0.0, LENGTH, 0.0, 0.0])
    posing = AxisPosing()
    other = plan_path(build_tool_path(events, posing.start(kinematics, home)), kinematics, posing, home=home)

    assert plan.trajectory.duration == pytest.approx(other.trajectory.duration, rel=0.02)


def test_travel_is_that_of_the_joints() -> None:
    low = replace(MACHINES["trunnion"][0], lower=-0.2, upper=0.2)
    MACHINES["narrow"] = (low, MACHINES["trunnion"][1])
    try:
        plan = run("narrow", [(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.01, 0.0, 0.0, 0.3, 0.0, 0.0)])
    finally:
        del MACHINES["narrow"]

    assert [finding.code for finding in plan.findings] == ["GS201"]
    assert plan.extremes().most[3] == pytest.approx(0.3)
