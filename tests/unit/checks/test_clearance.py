"""A program on the gantry past a clamp: rapids in a line and axis by axis, the holder, the place in the work system."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from gcodesim.canon import Event, LinearFeed, Rapid, ToolChange, ToolOffset, WorkSystem
from gcodesim.checks.clearance import Standing, clearance_findings, place_in_system
from gcodesim.checks.collisions import Obstacle
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Pose
from gcodesim.kinematics import MODELS, Cartesian, kinematics_of, load_urdf
from gcodesim.motion.build import build_tool_path
from gcodesim.motion.tool_path import ToolState
from gcodesim.planning import AxisPosing, plan_path
from gcodesim.solids import Box, Cylinder, Placed
from gcodesim.tools.flat_end_mill import FlatEndMill
from gcodesim.tools.sections import Holder
from gcodesim.tools.tool import Tool

ZERO = np.array([0.3, 0.2, -0.3])  # G54 in M
CLAMP = Box(lower=(0.020, 0.024, -0.010), upper=(0.030, 0.032, 0.015))


def at(line: int) -> Span:
    return Span("part.nc", line, 1)


def moved(line: int, x: float, y: float, z: float) -> tuple[float, ...]:
    p = ZERO + np.array([x, y, z])
    return (float(p[0]), float(p[1]), float(p[2]), 0.0, 0.0, 0.0)


def findings_of(
    tool: Tool, moves: list[tuple[str, float, float, float]], rapids: Literal["linear", "independent"] = "linear"
) -> list[Diagnostic]:
    """Findings of moves (G0 or G1, x, y, z in G54 [m]), one a line from line 1 on, with the tool's length in force."""
    chain, _ = load_urdf(MODELS["gantry_xyz"].path)
    assert chain is not None
    offset = (0.0, 0.0, tool.true_length, 0.0, 0.0, 0.0)
    home = (0.0, 0.0, 0.0)
    start = (0.0, 0.0, -tool.true_length, 0.0, 0.0, 0.0)
    events: list[Event] = [
        WorkSystem(span=at(0), index=1, offset=(*map(float, ZERO), 0.0, 0.0, 0.0), g92=(0.0,) * 6, rotation=0.0),
        ToolChange(span=at(0), tool=tool.number),
        ToolOffset(span=at(0), offset=offset),
    ]
    for line, (word, *point) in enumerate(moves, start=1):
        end = moved(line, *point)
        kind = {"span": at(line), "end": end, "block": line, "word": word}
        events.append(Rapid(**kind) if word == "G0" else LinearFeed(**kind, feed=0.01))
    path = build_tool_path(events, start=start)
    posing = AxisPosing(independent_rapids=rapids == "independent")
    frames = {tool.number: tool.X_FT}
    plan = plan_path(path, kinematics_of(chain), posing, home=np.array(home), tool_frames=frames)
    clamp = Obstacle.of("clamp", [Placed(CLAMP, Pose(ZERO, np.eye(3)))])
    return clearance_findings(plan, {tool.number: tool}, [Standing((clamp,))])


T2 = FlatEndMill(number=2, diameter=0.010, length=0.06)
DIAGONAL = [("G0", 0.0, 0.0, 0.05), ("G0", 0.0, 0.0, 0.005), ("G0", 0.1, 0.04, 0.005)]


def test_linear_rapids_pass_the_clamp() -> None:
    """The line from X0 Y0 to X100 Y40 is 11.1 mm from the nearest corner of the clamp, X30 Y24."""
    assert findings_of(T2, DIAGONAL) == []


def test_independent_rapids_do_not() -> None:
    """X and Y run 45 degrees until Y is there: straight through the clamp."""
    (finding,) = findings_of(T2, DIAGONAL, "independent")

    assert finding.code == "GS301"
    assert finding.span.line == 3
    assert "T2" in finding.message and "clamp" in finding.message and "of G54" in finding.message
    assert finding.time is not None and finding.time > 0.0
    x, y = (float(word[1:]) for word in finding.message.split(" at ")[1].split()[:2])
    assert np.hypot(max(20.0 - x, 0.0), max(24.0 - y, 0.0)) == pytest.approx(5.0, abs=2e-3)


def test_the_holder_hits_what_the_cutter_clears() -> None:
    """Slot at Y10 and Z-5 below the clamp's top at 15: a holder that begins 12 mm above the tip is 8 mm too low."""
    tool = FlatEndMill(number=2, diameter=0.010, length=0.012, holder=Holder(diameter=0.04, length=0.08))

    (finding,) = findings_of(
        tool,
        [("G0", -0.05, 0.010, 0.05), ("G1", -0.05, 0.010, -0.005), ("G1", 0.08, 0.010, -0.005)],
    )

    assert (finding.code, finding.span.line) == ("GS303", 3)
    # out upwards by 15 - 7 = 8 mm, or sideways by 20 - 14 = 6 mm: the least counts
    assert finding.value == pytest.approx(6.0, abs=1e-3)


def test_every_visit_is_an_event() -> None:
    moves = [("G0", 0.025, 0.0, 0.05)]
    moves += [("G0", 0.025, 0.028, 0.05), ("G1", 0.025, 0.028, 0.010), ("G0", 0.025, 0.028, 0.05)] * 2

    found = findings_of(T2, moves)

    assert [(f.code, f.span.line) for f in found] == [("GS301", 3), ("GS301", 6)]
    assert [f.value for f in found] == pytest.approx([5.0, 5.0], abs=1e-3)


def test_places_are_told_as_the_program_would_write_them() -> None:
    """G55 shifted, G92 and a rotation of 90 degrees: end = R (program + g92) + offset."""
    state = ToolState(
        system=8, system_offset=(0.1, 0.2, 0.0, 0, 0, 0), g92=(0.01, 0.0, 0.0, 0, 0, 0), rotation=np.pi / 2.0
    )
    program = np.array([0.03, 0.04, 0.05])
    shifted = program + np.array([0.01, 0.0, 0.0])
    end = np.array([-shifted[1] + 0.1, shifted[0] + 0.2, shifted[2]])

    name, point = place_in_system(end, state)

    assert name == "G59.2"
    assert point == pytest.approx(program)


def test_a_round_fixture_is_a_body_too() -> None:
    pin = Cylinder(radius=0.01, bottom=0.0, top=0.05)
    post = Obstacle.of("post", [Placed(pin, Pose.from_xyz_rpy((0.1, 0.0, 0.0)))])

    corners = post.hulls[0].corners
    assert np.hypot(corners[:, 0] - 0.1, corners[:, 1]).min() >= 0.01
    assert (corners[:, 2].min(), corners[:, 2].max()) == (0.0, 0.05)


def test_fixtures_turn_with_the_table_they_stand_on() -> None:
    """A tool stands 50 mm beside the axis of a rotary table; a turn of half a circle brings a clamp to it."""
    chain, _ = load_urdf(MODELS["mill_xyzac_trunnion"].path)
    assert chain is not None
    kinematics = kinematics_of(chain)
    assert isinstance(kinematics, Cartesian)
    length = T2.true_length
    start = (0.05, 0.0, 0.02, 0.0, 0.0, 0.0)
    events: list[Event] = [
        ToolChange(span=at(0), tool=2),
        ToolOffset(span=at(0), offset=(0.0, 0.0, length, 0.0, 0.0, 0.0)),
        LinearFeed(span=at(1), end=(0.05, 0.0, 0.01, 0.0, 0.0, 0.0), feed=0.01, block=1, word="G1"),
        LinearFeed(
            span=at(2),
            end=(0.05, 0.0, 0.01, 0.0, 0.0, np.pi),
            feed=1.0,
            feed_unit="rad/s",
            block=2,
            word="G1",
        ),
    ]
    path = build_tool_path(events, start=start)
    home = np.array([0.05, 0.0, 0.02 + length, 0.0, 0.0])
    plan = plan_path(path, kinematics, AxisPosing(), home=home, tool_frames={2: T2.X_FT})
    clamp = Obstacle.of("clamp", [Placed(Box(lower=(-0.06, -0.005, 0.0), upper=(-0.04, 0.005, 0.02)))])

    still = Standing((clamp,))
    assert clearance_findings(plan, {2: T2}, [still]) == []  # if the clamp stood still, nothing would happen
    (finding,) = clearance_findings(plan, {2: T2}, [Standing((clamp,), kinematics.table)])

    assert (finding.code, finding.span.line) == ("GS301", 2)
    # the tip itself has not moved in the machine: X50 Y0 Z10
    x, y, z = (float(word[1:]) for word in finding.message.split(" at ")[1].split()[:3])
    assert (x, y, z) == pytest.approx((50.0, 0.0, 10.0), abs=2e-3)
    # it meets the clamp's long side at its radius of 5 mm: 10 mm beside the middle, seen from the table
    before = np.arcsin(0.010 / 0.05)
    turned = plan.joints(plan.trajectory.sample(np.array([finding.time])))[0, 4]
    assert np.pi - abs(turned) == pytest.approx(before, abs=0.02)
