"""Plans for arms: the tip follows the program, joints keep their limits, and faults are named."""

from __future__ import annotations

from functools import cache
from math import pi
from pathlib import Path

import numpy as np
import pytest

from gcodesim.canon import Axes, Dwell, Event, LinearFeed, PathMode, Rapid, ToolChange, ToolOffset, WorkSystem
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.frames import Pose, rotation_about
from gcodesim.kinematics import Kinematics, kinematics_of, load_urdf, model_path
from gcodesim.kinematics.protocol import Status
from gcodesim.motion import build_tool_path
from gcodesim.planning import FixedAttitude, Plan, plan_path
from gcodesim.planning.loads import Loads
from gcodesim.planning.reach import why

HOME = np.radians([0.0, -90.0, 90.0, 0.0, 90.0, 0.0])
ZERO: Axes = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
DT = 2e-3


@cache
def arm() -> Kinematics:
    chain, _ = load_urdf(model_path("kuka_kr10_r1100_2"))
    assert chain is not None
    return kinematics_of(chain)


def at(number: int) -> Span:
    return Span("t", number, 1, number, 2)


def line(number: int, x: float, y: float, z: float, feed: float = 0.1) -> LinearFeed:
    return LinearFeed(span=at(number), block=number, end=(x, y, z, 0.0, 0.0, 0.0), feed=feed, word="G1")


def rapid(number: int, x: float, y: float, z: float, home: str = "") -> Rapid:
    return Rapid(span=at(number), block=number, end=(x, y, z, 0.0, 0.0, 0.0), word="G0", home=home)


def planned(
    *events: Event,
    posing: FixedAttitude = FixedAttitude(),  # noqa: B008
    tilts: dict[int, Pose] | None = None,
    tool_frames: dict[int, Pose] | None = None,
) -> Plan:
    path = build_tool_path(events, posing.start(arm(), HOME), tilts=tilts)
    return plan_path(path, arm(), posing, home=HOME, tool_frames=tool_frames)


def sampled(plan: Plan) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples' positions, joints and flange poses, every `DT`."""
    samples = plan.trajectory.sample(np.arange(0.0, plan.trajectory.duration + DT, DT))
    q = plan.joints(samples)
    return samples, q, arm().forward(q)  # type: ignore[return-value]


def only(plan: Plan, code: str) -> Diagnostic:
    found = [f for f in plan.findings if f.code == code]
    assert len(found) == 1
    return found[0]


SQUARE = (
    PathMode(span=at(1), mode="blend", tolerance=0.2e-3),
    rapid(2, 0.6, 0.0, 0.35),
    line(3, 0.6, 0.0, 0.3),
    line(4, 0.7, 0.0, 0.3, feed=0.3),
    line(5, 0.7, 0.1, 0.3, feed=0.3),
    line(6, 0.6, 0.1, 0.3, feed=0.3),
    rapid(7, 0.6, 0.1, 0.4),
)


def test_the_flange_follows_the_path_with_the_tool_down() -> None:
    plan = planned(*SQUARE)

    samples, q, X = sampled(plan)

    cartesian = ~plan.trajectory.pieces.fixed[samples.piece]
    assert np.abs(X[cartesian, :3, 3] - samples.position[cartesian, :3]).max() < 1e-9
    assert np.allclose(X[cartesian][:, :3, 2], [0, 0, -1])
    assert not len(plan.findings)
    assert np.allclose(q[0], HOME)


def test_joints_keep_their_limits_of_speed_and_acceleration() -> None:
    plan = planned(*(e if not isinstance(e, LinearFeed) else line(e.span.line, *e.end[:3], feed=5.0) for e in SQUARE))

    _, q, _ = sampled(plan)
    speed = np.diff(q, axis=0) / DT
    acceleration = np.diff(speed, axis=0) / DT

    joints = arm().joints
    assert np.all(np.abs(speed) <= 1.01 * joints.speed)
    assert np.all(np.abs(acceleration) <= 1.02 * joints.acceleration)
    assert np.abs(acceleration / joints.acceleration).max() > 0.9  # and are made use of


def test_fine_chords_give_no_false_alarm() -> None:
    """Corner arcs and what they leave of the lines may be micrometres long: no joint is asked to hurry."""
    x = np.linspace(0.55, 0.65, 101)
    chords = [line(k, u, 0.0, 0.3 + 0.001 * np.sin(40 * u), feed=0.04) for k, u in enumerate(x, start=3)]

    plan = planned(PathMode(span=at(1), mode="blend", tolerance=5e-6), rapid(2, 0.54, 0.0, 0.3), *chords)

    assert not len(plan.findings)
    assert plan.trajectory.totals.feed == pytest.approx(0.11 / 0.04, rel=0.05)


def test_windows_give_the_same_joints_as_the_whole() -> None:
    plan = planned(*SQUARE)
    samples, q, _ = sampled(plan)

    parts = [plan.joints(plan.trajectory.sample(part)) for part in np.array_split(samples.time, 7)]

    assert np.abs(np.concatenate(parts) - q).max() < 1e-9


def test_results_do_not_depend_on_how_many_rows_are_looked_at_together(monkeypatch: pytest.MonkeyPatch) -> None:
    """Through a singularity, where the rates of a segment are bounded by those of its neighbours."""
    moves = [line(k, 0.6, 0.002 * (k - 50), 0.3 + 0.01 * (k % 2), feed=2.0) for k in range(3, 100)]
    posing = FixedAttitude(loads=Loads(chain=arm().chain))  # type: ignore[attr-defined]
    plans = []
    for rows in (4096, 7):
        monkeypatch.setattr("gcodesim.arithmetic.batches.AT_ONCE", rows)
        plans.append(planned(rapid(2, 0.6, -0.094, 0.3), *moves, posing=posing))
    whole, parts = (plan.trajectory.phases for plan in plans)
    assert len(whole.time) > 200
    assert all(getattr(whole, name).tobytes() == getattr(parts, name).tobytes() for name in ("time", "speed", "s"))


def test_tool_length_pulls_the_flange_back_and_the_tip_stays() -> None:
    length = 0.08
    tool = (ToolChange(span=at(1), tool=3), ToolOffset(span=at(1), offset=(0.0, 0.0, length, 0.0, 0.0, 0.0)))
    frames = {3: Pose(np.array([0.0, 0.0, length]), np.eye(3))}

    plan = planned(*tool, *SQUARE, tool_frames=frames)

    samples, q, X = sampled(plan)
    cartesian = ~plan.trajectory.pieces.fixed[samples.piece]
    tips = plan.tip(q, samples.row)
    assert np.abs(tips[cartesian, :3, 3] - samples.position[cartesian, :3]).max() < 1e-9
    assert np.allclose(X[cartesian, 2, 3] - tips[cartesian, 2, 3], length)


def test_the_first_feed_gets_a_move_that_turns_the_tool_first() -> None:
    plan = planned(Dwell(span=at(1), seconds=0.5), line(2, 0.6, 0.0, 0.6))

    assert len(plan.path) == 2
    assert [(e.time, e.row) for e in plan.trajectory.events] == [(0.0, 0)]
    samples, q, X = sampled(plan)
    assert np.allclose(q[0], HOME)
    assert np.allclose(X[-1, :3, 3], [0.6, 0.0, 0.6])
    assert samples.row[-1] == 1


def test_home_moves_end_at_home_and_the_next_move_starts_there() -> None:
    plan = planned(*SQUARE, rapid(8, 0.0, 0.0, 0.0, home="G28"), Dwell(span=at(9), seconds=0.1), rapid(10, 0.6, 0, 0.4))

    samples, q, _ = sampled(plan)

    resting = samples.event >= 0
    assert np.allclose(q[resting], HOME)
    assert np.abs(np.diff(q, axis=0)).max() <= 1.01 * (arm().joints.speed * DT).max()


def test_independent_rapids_are_joint_moves() -> None:
    linear, independent = planned(*SQUARE), planned(*SQUARE, posing=FixedAttitude(joint_rapids=True))

    assert independent.trajectory.pieces.fixed.sum() == 2
    assert linear.trajectory.pieces.fixed.sum() == 1


def test_a_tilted_system_tilts_the_tool() -> None:
    tilt = Pose(np.array([0.6, 0.0, 0.3]), rotation_about(np.array([0.0, 1.0, 0.0]), 0.3))
    system = WorkSystem(span=at(1), index=2, offset=ZERO, g92=ZERO, rotation=0.0)

    plan = planned(system, *SQUARE, tilts={2: tilt}, posing=FixedAttitude(frames={2: tilt.R}))

    samples, _, X = sampled(plan)
    cartesian = ~plan.trajectory.pieces.fixed[samples.piece]
    assert np.allclose(X[cartesian][:, :3, 2], -tilt.R[:, 2])
    assert np.abs(X[cartesian, :3, 3] - samples.position[cartesian, :3]).max() < 1e-9
    assert np.allclose(plan.path.end[-1, :3], tilt.p + tilt.R @ (np.array([0.6, 0.1, 0.4]) - tilt.p))


def test_a_given_spin_is_kept() -> None:
    plan = planned(*SQUARE, posing=FixedAttitude(spin=pi / 2))

    samples, _, X = sampled(plan)
    cartesian = ~plan.trajectory.pieces.fixed[samples.piece]
    # the tool looks down; a quarter turn about its Z brings its X to B's -Y
    assert np.allclose(X[cartesian][:, :3, 0], [0, -1, 0], atol=1e-9)


def circle(radius: float, z: float, first: float, last: float) -> list[LinearFeed]:
    angles = enumerate(np.linspace(first, last, 80), start=3)
    return [line(k, radius * np.cos(w), radius * np.sin(w), z) for k, w in angles]


def test_free_spin_keeps_away_from_joint_limits() -> None:
    """All around the arm: the chosen spin has no finding and a margin."""
    around = circle(0.55, 0.3, -2.6, 2.6)

    plan = planned(PathMode(span=at(1), mode="blend"), rapid(2, around[0].end[0], around[0].end[1], 0.3), *around)

    extremes, joints = plan.extremes(), arm().joints
    assert not [f for f in plan.findings if f.code in ("GS202", "GS203", "GS205")]
    assert np.minimum(extremes.least - joints.lower, joints.upper - extremes.most).min() > 0.05


def test_out_of_reach_tells_where_why_and_a_shift() -> None:
    far = [line(k, 1.25 + 0.001 * k, 0.0, 0.3) for k in range(5, 12)]

    begin = (rapid(2, 0.8, 0.0, 0.35), line(3, 0.9, 0.0, 0.3), line(4, 1.25, 0.0, 0.3))
    plan = planned(*begin, *far, rapid(20, 0.8, 0.0, 0.4))

    found = only(plan, "GS202")
    assert found.span.line == 4
    assert "and 8 further blocks" in found.message  # the way back starts out there, too
    assert "wrist centre distance from joint 2" in found.message
    assert found.value is not None and found.limit is not None and found.value > found.limit
    # where the block leaves the reach, by bisection on the inverse kinematics of the test's own
    share = reachable_share(np.array([0.9, 0.0, 0.3]), np.array([1.25, 0.0, 0.3]))
    assert f"from {100 * share:.0f} % of the block" in found.message
    assert "shifted by X-" in found.hint


def test_joints_do_not_leap_where_the_path_cannot_be_had() -> None:
    there_and_back = [line(4, 1.3, 0.0, 0.3, 0.5), line(5, 1.0, 0.3, 0.3, 0.5), line(6, 0.6, 0.3, 0.3, 0.5)]
    plan = planned(rapid(2, 0.8, 0.0, 0.35), line(3, 0.9, 0.0, 0.3), *there_and_back)

    _, q, _ = sampled(plan)

    assert {f.code for f in plan.findings} >= {"GS202"}
    assert np.all(np.abs(np.diff(q, axis=0)) / DT <= 1.02 * arm().joints.speed)


def test_beyond_a_limit_windows_give_the_same_joints_as_the_whole() -> None:
    """Behind the arm joint 1 goes past its limit; a window that begins there once took another configuration."""
    plan = planned(rapid(2, -0.3, 0.4, 0.6), line(3, -0.3, -0.4, 0.6), posing=FixedAttitude(spin=0.0))
    samples, whole, _ = sampled(plan)

    assert np.degrees(np.abs(whole[:, 0]).max()) > 171.0
    assert np.abs(np.diff(whole, axis=0)).max() < 0.1
    for begin in range(0, len(whole), 97):
        window = slice(begin, begin + 5)
        part = plan.joints(plan.trajectory.sample(samples.time[window]))
        np.testing.assert_allclose(part, whole[window], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(("start", "end"), [((0.5, -0.3, 1.1), (-0.1, 0.0, 0.2)), ((-0.2, -0.2, 0.2), (0.6, 0.4, 0.5))])
def test_a_leap_to_another_configuration_takes_its_time(
    start: tuple[float, float, float], end: tuple[float, float, float]
) -> None:
    """No branch is within limits on a part of the path; where the nearest one ends, another begins far away."""
    plan = planned(rapid(2, *start), line(3, *end), posing=FixedAttitude(spin=0.0))
    _, q, _ = sampled(plan)

    assert "GS203" in {f.code for f in plan.findings}
    assert np.all(np.abs(np.diff(q, axis=0)) / DT <= 1.02 * arm().joints.speed)


@pytest.mark.parametrize("end", [(0.3, 0.225, 1.14), (0.2, -0.25, 1.1), (-0.1, 0.3, 1.12)])
def test_a_path_that_begins_on_the_base_axis_begins_as_it_goes_on(end: tuple[float, float, float]) -> None:
    """With the wrist above it joint 1 may stand anywhere; it stayed where it was, and leaped when the path began."""
    posing = FixedAttitude(upright=np.diag([1.0, -1.0, -1.0]))
    plan = planned(rapid(2, 0.0, 0.0, 1.14), line(3, *end), posing=posing)
    samples, q, _ = sampled(plan)

    assert not {f.code for f in plan.findings} & {"GS201", "GS203", "GS212", "GS216"}
    feeding = q[samples.row == 1]
    assert np.ptp(feeding[:, 0]) < 1e-6
    assert np.abs(np.diff(feeding, axis=0)).max() / DT < 1.0


def reachable_share(start: np.ndarray, end: np.ndarray) -> float:
    low, high = 0.0, 1.0
    for _ in range(40):
        u = 0.5 * (low + high)
        X = np.eye(4)
        X[:3, :3] = np.diag([1.0, -1.0, -1.0])
        X[:3, 3] = start + u * (end - start)
        if len(arm().branches(X)):
            low = u
        else:
            high = u
    return low


def test_a_wrist_singularity_slows_the_feed_and_says_which_joint() -> None:
    """The tool held level: its axis passes through the line of axis 4, where joints 4 and 6 turn at once."""
    level = FixedAttitude(upright=rotation_about(np.array([0.0, 1.0, 0.0]), -pi / 2), spin=0.0)
    X = arm().forward(np.radians([[0.0, -60.0, 60.0, 0.0, 0.0, 0.0]]))[0]
    p = X[:3, 3].tolist()

    plan = planned(
        rapid(2, p[0], p[1] - 0.05, p[2] + 0.02),
        line(3, p[0], p[1] + 0.05, p[2] + 0.0005, feed=0.2),
        posing=level,
    )

    found = only(plan, "GS204")
    assert found.span.line == 3
    assert "joint_4" in found.message or "joint_6" in found.message
    _, q, _ = sampled(plan)
    assert np.all(np.abs(np.diff(q, axis=0)) / DT <= 1.02 * arm().joints.speed)


def test_a_path_straight_through_a_singularity_takes_a_while_not_for_ever() -> None:
    """Joints 4 and 6 turn half round on the spot, which takes them about half a turn's time."""
    level = FixedAttitude(upright=rotation_about(np.array([0.0, 1.0, 0.0]), -pi / 2), spin=0.0)
    p = arm().forward(np.radians([[0.0, -60.0, 60.0, 0.0, 0.0, 0.0]]))[0, :3, 3].tolist()

    plan = planned(rapid(2, p[0], p[1], p[2] + 0.05), line(3, p[0], p[1], p[2] - 0.05, feed=0.1), posing=level)

    assert 1.0 <= plan.trajectory.totals.feed <= 6.0
    _, q, _ = sampled(plan)
    assert np.all(np.abs(np.diff(q, axis=0)) / DT <= 1.05 * arm().joints.speed)


def test_a_feed_beyond_the_joints_is_a_note_or_warning_not_an_error() -> None:
    plan = planned(rapid(2, 0.6, -0.3, 0.3), line(3, 0.6, 0.3, 0.3, feed=10.0))

    assert {f.code for f in plan.findings} <= {"GS204", "GS206"}
    assert len(plan.findings)


def test_joint_limits_give_another_reason_than_reach() -> None:
    """Joint 1 ends at 170 degrees; the path goes on to 178."""
    turns = circle(0.5, 0.4, -2.8, 3.1)

    plan = planned(rapid(2, *turns[0].end[:3]), *turns, posing=FixedAttitude(spin=0.0))

    (found,) = [f for f in plan.findings if f.code in ("GS202", "GS203", "GS205", "GS216")]
    assert found.code == "GS216"
    assert "no continuous way leads on (joint limit: joint_1 would go to " in found.message


def test_a_program_without_moves() -> None:
    plan = planned(Dwell(span=at(1), seconds=1.0))

    assert plan.trajectory.duration == 1.0
    assert np.allclose(plan.joints(plan.trajectory.sample(np.array([0.5]))), HOME)
    assert np.allclose(plan.extremes().least, HOME)


@pytest.mark.parametrize("joint_rapids", [False, True])
def test_rows_and_rests_make_up_the_time(joint_rapids: bool) -> None:
    posing = FixedAttitude(joint_rapids=joint_rapids)
    plan = planned(*SQUARE, Dwell(span=at(9), seconds=0.5), rapid(10, 0.6, 0.0, 0.4), posing=posing)

    trajectory = plan.trajectory
    assert trajectory.row_time.sum() + 0.5 == pytest.approx(trajectory.duration)


def test_an_arm_of_five_joints_is_told_to_be_one(tmp_path: Path) -> None:
    """The KR 10 with its last joint fixed: near poses are no question of distance, far ones are."""
    text = model_path("kuka_kr10_r1100_2").read_text()
    (tmp_path / "five.urdf").write_text(text.replace('name="joint_6" type="revolute"', 'name="joint_6" type="fixed"'))
    chain, _ = load_urdf(tmp_path / "five.urdf")
    assert chain is not None
    five = kinematics_of(chain)
    X = arm().forward(np.append(HOME[:5], 0.7)[None])[0]
    far = X.copy()
    far[0, 3] = 3.0

    near = five.reason(X, HOME[:5], Status.REACH)

    assert why(five, near).endswith("holds the tool so at this place; 5 joints cannot turn it to all sides")
    assert "flange distance from joint_1 would be 3" in why(five, five.reason(far, HOME[:5], Status.REACH))
    assert five.inverse(five.forward(HOME[:5][None]), HOME[:5])[1][0] == Status.OK
