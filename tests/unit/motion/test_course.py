"""Which way a path goes ahead: lines, arcs, corners, roundings, and places where it goes nowhere in the plane."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from gcodesim.canon import ArcFeed, Dwell, Event, LinearFeed, PathMode
from gcodesim.motion.course import Bend
from gcodesim.motion.trajectory import Trajectory
from tests.unit.motion.test_trajectory import at, line, run

ONWARD = 1e-3


def arc(x: float, y: float, centre: tuple[float, float], sweep: float) -> ArcFeed:
    return ArcFeed(
        span=at(1), end=(x, y, 0.0, 0.0, 0.0, 0.0), center=(*centre, 0.0), normal=(0.0, 0.0, 1.0), ccw=sweep > 0,
        turns=1, sweep=sweep, feed=0.1,
    )  # fmt: skip


def down(x: float, y: float, z: float) -> LinearFeed:
    return LinearFeed(span=at(1), end=(x, y, z, 0.0, 0.0, 0.0), feed=0.1)


def bends(trajectory: Trajectory, t: np.ndarray, onward: float = ONWARD) -> Bend:
    samples = trajectory.sample(t)
    return trajectory.course.bends(samples.piece, samples.s, onward)


def turns(bend: Bend) -> np.ndarray:
    """How much it turns to the left (n,) [1/m]."""
    first, second = bend.first, bend.second
    across = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    return np.arctan2(across, np.sum(first[:, :2] * second[:, :2], axis=1)) / bend.way


def moments(trajectory: Trajectory, number: int = 200) -> np.ndarray:
    return np.linspace(0.0, trajectory.duration, number)


@pytest.mark.parametrize("left", [1.0, -1.0])
def test_an_arc_turns_as_its_radius_says_up_to_its_end(left: float) -> None:
    """Also where less of it is left than is looked ahead: there is a corner behind it."""
    events: list[Event] = [
        PathMode(span=at(1), mode="exact_path", tolerance=0.0),
        arc(5e-3, left * 5e-3, (0.0, left * 5e-3), left * pi / 2),
    ]
    trajectory = run(*events, down(5e-3, left * 5e-3, 0.05))
    on_arc = moments(trajectory)[trajectory.sample(moments(trajectory)).position[:, 2] < 1e-9]
    on_arc = on_arc[on_arc < trajectory.row_time[1] - 1e-6]

    assert len(on_arc) > 5
    assert turns(bends(trajectory, on_arc)) == pytest.approx(left * 200.0, rel=1e-6)


def test_a_line_into_an_arc_turns_by_the_share_that_is_on_it() -> None:
    events: list[Event] = [
        PathMode(span=at(1), mode="exact_path", tolerance=0.0),
        line(10e-3),
        arc(15e-3, 5e-3, (10e-3, 5e-3), pi / 2),
    ]
    trajectory = run(*events)
    t = moments(trajectory, 2000)
    x = trajectory.sample(t).position[:, 0]
    near = t[(x > 9.0e-3) & (x < 10e-3)]
    left = 10e-3 - trajectory.sample(near).position[:, 0]

    assert turns(bends(trajectory, near)) == pytest.approx(200.0 * (ONWARD - left) / ONWARD, abs=1e-6)


@pytest.mark.parametrize("mode", ["exact_path", "blend"])
def test_nothing_is_seen_of_what_lies_behind_a_corner(mode: str) -> None:
    """The rounding of a blend is a corner, too."""
    way = PathMode(span=at(1), mode=mode, tolerance=1e-5 if mode == "blend" else 0.0)  # type: ignore[arg-type]
    trajectory = run(way, line(10e-3), line(10e-3, 10e-3))
    t = moments(trajectory, 2000)
    x, y = trajectory.sample(t).position[:, :2].T
    straight = bends(trajectory, t[((x < 9.9e-3) & (y == 0.0)) | (y > 0.1e-3)])

    assert turns(straight) == pytest.approx(0.0, abs=1e-9)
    assert (straight.way >= 0.5 * ONWARD - 1e-12).all()


def test_a_path_that_goes_nowhere_and_a_dwell() -> None:
    trajectory = run(Dwell(span=at(1), seconds=0.5))
    bend = bends(trajectory, np.array([0.0, 0.25]))

    assert np.isfinite(bend.first).all()
    assert bend.way.tolist() == [0.0, 0.0]


def test_rotary_moves_have_no_direction() -> None:
    turning = LinearFeed(span=at(1), end=(0.0, 0.0, 0.0, 0.0, 0.0, 1.0), feed=1.0, feed_unit="rad/s")
    trajectory = run(turning, LinearFeed(span=at(2), end=(5e-3, 0.0, 0.0, 0.0, 0.0, 1.0), feed=0.1))
    bend = bends(trajectory, np.array([0.5 * trajectory.row_time[1], trajectory.duration - 0.02]))

    assert bend.first[0].tolist() == [0.0, 0.0, 0.0]
    assert bend.first[1] == pytest.approx([1.0, 0.0, 0.0])
