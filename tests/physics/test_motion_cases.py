"""Machine times and motions recorded on LinuxCNC's own planner, and closed forms.

`tests/data/motion/cases.json` says in its own fields what is expected and how
near; the strict tolerance is for planners that follow the same rules, as ours does. `times.json` has further programs
with nothing but their times.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gcodesim.canon import LinearFeed, PathMode
from gcodesim.diagnostics import SourceText, Span
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.curves import Curves
from gcodesim.motion.look_ahead import LookAhead
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.timing import time_law
from gcodesim.motion.trajectory import Trajectory
from gcodesim.rs274 import Settings, interpret

FOLDER = Path(__file__).parents[1] / "data" / "motion"
DATA, MORE = (json.loads((FOLDER / name).read_text()) for name in ("cases.json", "times.json"))
MACHINES = MORE["machines"] | DATA["machines"]
CYCLE = 1e-3  # [s] at which the peaks were recorded
MM = 1e-3
LINUXCNC = LookAhead(blocks=50, corners_count=True)


def limits_of(machine: dict[str, Any]) -> AxisLimits:
    speed, acceleration = np.full(6, np.inf), np.full(6, np.inf)
    for letter, axis in machine["axes"].items():
        i = "XYZABC".index(letter)
        factor = 1.0 if i < 3 else math.pi / 180.0
        speed[i], acceleration[i] = axis["speed"] * factor, axis["acceleration"] * factor
    return AxisLimits(speed=speed, acceleration=acceleration)


def trajectory_of(case: dict[str, Any]) -> Trajectory:
    run = interpret(SourceText("case.ngc", case["gcode"].encode()), Settings())
    path = build_tool_path(run)
    assert run.failed is None
    return time_law(blend(path, limits_of(MACHINES[case["machine"]]), early=True), look_ahead=LINUXCNC)


def moving_time(trajectory: Trajectory) -> tuple[float, float]:
    """From the first move to the end of the last one."""
    p = trajectory.phases
    moving = np.flatnonzero(p.event < 0)
    return float(p.time[moving[0]]), float(p.time[moving[-1]] + p.duration[moving[-1]])


@pytest.mark.parametrize("case", DATA["cases"], ids=lambda case: case["id"])
def test_time_is_that_of_the_recorded_planner(case: dict[str, Any]) -> None:
    start, end = moving_time(trajectory_of(case))
    want = case["expected"]["time_s"]

    allowed = max(case["tolerance_abs_s"], case["tolerance_strict_rel"] * want)

    assert end - start == pytest.approx(want, abs=allowed)


@pytest.mark.parametrize("case", MORE["cases"], ids=lambda case: case["id"])
def test_further_programs_take_as_long(case: dict[str, Any]) -> None:
    """LinuxCNC stands for half of a cycle at each stop, on the mean, which makes 1.3 % in chords of 1 mm."""
    start, end = moving_time(trajectory_of(case))

    assert end - start == pytest.approx(case["time_s"], abs=0.005, rel=0.014)


def in_whole_cycles(trajectory: Trajectory) -> float:
    """How long all motion takes if it needs whole cycles from each stop to the next."""
    p = trajectory.phases
    moving = np.flatnonzero(p.event < 0)
    end_speed = (p.speed + p.acceleration * p.duration)[moving]
    stops = np.flatnonzero((end_speed < 1e-9) & (np.diff(p.piece[moving], append=-1) != 0))
    done = np.cumsum(p.duration[moving])[stops]
    return float(np.ceil(np.diff(done, prepend=0.0) / CYCLE - 1e-6).sum()) * CYCLE


@pytest.mark.parametrize("case", [c for c in MORE["cases"] if c["control"] == "G61"], ids=lambda case: case["id"])
def test_what_linuxcnc_takes_longer_with_stops_is_the_rest_of_a_cycle_at_each(case: dict[str, Any]) -> None:
    """With that its times are had to 3 ms, two of which its joints come later, or 0.15 %."""
    assert in_whole_cycles(trajectory_of(case)) == pytest.approx(case["time_s"], abs=0.003, rel=0.0015)


@pytest.mark.parametrize("case", DATA["cases"] + MORE["cases"], ids=lambda case: case["id"])
def test_axes_stay_within_their_limits(case: dict[str, Any]) -> None:
    trajectory = trajectory_of(case)
    limits = limits_of(MACHINES[case["machine"]])
    t = np.arange(0.0, trajectory.duration + CYCLE, CYCLE)
    speed = np.diff(trajectory.sample(t).position, axis=0) / CYCLE
    acceleration = np.diff(speed, axis=0) / CYCLE

    assert np.all(np.abs(speed).max(axis=0) <= 1.02 * limits.speed)
    assert np.all(np.abs(acceleration).max(axis=0) <= 1.02 * limits.acceleration)


@pytest.mark.parametrize("case", DATA["cases"], ids=lambda case: case["id"])
def test_motion_stays_near_the_programmed_path(case: dict[str, Any]) -> None:
    """Exact modes within 5 um; G64 P: the tolerance, 10 % and 2 um."""
    words = case["control"].split()
    allowed = 0.005 * MM
    if words[0] == "G64":
        allowed = (1.1 * float(words[1][1:]) + 0.002) * MM
    trajectory = trajectory_of(case)
    corners = Curves.of(trajectory.path).polyline(0.2e-6)
    points = trajectory.sample(np.linspace(0.0, trajectory.duration, 1500)).position[:, :3]

    assert farthest(points, corners) <= allowed


def farthest(points: np.ndarray, corners: np.ndarray) -> float:
    """Greatest distance of points (n, 3) from the polyline through corners (m, 3)."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    square = np.maximum((d * d).sum(axis=1), 1e-30)
    worst = 0.0
    for p in points:
        u = np.clip(((p - a) * d).sum(axis=1) / square, 0.0, 1.0)
        worst = max(worst, float(np.min(np.linalg.norm(a + u[:, None] * d - p, axis=1))))
    return worst


@pytest.mark.parametrize("case", DATA["cases"], ids=lambda case: case["id"])
def test_recorded_positions_are_met(case: dict[str, Any]) -> None:
    """Where no rule of time is in dispute (less than 0.3 % off), positions agree along the way, too."""
    recorded = case["expected"]["trajectory"]
    trajectory = trajectory_of(case)
    start, end = moving_time(trajectory)
    want = case["expected"]["time_s"]
    rows = np.array(recorded["rows"])
    t = start + np.arange(len(rows)) * recorded["dt_s"] * (end - start) / want
    columns = ["XYZABC".index(letter) for letter in recorded["axes"]]
    got = trajectory.sample(t).position[:, columns]
    scale = np.where(np.array(columns) < 3, 1e3, 180.0 / math.pi)
    span = np.maximum(np.ptp(rows, axis=0), 1.0)

    assert np.all(np.abs(got * scale - rows).max(axis=0) <= 0.05 * span)


def line(end: float, feed: float) -> LinearFeed:
    return LinearFeed(span=Span("t", 1, 1, 1, 2), end=(end, 0.0, 0.0, 0.0, 0.0, 0.0), feed=feed)


def test_trapezoid_and_triangle() -> None:
    """At 50 mm/s and 400 mm/s²: 100 mm take 2.125 s, 4 mm (never at full speed) 0.2 s."""
    limits = AxisLimits(speed=np.full(6, 1.0), acceleration=np.full(6, 0.4))
    for distance, expected in ((0.1, 2.125), (0.004, 0.2)):
        stop = PathMode(span=Span("t"), mode="exact_stop")
        trajectory = time_law(blend(build_tool_path([stop, line(distance, 0.05)]), limits))

        assert trajectory.duration == pytest.approx(expected, rel=1e-9)


def test_corner_of_a_right_angle() -> None:
    """P 0.02 mm, 80 mm/s, 1500 mm/s²: R = P s / (1 - s) = 0.0482842712475 mm, v = sqrt(0.866 a R)."""
    limits = AxisLimits(speed=np.full(6, 1.0), acceleration=np.full(6, 1.5))
    mode = PathMode(span=Span("t"), mode="blend", tolerance=0.02 * MM)
    up = LinearFeed(span=Span("t", 2, 1, 2, 2), end=(0.01, 0.01, 0.0, 0.0, 0.0, 0.0), feed=0.08)
    pieces = blend(build_tool_path([mode, line(0.01, 0.08), up]), limits)

    radius = float(np.linalg.norm(pieces.curves.radial[pieces.curve[1]]))

    assert radius == pytest.approx(0.0482842712475 * MM, rel=1e-9)
    # the whole acceleration would give 8.51037054841 mm/s; a bend takes sqrt(3)/2 of it
    assert pieces.speed[1] == pytest.approx(8.51037054841 * MM * (3.0**0.5 / 2.0) ** 0.5, rel=1e-9)
