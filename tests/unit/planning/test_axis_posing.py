"""Plans for machine tools: joints, travel, feeds, axes that are not there."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from gcodesim.canon import (
    ArcFeed,
    Axes,
    Dwell,
    Event,
    LinearFeed,
    PathMode,
    Rapid,
    Spindle,
    ToolChange,
    ToolOffset,
    WorkSystem,
)
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.kinematics import Axis, Kinematics, chain_of_axes, kinematics_of
from gcodesim.motion import build_tool_path
from gcodesim.motion.standing import Standstill
from gcodesim.planning import AxisPosing, Plan, plan_path

ZERO: Axes = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def machine(rotary: bool = False) -> Kinematics:
    axes = [
        Axis(letter="X", lower=0.0, upper=1.2, speed=0.5, acceleration=3.0),
        Axis(letter="Y", lower=0.0, upper=0.8, speed=0.5, acceleration=3.0),
        Axis(letter="Z", lower=-0.4, upper=0.0, speed=0.25, acceleration=2.0),
    ]
    if rotary:
        axes.append(Axis(letter="C", speed=3.0, acceleration=10.0, point=(0.0, 0.0, 0.0)))
    return kinematics_of(chain_of_axes(axes))


def at(number: int) -> Span:
    return Span("t", number, 1, number, 2)


def line(number: int, x: float, y: float = 0.1, z: float = -0.1, c: float = 0.0, feed: float = 0.1) -> LinearFeed:
    return LinearFeed(span=at(number), block=number, end=(x, y, z, 0.0, 0.0, c), feed=feed, word="G1")


def planned(*events: Event, rotary: bool = False, rapids: str = "linear", home: tuple[float, ...] = ()) -> Plan:
    kinematics = machine(rotary)
    q = np.array(home or [0.0] * len(kinematics.joints))
    posing = AxisPosing(independent_rapids=rapids == "independent")
    path = build_tool_path(events, posing.start(kinematics, q))
    return plan_path(path, kinematics, posing, home=q, duration_of=Standstill(tool_change=6.0))


def only(plan: Plan, code: str) -> Diagnostic:
    found = [f for f in plan.findings if f.code == code]
    assert len(found) == 1
    return found[0]


def test_joints_are_the_control_point_plus_offset_without_a_jump() -> None:
    tool = ToolOffset(span=at(2), offset=(0.0, 0.0, 0.05, 0.0, 0.0, 0.0))
    change = ToolChange(span=at(2), tool=1)
    lines = (line(3, 0.4, z=-0.2), line(4, 0.5, z=-0.2))
    plan = planned(line(1, 0.2), change, tool, *lines, Dwell(span=at(5), seconds=1))

    t = np.arange(0.0, plan.trajectory.duration + 0.01, 1e-3)
    q = plan.joints(plan.trajectory.sample(t))

    assert np.allclose(q[-1], [0.5, 0.1, -0.15])
    assert np.abs(np.diff(q, axis=0)).max() < 0.5e-3
    assert not len(plan.findings)
    assert plan.trajectory.duration > 7.0


def test_start_is_where_the_joints_are() -> None:
    plan = planned(line(1, 0.3, 0.2, -0.3), home=(0.1, 0.2, -0.3))

    assert np.allclose(plan.joints(plan.trajectory.sample(np.array([0.0])))[0], [0.1, 0.2, -0.3])


def test_rotary_joints_follow_their_letter() -> None:
    plan = planned(line(1, 0.1, c=2.0), rotary=True)

    assert np.allclose(plan.joints(plan.trajectory.sample(np.array([1e9])))[0], [0.1, 0.1, -0.1, 2.0])


def test_travel_is_judged_with_the_tool_and_says_what_fits() -> None:
    system = WorkSystem(span=at(1), index=2, offset=ZERO, g92=ZERO, rotation=0.0)
    tool = ToolOffset(span=at(2), offset=(0.0, 0.0, 0.08, 0.0, 0.0, 0.0))
    plan = planned(system, tool, *(line(k, 0.1, z=z) for k, z in ((3, -0.2), (4, -0.05), (5, -0.03), (6, -0.2))))

    found = only(plan, "GS201")

    assert (found.span.line, found.count, found.unit) == (4, 2, "m")
    # the axis passes 0 when the tip is at -0.08; blocks are run at 0.1 m/s, from rest to rest at their ends
    passed = plan.trajectory.sample(np.array([found.time - 1e-6, found.time]))
    assert (passed.position[:, 2] > -0.08 + 1e-9).tolist() == [False, True]
    assert found.value == pytest.approx(0.03) and found.limit == 0.0
    assert "30.000 mm" in found.message and "tool offset of 80.000 mm" in found.message
    assert "worst 50.000 mm in line 5" in found.hint and "G55 shifted by -50.000 mm in Z" in found.hint


def test_a_program_longer_than_the_travel_has_no_shift() -> None:
    found = only(planned(line(1, 0.1), line(2, 1.4)), "GS201")

    assert "no shift fits" in found.hint and "1300.000 mm" in found.hint


def test_the_bulge_of_an_arc_counts() -> None:
    arc = ArcFeed(
        span=at(2), end=(0.3, 0.1, -0.1, 0.0, 0.0, 0.0), center=(0.2, 0.1, -0.1), normal=(0.0, 0.0, 1.0),
        ccw=True, turns=1, sweep=pi, feed=0.1,
    )  # fmt: skip
    inside = planned(line(1, 0.1, 0.1), arc)  # counterclockwise from the left: through y = 0
    below = planned(line(1, 0.1, 0.05), line(2, 0.3, 0.05), arc_at(0.05))

    assert inside.extremes().least[1] == pytest.approx(0.0)
    assert not len(inside.findings)
    assert only(below, "GS201").value == pytest.approx(-0.05)


def arc_at(y: float) -> ArcFeed:
    return ArcFeed(
        span=at(3), end=(0.1, y, -0.1, 0.0, 0.0, 0.0), center=(0.2, y, -0.1), normal=(0.0, 0.0, 1.0),
        ccw=False, turns=1, sweep=-pi, feed=0.1,
    )  # fmt: skip


def test_extremes_name_their_rows() -> None:
    extremes = planned(line(1, 0.9), line(2, 0.1, 0.7), line(3, 0.5)).extremes()

    assert extremes.most[:2].tolist() == [0.9, 0.7]
    assert extremes.row_of_most[:2].tolist() == [0, 1]
    assert extremes.least.tolist() == [0.0, 0.0, -0.1]


def test_an_axis_that_is_not_there() -> None:
    found = only(planned(line(1, 0.1), line(2, 0.1, c=1.0)), "GS207")

    assert found.span.line == 2 and "C" in found.message


def test_feed_above_the_machine_is_a_note_and_runs_slower() -> None:
    plan = planned(line(1, 0.5, 0.0, 0.0, feed=2.0))

    found = only(plan, "GS206")
    assert "120000 mm/min" in found.message and "30000 mm/min" in found.message
    assert plan.trajectory.sample(np.linspace(0, plan.trajectory.duration, 99)).speed.max() <= 0.5


def test_a_note_of_a_feed_names_the_axis_that_holds_it_up() -> None:
    """3, 4 and 5 along X, Y and Z at 2 m/s: Z needs 2 / sqrt(2) m/s and can do a quarter, X and Y a half."""
    message = only(planned(line(1, 0.03, 0.04, -0.05, feed=2.0)), "GS206").message

    assert message.endswith(
        " 21213 mm/min that the axes allow in this direction: Z would need 84853 mm/min and can do 15000"
    )


@pytest.mark.parametrize(("rpm", "codes"), [(8000.0, ["GS209"]), (7000.0, [])])
def test_a_thread_that_no_axis_can_follow_is_an_error(rpm: float, codes: list[str]) -> None:
    """4 mm at 8,000 rpm are 32 m/min; the axis does 30, so the pitch would be wrong."""
    spindle = Spindle(span=at(1), direction="cw", speed=rpm * pi / 30.0)
    thread = LinearFeed(
        span=at(2), block=2, end=(0.5, 0.0, 0.0, 0.0, 0.0, 0.0), feed=0.0, feed_unit="1/min", pitch=4e-3, word="G33"
    )
    plan = planned(spindle, thread)

    assert [f.code for f in plan.findings if f.code in ("GS206", "GS209")] == codes
    if codes:
        assert "pitch of 4 mm at 8000 rpm needs 32000 mm/min" in only(plan, "GS209").message
        assert only(plan, "GS209").message.endswith("X would need 32000 mm/min and can do 30000")
        assert only(plan, "GS209").hint == "at most 7500 rpm"


def test_no_feed_is_an_error_and_still_ends() -> None:
    plan = planned(line(1, 0.0001, 0.0, 0.0, feed=0.0))

    assert only(plan, "GS208").span.line == 1
    assert plan.trajectory.duration == pytest.approx(6.0, rel=0.01)  # 0.1 mm at 1 mm/min


def test_rapids_can_be_independent() -> None:
    """0.5 m in X and 0.1 m in Y, Z: Y and Z arrive first; the time is that of X alone."""
    rapid = Rapid(span=at(1), end=(0.5, 0.1, -0.1, 0.0, 0.0, 0.0))

    plan = planned(rapid, rapids="independent")
    straight = planned(PathMode(span=at(0), mode="exact_stop"), rapid)

    assert plan.trajectory.duration == pytest.approx(0.5 / 0.5 + 0.5 / 3.0)
    q = plan.joints(plan.trajectory.sample(np.array([0.8])))[0]
    assert q[1] == pytest.approx(0.1) and q[0] < 0.45
    assert straight.trajectory.duration == pytest.approx(plan.trajectory.duration)
