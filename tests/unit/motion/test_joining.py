"""Trajectories of legs joined: the motion of both, one after the other, and events where they were."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.canon import Dwell, Event, LinearFeed, Message
from gcodesim.diagnostics import Span
from gcodesim.motion import build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.joining import joined, standing_until, with_instant
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.standing import Standstill
from gcodesim.motion.timing import time_law
from gcodesim.motion.tool_path import ToolPath
from gcodesim.motion.trajectory import Trajectory

LIMITS = AxisLimits(speed=np.full(6, 0.5), acceleration=np.full(6, 2.0))
HERE = Span("leg.nc", 1, 1, 1, 2)


def line(number: int, x: float, y: float = 0.0) -> LinearFeed:
    return LinearFeed(span=HERE, block=number, end=(x, y, 0.0, 0.0, 0.0, 0.0), feed=0.1, word="G1")


def leg(start: float, *events: Event) -> Trajectory:
    path = build_tool_path(events, (start, 0.0, 0.0, 0.0, 0.0, 0.0))
    return time_law(blend(path, LIMITS), duration_of=Standstill(tool_change=1.0))


def both(one: Trajectory, other: Trajectory) -> Trajectory:
    events = (line(1, 0.1), line(2, 0.1, 0.05), line(3, 0.2), line(4, 0.3, 0.02))
    path = build_tool_path(events, (0.0,) * 6)
    assert len(path) == len(one.path) + len(other.path)
    return joined(one, other, path)


FIRST = leg(0.0, line(1, 0.1), line(2, 0.1, 0.05), line(3, 0.2))
SECOND = leg(0.2, line(4, 0.3, 0.02))


def test_times_go_on_and_positions_are_those_of_each() -> None:
    whole = both(FIRST, SECOND)
    assert whole.duration == pytest.approx(FIRST.duration + SECOND.duration, abs=1e-12)

    t = np.linspace(0.0, whole.duration, 400)
    samples = whole.sample(t)
    early = t < FIRST.duration
    assert np.array_equal(samples.position[early], FIRST.sample(t[early]).position)
    late = SECOND.sample(t[~early] - FIRST.duration)
    assert np.allclose(samples.position[~early], late.position, atol=1e-12)
    assert np.array_equal(samples.row[~early], late.row + len(FIRST.path))


def test_rows_have_the_times_of_their_legs() -> None:
    whole = both(FIRST, SECOND)
    assert np.array_equal(whole.row_start[:3], FIRST.row_start)
    assert whole.row_start[3] == pytest.approx(FIRST.duration) and whole.row_end[3] == pytest.approx(whole.duration)


def test_a_leg_that_only_waits_stands_where_the_one_before_ended() -> None:
    waiting = leg(0.2, Dwell(span=HERE, seconds=0.7))
    whole = joined(FIRST, waiting, FIRST.path)
    rest = whole.sample(np.array([FIRST.duration + 0.35]))

    assert whole.duration == pytest.approx(FIRST.duration + 0.7)
    assert rest.position[0, :2] == pytest.approx([0.2, 0.0]) and rest.speed[0] == 0.0


def test_standing_for_an_event_takes_its_time_and_an_instant_takes_none() -> None:
    message = Message(span=HERE, text="touched")
    end = FIRST.duration + 0.25
    stood = standing_until(FIRST, end, message)

    assert stood.duration == pytest.approx(end)
    assert stood.events[-1].event is message and stood.events[-1].duration == pytest.approx(0.25)
    assert np.allclose(stood.sample(np.array([end - 0.1])).position[0, :2], [0.2, 0.0])

    told = with_instant(FIRST, 0.5, message)
    assert told.duration == FIRST.duration and told.events[-1].time == 0.5 and told.events[-1].duration == 0.0


def test_nothing_before_and_something_after() -> None:
    empty = leg(0.0)
    whole = joined(empty, FIRST, FIRST.path)
    t = np.linspace(0.0, FIRST.duration, 50)

    assert isinstance(whole.path, ToolPath) and np.array_equal(whole.sample(t).position, FIRST.sample(t).position)
