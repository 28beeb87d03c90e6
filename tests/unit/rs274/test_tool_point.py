"""G43.4: what the reader says when the tip is commanded, with the law of a trunnion A C and without any."""

from __future__ import annotations

import math

import pytest

from gcodesim.cell.tool_point import MachinePoint
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.rs274 import MappedAction


@pytest.fixture
def fanuc(program):
    return lambda *lines, **settings: program("%\nO0001\n" + "\n".join(lines) + "\n%\n", dialect="fanuc", **settings)


def trunnion() -> MachinePoint:
    axes = [Axis(letter=letter) for letter in "XYZ"]
    axes += [Axis(letter="A", point=(0.0, 0.0, -0.02)), Axis(letter="C", point=(0.0, 0.0, 0.0))]
    tool = ToolPoint.of(Cartesian(chain=chain_of_axes(axes)))
    assert tool is not None
    return MachinePoint(tool)


def test_without_a_cell_the_tip_is_listed(fanuc):
    done = fanuc("T1 M06", "G43.4 H1", "G01 X5. A10. F100.", "X6. C-90.", "G49", "M30")

    assert not done.errors and not done.run.not_simulated
    assert [end[0] for end in done.ends] == [5, 6]
    assert [event["on"] for event in done.acts("point_control")] == [True, False]


def test_on_and_off_leave_the_axes_where_they_are(fanuc):
    """Tip X0 Y-10 Z0 with A30: the tool of 50 mm stands on the cradle's axis 20 mm below zero."""
    lines = ("T1 M06", "G43.4 H1", "G01 X0. Y-10. Z0. A30. F100.", "G49", "G01 X1. F100.", "M30")
    done = fanuc(*lines, has_cell=True, tool_point=trunnion())

    tip, after = done.acts("line")
    y = -10 * 0.5 * 3**0.5 - 20 * 0.5
    z = -10 * 0.5 + 20 * 0.5 * 3**0.5 - 20
    assert tip["end"] == pytest.approx([0, -10, 0, 30, 0, 0])
    assert after["end"] == pytest.approx([1, y, z + 50, 30, 0, 0], abs=1e-6)


def test_machine_coordinates_are_those_of_the_axes(fanuc):
    lines = ("T1 M06", "G43.4 H1", "G01 X0. Y-10. Z0. A30. F100.", "G53 G00 Z80.", "G01 Z0.", "M30")
    done = fanuc(*lines, has_cell=True, tool_point=trunnion())

    switches = [event["on"] for event in done.acts("point_control")]
    assert switches == [True, False, True]
    rapid = done.acts("rapid")[0]["end"]
    assert rapid[2] == pytest.approx(80 - 50)
    x, y, z = (v * 1e-3 for v in done.acts("point_control")[-1]["at"][:3])
    axes = trunnion().axes((x, y, z, math.radians(30.0), 0.0, 0.0), (0.0, 0.0, 0.05, 0.0, 0.0, 0.0))
    assert axes[2] == pytest.approx(0.08)


def test_a_vector_turns_the_tool_by_the_shorter_way(fanuc):
    """Along X, leaning by 30 degrees: A30 C90 of a trunnion; then on over the pole, where C stays."""
    lines = ("G01 X5. I1. K1.7320508075688772 F100.", "X6.", "X7. K1.", "X8. I-1. K1.7320508075688772")
    done = fanuc("T1 M06", "G43.5 H1", *lines, "M30", has_cell=True, tool_point=trunnion())

    assert not done.errors
    want = ((5, 30, 90), (6, 30, 90), (7, 0, 90), (8, -30, 90))
    assert [event["end"] for event in done.acts("line")] == [
        pytest.approx([x, 0, -50, a, 0, c], abs=1e-6) for x, a, c in want
    ]


def test_a_vector_counts_in_the_tilted_plane(fanuc):
    lines = ("G68.2 I90. J30. K0.", "G43.5 H1", "G01 X5. I0. J0. K1. F100.", "M30")
    done = fanuc("T1 M06", *lines, has_cell=True, tool_point=trunnion())

    assert not done.errors
    assert done.acts("line")[0]["end"][3:] == pytest.approx([30, 0, 90])


@pytest.mark.parametrize(
    ("line", "settings", "code"),
    [
        ("G01 X1. A5. F100.", {}, "GS106"),
        ("G01 X1. I0. J0. K0. F100.", {}, "GS106"),
        ("G01 X1. I1. K1. F100.", {"has_cell": True}, "GS915"),
    ],
)
def test_what_is_no_vector_is_refused(fanuc, line, settings, code):
    done = fanuc("T1 M06", "G43.5 H1", line, "M30", **settings)

    assert [(f.code, f.span.line) for f in done.errors] == [(code, 5)]


LINUXCNC = ("T1 M6", "G43 H1", "M428", "G1 X0 Y-10 Z0 A30 F100", "M429", "G1 X1", "M2")


@pytest.mark.parametrize("lane", ["grammar", "compiled"])
def test_linuxcnc_switches_its_kinematics(program, lane):
    """M428 holds the tip, M429 commands the axes, which stay where they are: as G43.4 and G49 at the same length."""
    done = program("\n".join(LINUXCNC) + "\n", lane=lane, has_cell=True, tool_point=trunnion())

    assert not done.errors and not done.run.not_simulated
    tip, after = done.acts("line")
    y = -10 * 0.5 * 3**0.5 - 20 * 0.5
    z = -10 * 0.5 + 20 * 0.5 * 3**0.5 - 20
    assert tip["end"] == pytest.approx([0, -10, 0, 30, 0, 0])
    assert after["end"] == pytest.approx([1, y, z, 30, 0, 0], abs=1e-6)
    assert [event["on"] for event in done.acts("point_control")] == [True, False]


def test_a_cell_may_map_what_linuxcnc_switches_with(program):
    done = program(
        "M428\nM2\n", has_cell=True, tool_point=trunnion(), m_codes={"M428": MappedAction(target="door", verb="open")}
    )
    assert [event["verb"] for event in done.acts("action")] == ["open"] and not done.acts("point_control")


def test_a_machine_that_turns_nothing_does_not_switch(program):
    done = program("M428\nM2\n", has_cell=True)
    assert not done.errors and list(done.run.not_simulated) == ["M428"]


def test_other_controls_do_not_know_it(program):
    done = program("M428\nM2\n", dialect="grbl")
    assert [one.code for one in done.errors] == ["GS013"]
