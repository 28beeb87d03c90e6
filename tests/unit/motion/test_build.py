"""Canonical events become rows; states, stops and offsets follow."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from gcodesim.api import read
from gcodesim.canon import (
    Action,
    Axes,
    Coolant,
    Dwell,
    Event,
    LinearFeed,
    Message,
    Output,
    PathMode,
    ProbeMove,
    Rapid,
    Spindle,
    SplineFeed,
    Tap,
    ToolChange,
    ToolOffset,
    ToolSelect,
    WorkSystem,
)
from gcodesim.diagnostics import Span
from gcodesim.frames import Pose, rotation_about
from gcodesim.motion import build_tool_path
from gcodesim.motion.tool_path import EXACT_PATH, EXACT_STOP, HOME, LINE, RAPID
from gcodesim.rs274 import Settings

AT = Span("t", 1, 1, 1, 2)
ZERO: Axes = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def point(x: float, y: float = 0.0, z: float = 0.0) -> Axes:
    return (x, y, z, 0.0, 0.0, 0.0)


def line(x: float, y: float = 0.0, z: float = 0.0, **more: object) -> LinearFeed:
    return LinearFeed(**{"span": AT, "end": point(x, y, z), "feed": 0.1, "word": "G1"} | more)  # type: ignore[arg-type]


def spindle(direction: str = "cw", speed: float = 20 * pi) -> Spindle:
    return Spindle(span=AT, direction=direction, speed=speed)  # type: ignore[arg-type]


def test_rows_follow_each_other() -> None:
    path = build_tool_path([Rapid(span=AT, end=point(1)), line(2), line(2, 3)], point(0.5))

    assert list(path.kind) == [RAPID, LINE, LINE]
    assert path.start[:, 0].tolist() == [0.5, 1.0, 2.0]
    assert np.isinf(path.feed[0])
    assert path.stop.tolist() == [False, False, True]


@pytest.mark.parametrize(
    ("event", "stands"),
    [
        (Dwell(span=AT, seconds=1.0), True),
        (Dwell(span=AT, seconds=0.0), False),
        (ToolChange(span=AT, tool=2), True),
        (spindle(), True),
        (Coolant(span=AT, flood=True, mist=False), True),
        (Output(span=AT, type="digital", index=1, value=1.0, with_motion=False), True),
        (Output(span=AT, type="digital", index=1, value=1.0, with_motion=True), False),
        (Action(span=AT, m=10, p=None, q=None, target="tool", verb="activate"), True),
        (ToolOffset(span=AT, offset=point(0, 0, 0.1)), True),
        (Message(span=AT, text="hello"), False),
        (ToolSelect(span=AT, tool=3), False),
        (PathMode(span=AT, mode="blend", tolerance=1e-4), False),
    ],
)
def test_what_makes_the_machine_stand_still(event: Event, stands: bool) -> None:
    path = build_tool_path([line(1), event, line(2)])

    assert bool(path.stop[0]) is stands
    assert [(e.row, e.event) for e in path.events] == [(1, event)]


def test_state_of_each_row() -> None:
    events = [
        ToolChange(span=AT, tool=3), spindle("ccw", 5.0), Coolant(span=AT, flood=True, mist=False), line(1),
        spindle("off", 5.0), WorkSystem(span=AT, index=2, offset=point(9), g92=ZERO, rotation=0.5), line(2),
    ]  # fmt: skip

    path = build_tool_path(events)

    first, second = path.state_of(0), path.state_of(1)
    assert (first.tool, first.spindle, first.flood, first.system, first.word) == (3, -5.0, True, 1, "G1")
    assert (second.spindle, second.system, second.rotation) == (0.0, 2, 0.5)


def test_actions_switch_the_tool() -> None:
    def act(verb: str) -> Action:
        return Action(span=AT, m=10, p=None, q=None, target="tool", verb=verb)

    path = build_tool_path([line(1), act("activate"), line(2), act("deactivate"), line(3)])

    assert path.active.tolist() == [False, True, False]


def test_a_new_offset_moves_the_controlled_point_not_the_axes() -> None:
    path = build_tool_path([line(1), ToolOffset(span=AT, offset=point(0, 0, 0.2)), line(1, 0, 0.0), line(2)])

    assert path.start[1].tolist() == [1, 0, -0.2, 0, 0, 0]
    assert path.start[2].tolist() == [1, 0, 0.0, 0, 0, 0]


def test_feed_per_revolution_and_thread_pitch() -> None:
    path = build_tool_path(
        [spindle(speed=20 * pi), line(1, feed=0.001, feed_unit="m/rev"), line(2, pitch=0.002, feed=0.0)]
    )

    assert path.feed == pytest.approx([0.01, 0.02])
    assert path.stop.tolist() == [True, True]  # threading waits for the spindle


def test_feed_per_revolution_without_spindle_is_zero() -> None:
    assert build_tool_path([line(1, feed=0.001, feed_unit="m/rev")]).feed.tolist() == [0.0]


def test_a_tap_goes_down_and_up_with_the_spindle_reversed() -> None:
    tap = Tap(span=AT, end=point(0, 0, -0.01), pitch=0.001)

    path = build_tool_path([spindle(speed=20 * pi), tap])

    assert path.end[:, 2].tolist() == [-0.01, 0.0]
    assert path.feed == pytest.approx([0.01, 0.01])
    assert [path.state_of(i).spindle for i in (0, 1)] == pytest.approx([20 * pi, -20 * pi])
    assert path.stop.all()


def test_a_probe_stands_before_and_after_and_is_an_event() -> None:
    probe = ProbeMove(span=AT, end=point(1, 1), feed=0.01, word="G38.2")

    path = build_tool_path([line(1), probe, line(3)])

    assert path.stop.tolist() == [True, True, True]
    assert [(e.row, e.event) for e in path.events] == [(1, probe)]
    assert path.state_of(1).word == "G38.2"


def test_a_spline_is_short_lines_of_one_block() -> None:
    spline = SplineFeed(
        span=AT, end=point(2), block=7, points=((0, 0, 0), (1, 0.1, 0), (2, 0, 0)), control_points=(), feed=0.1
    )

    path = build_tool_path([spline])

    assert path.end[:, :2].tolist() == [[1, 0.1], [2, 0]]
    assert path.block.tolist() == [7, 7]


def test_path_modes() -> None:
    events = [
        PathMode(span=AT, mode="exact_stop"), line(1), PathMode(span=AT, mode="exact_path"), line(2),
        PathMode(span=AT, mode="blend", tolerance=1e-4), line(3),
        PathMode(span=AT, mode="blend", tolerance=1e-4, naive=5e-5), line(4),
    ]  # fmt: skip

    path = build_tool_path(events)

    assert path.mode[:2].tolist() == [EXACT_STOP, EXACT_PATH]
    assert path.stop.tolist() == [True, False, False, True]
    assert path.naive.tolist() == [0.0, 0.0, 1e-4, 5e-5]


def test_home_moves_are_marked() -> None:
    assert build_tool_path([Rapid(span=AT, end=ZERO, home="G28")]).kind.tolist() == [HOME]


def test_a_tilted_system_turns_points_about_its_origin_but_not_machine_moves() -> None:
    tilt = Pose(np.array([1.0, 0, 0]), rotation_about(np.array([0.0, 1, 0]), pi / 2))
    events = [line(1, 0, 0), line(2, 0, 0), Rapid(span=AT, end=point(0, 0, 5), word="G53 G0")]

    path = build_tool_path(events, tilts={1: tilt})

    assert np.allclose(path.end[:, :3], [[1, 0, 0], [1, 0, -1], [0, 0, 5]])


def test_rapids_end_at_rest_where_the_control_has_it_so(tmp_path) -> None:
    """Read block by block, and as a batch by the compiled lane."""
    for blocks in (4, 2000):
        program = tmp_path / "p.nc"
        program.write_text("G21 G90\n" + "G0 X1. Y1.\nZ-1.\nG1 X2. F100.\nX3.\n" * (blocks // 4) + "M30\n")
        for dialect in ("fanuc", "linuxcnc"):
            path = read(program, Settings(dialect=dialect))
            rapid = path.kind == RAPID
            assert rapid.any() and not rapid.all()
            assert (path.stop == (rapid if dialect == "fanuc" else False))[:-1].all()
