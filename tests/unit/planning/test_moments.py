"""When findings about a path happen: where a limit is passed, not where the block begins."""

from __future__ import annotations

from math import asin, cos, pi

import numpy as np
import pytest

from gcodesim.canon import ArcFeed, Axes, Event, LinearFeed, PathMode
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.kinematics import Axis, chain_of_axes, kinematics_of
from gcodesim.motion import build_tool_path
from gcodesim.planning import AxisPosing, Plan, plan_path

FEED, LIMIT, PULL = 0.05, 0.2, 1.0  # [m/s], [m], [m/s²]
"""Of all lines; where the travel of X ends; acceleration."""
PATH = PathMode(span=Span("t", 1, 1, 1, 2), mode="exact_stop", tolerance=0.0)


def at(number: int) -> Span:
    return Span("t", number, 1, number, 2)


def line(number: int, x: float, y: float = 0.0, block: int | None = None) -> LinearFeed:
    end: Axes = (x, y, 0.0, 0.0, 0.0, 0.0)
    return LinearFeed(span=at(number), block=number if block is None else block, end=end, feed=FEED)


def planned(*events: Event) -> Plan:
    ends = {"X": LIMIT, "Y": 0.5, "Z": 0.5}
    axes = [
        Axis(letter=letter, lower=-0.5, upper=upper, speed=1.0, acceleration=PULL) for letter, upper in ends.items()
    ]
    kinematics = kinematics_of(chain_of_axes(axes))
    posing = AxisPosing()
    home = np.zeros(3)
    return plan_path(build_tool_path(events, posing.start(kinematics, home)), kinematics, posing, home=home)


def only(plan: Plan) -> Diagnostic:
    (found,) = [f for f in plan.findings if f.code == "GS201"]
    assert found.time is not None
    return found


def test_a_straight_move_passes_its_limit_on_the_way() -> None:
    """From rest: half a ramp, then the feed; the limit is 1 mm before the end of the move, or 150 mm."""
    ramp = FEED / PULL
    for beyond in (0.001, 0.15):
        plan = planned(PATH, line(2, 0.1), line(3, LIMIT + beyond))
        way = LIMIT - 0.1
        brake = max(0.0, 0.5 * FEED * ramp - beyond)  # of the way into the ramp at the end
        late = (ramp - (2.0 * beyond / PULL) ** 0.5) - brake / FEED if brake else 0.0  # slower than at the feed
        assert only(plan).time == pytest.approx(plan.trajectory.row_start[1] + 0.5 * ramp + way / FEED + late, abs=1e-7)
        assert only(plan).value == pytest.approx(LIMIT + beyond)


def test_an_arc_passes_its_limit_where_its_bulge_does() -> None:
    radius, centre = 0.05, LIMIT - 0.03
    arc = ArcFeed(
        span=at(3), block=3, end=(centre, radius, 0.0, 0.0, 0.0, 0.0), center=(centre, 0.0, 0.0),
        normal=(0.0, 0.0, 1.0), ccw=True, turns=1, sweep=pi, feed=FEED,
    )  # fmt: skip
    plan = planned(PATH, line(2, centre, -radius), arc)

    turned = asin(0.03 / radius)  # the arc begins at its lowest point
    when = np.array([only(plan).time])
    place = plan.trajectory.sample(when).position[0]
    assert place[:2] == pytest.approx([LIMIT, -radius * cos(turned)], abs=1e-8)


def test_of_a_line_that_is_run_again_and_again_it_is_the_time_at_which_it_goes_too_far() -> None:
    """As in a loop with increments: the same place of the program, another block each time."""
    plan = planned(PATH, *(line(2, 0.06 * k, block=k) for k in range(1, 6)))

    assert plan.trajectory.row_start[3] < (only(plan).time or 0.0) < plan.trajectory.row_end[3]


def test_where_a_corner_is_cut_before_the_limit_it_is_the_time_at_which_it_is_nearest() -> None:
    blend = PathMode(span=at(1), mode="blend", tolerance=2e-3)
    plan = planned(blend, line(2, LIMIT + 1e-6), line(3, LIMIT + 1e-6, 0.1), line(4, 0.0, 0.1))

    found = only(plan)
    t = np.linspace(0.0, plan.trajectory.duration, 20001)
    x = plan.trajectory.sample(t).position[:, 0]
    assert found.span == at(2)
    assert x.max() > LIMIT  # along the second line
    begin, end = plan.trajectory.row_start[0], plan.trajectory.row_end[0]
    assert begin <= (found.time or 0.0) <= end
    own = x[(t >= begin) & (t <= end)].max()
    assert plan.trajectory.sample(np.array([found.time])).position[0, 0] == pytest.approx(own, abs=1e-5)
