"""Waits in a trajectory: what stands between them keeps its own time."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.diagnostics import SourceText
from gcodesim.motion.blend import blend
from gcodesim.motion.build import build_tool_path
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.timing import time_law
from gcodesim.motion.tool_path import ZERO
from gcodesim.motion.trajectory import Trajectory
from gcodesim.motion.waits import with_waits
from gcodesim.rs274 import MappedAction, Settings, interpret

PROGRAM = "G21 F600\nM200\nG1 X10\nX20 Y5\nM200\nG4 P1\nM200\nG1 X0\nM200\nG4 P0.5\nM2\n"


@pytest.fixture
def trajectory() -> Trajectory:
    settings = Settings(m_codes={"M200": MappedAction(target="wait", verb="m")}, has_cell=True)
    path = build_tool_path(interpret(SourceText("p.nc", PROGRAM.encode()), settings).stream(), ZERO)
    return time_law(blend(path, AxisLimits(speed=np.full(6, 0.5), acceleration=np.full(6, 2.0))))


def marks(trajectory: Trajectory) -> list[int]:
    return [index for index, timed in enumerate(trajectory.events) if getattr(timed.event, "target", "") == "wait"]


def test_the_same_way_with_rests_between(trajectory: Trajectory) -> None:
    """At every time the point is where it would be without the waits, at the time without them."""
    waits = dict(zip(marks(trajectory), (0.25, 2.0, 0.0, 4.0), strict=True))
    late = with_waits(trajectory, waits)
    own = np.linspace(0.0, trajectory.duration, 1001)[:-1]
    begins = np.array([trajectory.events[index].time for index in waits])
    seconds = np.array(list(waits.values()))

    shifted = own + (seconds[None] * (begins[None] <= own[:, None])).sum(axis=1)

    assert late.duration == pytest.approx(trajectory.duration + 6.25, abs=1e-12)
    before, after = trajectory.sample(own), late.sample(shifted)
    assert after.position == pytest.approx(before.position, abs=1e-12)
    assert after.velocity == pytest.approx(before.velocity, abs=1e-9)
    assert (after.row == before.row).all()
    assert late.row_time == pytest.approx(trajectory.row_time, abs=1e-12)


def test_it_stands_at_its_event(trajectory: Trajectory) -> None:
    second = marks(trajectory)[1]
    late = with_waits(trajectory, {second: 3.0})
    begin = late.events[second].time

    during = late.sample(begin + np.array([0.1, 1.5, 2.9]))

    assert begin == trajectory.events[second].time
    assert (during.event == second).all()
    assert not during.velocity.any()
    assert during.position[:, :2] == pytest.approx(np.tile([0.02, 0.005], (3, 1)))
    assert np.diff(late.phases.time) == pytest.approx(late.phases.duration[:-1], abs=1e-12)


def test_without_waits_nothing_changes(trajectory: Trajectory) -> None:
    assert with_waits(trajectory, dict.fromkeys(marks(trajectory), 0.0)) is trajectory
