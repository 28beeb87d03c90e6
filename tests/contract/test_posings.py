"""What every posing promises: a start, joints that put the tip where the program says, and no guesses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gcodesim.canon import Event, LinearFeed, PathMode, Rapid, ToolChange, ToolOffset
from gcodesim.diagnostics import Span
from gcodesim.frames import Array, Pose, rotation_about
from gcodesim.kinematics import Kinematics, kinematics_of, load_urdf, model_path
from gcodesim.kinematics.attitude import WordTurn, WordTurns
from gcodesim.kinematics.cartesian import Axis, Cartesian, chain_of_axes
from gcodesim.kinematics.tool_point import ToolPoint
from gcodesim.motion import build_tool_path
from gcodesim.motion.tool_path import Commanded, ToolPath
from gcodesim.planning import AxisPosing, FixedAttitude, Plan, Posing, plan_path
from gcodesim.planning.axis_attitude import AxisAttitude

MODELS = ("gantry_xyz", "kuka_kr10_r1100_2")
TURNED = Pose(np.array([0.1, -0.05, 0.02]), rotation_about(np.array([0.0, 0.0, 1.0]), 0.3))
TRUNNION = "trunnion"


def _trunnion() -> Cartesian:
    linear = [Axis(letter=letter, speed=0.5, acceleration=3.0) for letter in "XYZ"]
    rotary = [Axis(letter=letter, speed=2.0, acceleration=9.0, point=(0.0, 0.0, -0.1)) for letter in "AC"]
    return Cartesian(chain=chain_of_axes([*linear, *rotary]))


MEMBERS: dict[str, tuple[str, Posing, Array]] = {
    "axes": (MODELS[0], AxisPosing(), np.array([0.2, 0.2, -0.1])),
    "axes, each rapid": (MODELS[0], AxisPosing(independent_rapids=True), np.array([0.2, 0.2, -0.1])),
    "fixed attitude": (MODELS[1], FixedAttitude(), np.radians([0, -90, 90, 0, 90, 0])),
    "fixed attitude, turned work": (
        MODELS[1],
        FixedAttitude(upright=TURNED.R, X_BM=TURNED, spin=0.5),
        np.radians([0, -90, 90, 0, 90, 0]),
    ),
}
LEANING = WordTurns(turns=(WordTurn(axis=2, word=0, sign=1.0), WordTurn(axis=1, word=1, sign=-1.0)))
MEMBERS["words that lean"] = (
    MODELS[1],
    FixedAttitude(law=LEANING, words_lean=True),
    np.radians([0, -90, 90, 0, 90, 0]),
)
MEMBERS["axes and tip"] = (TRUNNION, AxisAttitude(tool=ToolPoint(_trunnion())), np.zeros(5))
LENGTH = 0.06


def machine(model: str) -> Kinematics:
    if model == TRUNNION:
        return _trunnion()
    chain, _ = load_urdf(model_path(model))
    assert chain is not None
    return kinematics_of(chain)


def planned(name: str) -> Plan:
    """A square of 20 mm beside the place where the machine starts, with a tool whose length is taken into account."""
    model, posing, home = MEMBERS[name]
    kinematics = machine(model)
    start = posing.start(kinematics, home)
    x, y, z = start[0], start[1], start[2] - 0.1

    def end(dx: float, dy: float) -> tuple[float, float, float, float, float, float]:
        return (x + dx, y + dy, z, 0.0, 0.0, 0.0)

    def at(line: int) -> Span:
        return Span("square.nc", line, 1, line, 2)

    events: list[Event] = [
        PathMode(span=at(1), mode="exact_stop"),
        ToolChange(span=at(1), tool=1),
        ToolOffset(span=at(1), offset=(0.0, 0.0, LENGTH, 0.0, 0.0, 0.0)),
        Rapid(span=at(2), block=2, end=end(0.0, 0.0), word="G0"),
        *(
            LinearFeed(span=at(line), block=line, end=end(dx, dy), feed=0.02, word="G1")
            for line, (dx, dy) in enumerate(((0.02, 0.0), (0.02, 0.02), (0.0, 0.02), (0.0, 0.0)), start=3)
        ),
    ]
    path = build_tool_path(events, start)
    frames = {1: Pose(np.array([0.0, 0.0, LENGTH]), np.eye(3))}
    return plan_path(path, kinematics, posing, home=home, tool_frames=frames)


@pytest.mark.parametrize("name", MEMBERS)
def test_the_tip_is_where_the_program_puts_it(name: str) -> None:
    plan = planned(name)
    feed = np.flatnonzero(plan.path.feed < np.inf)
    t = plan.trajectory.row_end[feed]
    tips = plan.tip(plan.joints(plan.trajectory.sample(t)), feed)

    assert len(feed) == 4
    assert np.abs(tips[:, :3, 3] - plan.path.end[feed, :3]).max() < 1e-9


@pytest.mark.parametrize("name", MEMBERS)
def test_joints_begin_at_home_and_go_on_without_a_jump(name: str) -> None:
    plan = planned(name)
    home = MEMBERS[name][2]
    t = np.arange(0.0, plan.trajectory.duration, 2e-3)
    q = plan.joints(plan.trajectory.sample(t))

    assert np.allclose(q[0], home, atol=1e-9)
    speed = plan.kinematics.joints.speed
    assert np.all(np.abs(np.diff(q, axis=0)) / 2e-3 <= 1.02 * np.minimum(speed, 1e6))


@pytest.mark.parametrize("name", MEMBERS)
def test_what_it_does_not_understand_is_refused(name: str) -> None:
    model, posing, home = MEMBERS[name]
    path = ToolPath.from_points(np.array([[0.4, 0.0, 0.4], [0.5, 0.0, 0.4]]), feed=0.1)
    foreign = next(control for control in Commanded if control not in posing.understands)
    path = replace(path, states=tuple(replace(state, control=foreign) for state in path.states))

    with pytest.raises(ValueError, match=f"cannot be commanded by {foreign}"):
        plan_path(path, machine(model), posing, home=home)
