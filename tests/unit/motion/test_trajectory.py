"""The time law and its samples: closed forms, and random programs under all rules."""

from __future__ import annotations

from dataclasses import fields, replace
from math import pi

import numpy as np
import pytest

from gcodesim.canon import (
    ArcFeed,
    Coolant,
    Dwell,
    Event,
    LinearFeed,
    Message,
    PathMode,
    Rapid,
    ToolChange,
)
from gcodesim.diagnostics import Span
from gcodesim.motion import ToolPath, build_tool_path
from gcodesim.motion.blend import blend
from gcodesim.motion.pieces import AxisLimits
from gcodesim.motion.standing import Standstill
from gcodesim.motion.timing import Caps, time_law
from gcodesim.motion.timing_kernels import end_speeds
from gcodesim.motion.trajectory import Trajectory
from tests.effort import growth

LIMITS = AxisLimits(
    speed=np.array([0.5, 0.4, 0.25, 3.0, 3.0, 6.0]), acceleration=np.array([3.0, 2.5, 2.0, 10.0, 10.0, 20.0])
)


def at(number: int) -> Span:
    return Span("t", number, 1, number, 2)


def line(x: float, y: float = 0.0, feed: float = 0.1, number: int = 1) -> LinearFeed:
    return LinearFeed(span=at(number), end=(x, y, 0.0, 0.0, 0.0, 0.0), feed=feed)


def run(*events: Event, tool_change_time: float = 0.0) -> Trajectory:
    return time_law(blend(build_tool_path(events), LIMITS), duration_of=Standstill(tool_change=tool_change_time))


def random_program(seed: int) -> list[Event]:
    """Lines, arcs, rapids, rotary moves and stops in all path modes, sizes from 10 um to 0.1 m."""
    rng = np.random.default_rng(seed)
    events: list[Event] = []
    point = np.zeros(6)
    for i in range(60):
        span = at(i + 1)
        size = 10.0 ** rng.uniform(-5, -1)
        kind = rng.integers(0, 12)
        feed = float(10.0 ** rng.uniform(-2.5, -0.3))
        if kind == 0:
            modes = ("exact_stop", "exact_path", "blend", "blend")
            tolerance = float(10.0 ** rng.uniform(-5, -3)) if rng.random() < 0.7 else 0.0
            chosen = modes[rng.integers(0, 4)]
            events.append(PathMode(span=span, mode=chosen, tolerance=tolerance if chosen == "blend" else 0.0))  # type: ignore[arg-type]
        elif kind == 1:
            events.append(Dwell(span=span, seconds=float(rng.uniform(0, 0.3))))
        elif kind == 2:
            events.append(Coolant(span=span, flood=True, mist=False))
        elif kind == 3:
            point = point + np.append(rng.normal(size=3) * size, np.zeros(3))
            events.append(Rapid(span=span, end=tuple(point)))
        elif kind in (4, 5):
            start = point.copy()
            angle, sweep = rng.uniform(0, 2 * pi), float(rng.uniform(-2 * pi, 2 * pi))
            center = start[:2] + size * np.array([np.cos(angle), np.sin(angle)])
            c, s = np.cos(sweep), np.sin(sweep)
            d = start[:2] - center
            point = point.copy()
            point[:2] = center + np.array([c * d[0] - s * d[1], s * d[0] + c * d[1]])
            point[2] += size * rng.integers(0, 2)
            events.append(
                ArcFeed(
                    span=span, end=tuple(point), center=(center[0], center[1], point[2]), normal=(0.0, 0.0, 1.0),
                    ccw=sweep > 0, turns=1, sweep=sweep, feed=feed,
                )
            )  # fmt: skip
        elif kind == 6:
            point = point + np.append(rng.normal(size=3) * size, rng.normal(size=3))
            events.append(LinearFeed(span=span, end=tuple(point), feed=feed))
        elif kind == 7:
            point = point + np.append(np.zeros(3), rng.normal(size=3))
            events.append(LinearFeed(span=span, end=tuple(point), feed=1.0, feed_unit="rad/s"))
        else:
            flat = rng.integers(0, 3)
            step = rng.normal(size=3) * size * (np.arange(3) != flat)
            point = point + np.append(step, np.zeros(3))
            events.append(LinearFeed(span=span, end=tuple(point), feed=feed))
    return events


@pytest.mark.parametrize("independent", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_random_programs_keep_all_rules(seed: int, independent: bool) -> None:
    path = build_tool_path(random_program(seed))

    trajectory = time_law(blend(path, LIMITS, independent_rapids=independent))

    dt = 2e-4
    t = np.arange(0.0, trajectory.duration + 3 * dt, dt)
    samples = trajectory.sample(t)
    step = np.diff(samples.position, axis=0)
    speed = step / dt
    # continuous, within limits, and the velocity is the derivative of the position
    assert np.all(np.abs(speed) <= 1.001 * LIMITS.speed)
    # a bend or kink may use the share of a cycle of 1 ms at once
    acceleration = (speed[5:] - speed[:-5]) / (5 * dt)
    assert np.all(np.abs(acceleration) <= 1.02 * LIMITS.acceleration)
    middle = trajectory.sample(t[:-1] + 0.5 * dt).velocity
    assert np.abs(middle - speed).max() <= 0.6 * dt * LIMITS.acceleration.max() + 0.1e-3 * LIMITS.acceleration.max()
    # ends where the program ends
    assert np.allclose(samples.position[-1], path.end[-1], atol=1e-12)
    # rows come in order and all rows have their time
    assert np.all(np.diff(samples.row) >= 0)
    assert np.all(trajectory.row_end >= trajectory.row_start)
    assert np.all(trajectory.row_start[1:] >= trajectory.row_end[:-1] - 1e-15)


@pytest.mark.parametrize("seed", range(4))
def test_rows_and_rests_add_up_to_the_duration(seed: int) -> None:
    trajectory = time_law(blend(build_tool_path(random_program(seed)), LIMITS))

    start, end = trajectory.row_ns
    rests = sum(round((e.time + e.duration) * 1e9) - round(e.time * 1e9) for e in trajectory.events)

    assert int((end - start).sum()) + rests == pytest.approx(trajectory.duration_ns, abs=len(trajectory.events))
    gaps = np.append(start[1:], trajectory.duration_ns) - end
    assert start[0] + gaps.sum() + (end - start).sum() == trajectory.duration_ns


def test_events_have_their_times_and_the_machine_stands() -> None:
    trajectory = run(
        Message(span=at(1), text="begin"), ToolChange(span=at(2), tool=1), PathMode(span=at(3), mode="exact_path"),
        line(0.1, number=4), Coolant(span=at(5), flood=True, mist=False), Dwell(span=at(6), seconds=0.5),
        Message(span=at(7), text="after"), line(0.2, number=8), Dwell(span=at(9), seconds=0.25), tool_change_time=6.0,
    )  # fmt: skip
    one = 0.1 / 0.1 + 0.1 / 3.0

    times = {e.event.span.line: (e.time, e.duration) for e in trajectory.events}

    assert times[2] == (0.0, 6.0)
    assert times[1] == (0.0, 0.0)
    assert times[5] == pytest.approx((6.0 + one, 0.0))
    assert times[6] == pytest.approx((6.0 + one, 0.5))
    assert times[7] == pytest.approx((6.5 + one, 0.0))
    assert times[9] == pytest.approx((6.5 + 2 * one, 0.25))
    assert trajectory.duration == pytest.approx(6.75 + 2 * one)
    resting = trajectory.sample(np.array([3.0, 6.0 + one + 0.2]))
    assert np.all(resting.velocity == 0.0) and np.all(resting.event >= 0)
    assert resting.position[:, 0].tolist() == pytest.approx([0.0, 0.1])
    assert trajectory.sample(np.array([7.0])).event.tolist() == [-1]


def test_totals_add_up_to_the_duration() -> None:
    rapid = Rapid(span=at(3), end=(0.1, 0.0, 0.0, 0.0, 0.0, 0.0))
    events = (ToolChange(span=at(2), tool=1), rapid, line(0.3), Dwell(span=at(9), seconds=0.25), line(0.3, 0.2))
    trajectory = run(*events, tool_change_time=6.0)

    totals = trajectory.totals

    assert (totals.tool_change, totals.dwell) == (6.0, 0.25)
    assert totals.rapid == pytest.approx(0.1 / 0.5 + 0.5 / 3.0)
    assert (totals.feed_distance, totals.rapid_distance) == pytest.approx((0.4, 0.1))
    parts = totals.feed + totals.rapid + totals.dwell + totals.tool_change
    assert parts == pytest.approx(trajectory.duration, rel=1e-12)


def test_a_program_that_only_waits() -> None:
    trajectory = run(Dwell(span=at(1), seconds=2.0))

    assert trajectory.duration == 2.0
    assert trajectory.sample(np.array([0.0, 1.0, 5.0])).position.tolist() == [[0.0] * 6] * 3


def test_an_empty_program() -> None:
    trajectory = run()

    assert trajectory.duration == 0.0
    assert len(trajectory.sample(np.array([0.0, 1.0]))) == 2


def test_boundaries_are_where_pieces_end() -> None:
    trajectory = run(PathMode(span=at(1), mode="exact_stop"), line(0.1), line(0.2))
    one = 0.1 / 0.1 + 0.1 / 3.0

    assert trajectory.boundaries(0.0, 10.0) == pytest.approx([one])
    assert len(trajectory.boundaries(one + 1e-9, 10.0)) == 0


def test_merged_chords_share_their_time_among_their_rows() -> None:
    events = [PathMode(span=at(1), mode="blend", tolerance=1e-5)]
    trajectory = run(*events, *(line(0.01 * k, number=k) for k in range(1, 11)))

    assert len(trajectory.pieces) == 1
    assert trajectory.row_time.sum() == pytest.approx(trajectory.duration)
    assert trajectory.row_time[4] == pytest.approx(0.1, rel=1e-9)
    assert trajectory.sample(np.array([trajectory.duration / 2 - 1e-3])).row.tolist() == [4]


def test_finer_caps_slow_down_in_places() -> None:
    """A piece of 1 m in four segments of which the second is capped: the closed form of its ramps."""
    pieces = blend(build_tool_path([PathMode(span=at(1), mode="exact_path"), line(1.0, feed=0.4)]), LIMITS)
    quarter = np.full(4, 0.25)
    caps = Caps(
        np.zeros(4, dtype=np.int64), np.arange(4) * 0.25, quarter, np.array([0.4, 0.1, 0.4, 0.4]), np.full(4, 2.0),
        np.array([np.inf, np.inf, np.inf, 0.0]),
    )  # fmt: skip

    trajectory = time_law(pieces, caps)

    up, between, down = 0.4 / 2.0, 0.3 / 2.0, 0.4 / 2.0
    first = up + between + (0.25 - 0.04 - 0.0375) / 0.4
    last = between + down + (0.5 - 0.0375 - 0.04) / 0.4
    assert trajectory.duration == pytest.approx(first + 2.5 + last)
    assert trajectory.sample(np.linspace(0, trajectory.duration, 999)).speed.max() == pytest.approx(0.4)


def test_look_ahead_agrees_with_a_slow_twin() -> None:
    rng = np.random.default_rng(2)
    n = 300
    length, speed = rng.uniform(1e-4, 1e-2, n), rng.uniform(0.01, 0.5, n)
    acceleration, junction = rng.uniform(0.5, 3.0, n), rng.uniform(0.0, 0.6, n)
    ratio, fixed = np.ones(n), np.zeros(n, dtype=bool)

    start, end = end_speeds(length, speed, acceleration, junction, ratio, fixed)

    v = np.minimum(np.append(junction[:-1], 0.0), np.minimum(speed, np.append(speed[1:], 0.0)))
    v = np.concatenate([[0.0], v])
    for _ in range(n):  # relaxes to the greatest speeds that all ramps allow
        for k in range(n):
            ramp = 2 * acceleration[k] * length[k]
            v[k + 1] = min(v[k + 1], np.sqrt(v[k] ** 2 + ramp))
            v[k] = min(v[k], np.sqrt(v[k + 1] ** 2 + ramp))
        if np.allclose(start, v[:-1], atol=1e-12):
            break
    assert np.allclose(start, v[:-1], atol=1e-12) and np.allclose(end, v[1:], atol=1e-12)


def test_many_short_blocks() -> None:
    """200,000 blocks are joined and timed; eight times the blocks are about eight times the work."""
    rng = np.random.default_rng(1)
    points = np.cumsum(rng.normal(size=(200_001, 3)) * 1e-4, axis=0)

    def timed(count: int) -> Trajectory:
        return time_law(blend(ToolPath.from_points(points[: count + 1], feed=0.1), LIMITS))

    trajectory = timed(200_000)

    assert growth(timed, 25_000, 8, 24) < 24  # 64 where each block looks at all others
    assert trajectory.row_time.sum() == pytest.approx(trajectory.duration)
    assert trajectory.row_time.min() > 0.0


@pytest.mark.parametrize("jerk", [False, True])
def test_rates_are_those_of_the_samples_to_the_bit(jerk: bool) -> None:
    for seed in range(8):
        trajectory = run(*random_program(seed))
        rng = np.random.default_rng(seed)
        if jerk:
            drawn = rng.normal(size=len(trajectory.phases.time)) * 10.0 ** rng.uniform(-2, 4)
            trajectory = replace(trajectory, phases=replace(trajectory.phases, jerk=drawn))
        times = np.sort(np.concatenate([rng.uniform(-1.0, trajectory.duration + 1.0, 3000), trajectory.phases.time]))
        samples, rates = trajectory.sample(times), trajectory.rates(times)
        for name in rates._fields:
            assert getattr(rates, name).tobytes() == getattr(samples, name).tobytes(), name
        which = np.sort(rng.integers(0, len(times), 50))
        some, picked = trajectory.sample(times[which]), samples.at(which)
        for column in fields(some):
            assert getattr(some, column.name).tobytes() == getattr(picked, column.name).tobytes(), column.name


def test_a_path_without_moves_has_rates() -> None:
    samples, rates = run().sample(np.zeros(2)), run().rates(np.zeros(2))
    assert all((getattr(rates, name) == getattr(samples, name)).all() for name in rates._fields)
