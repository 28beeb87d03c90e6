"""G43.4: what the reader says when the tip is commanded, with the law of a trunnion A C and without any."""

from __future__ import annotations

import math

import pytest

from gcodesim.cell.tool_point import MachinePoint
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint


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
