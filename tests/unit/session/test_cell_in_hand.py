"""A cell moved from Python: the same engine, log and findings as a run, and misuse told in words."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.checks import stock_watch
from gcodesim.executor.record import StepRecord
from gcodesim.frames import quaternion_from_rotation
from gcodesim.log.summary import summary
from gcodesim.session import MisuseError, OpenCell, cell_in_hand

DATA = Path(__file__).parents[2] / "data"
CELL = """\
gcodesim: 1
robots:
  arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid}
frames: {table: {in: world, xyz: [600, 0, 300]}}
stock: {plate: {box: [20, 16, 10], in: table, resolution: 0.5, zero: top-front-left}}
work_offsets: {G54: {in: table}}
orientation: {tool_axis: -Z of G54}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 3}
  2: {type: extruder, bead_width: 6, bead_height: 3}
magazine: {change_time: 0.5 s}
simulation: {world: kinematic}
"""
SLOT = gcodesim.ToolPath.from_points(
    1e-3 * np.array([[-5.0, 8.0, 4.0], [-5.0, 8.0, -2.0], [25.0, 8.0, -2.0], [25.0, 8.0, 4.0]]), feed=0.05
)


def _cell(tmp_path: Path) -> Path:
    (tmp_path / "cell.yaml").write_text(CELL)
    return tmp_path / "cell.yaml"


def test_joints_go_to_their_target_within_their_limits_and_stay(tmp_path: Path) -> None:
    speeds = []
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm = cell.robot("arm")
        arm.set_joint_position({arm.joint_names[0]: 0.5, arm.joint_names[4]: 1.0})
        for _ in range(60):
            cell.step(0.01)  # two and a half steps of the simulation
            speeds.append(arm.joint_state.velocity.copy())

        assert cell.time == pytest.approx(0.6)
        limits = cell._shop.kinematics.joints
        assert (np.abs(speeds) <= limits.speed + 1e-9).all() and np.abs(speeds).max() > 0.5
        assert (np.abs(np.diff(speeds, axis=0)) <= limits.acceleration * 0.0121).all()
        state = arm.joint_state
        assert state.position[[0, 4]].tolist() == [0.5, 1.0]
        assert not state.velocity.any()


def test_a_pose_is_reached_and_the_tool_keeps_its_attitude(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm, tool = cell.robot(), cell.tool(1)
        tool.couple(arm)
        _, before = arm.endeffector_pose
        arm.set_endeffector_pose([0.62, -0.05, 0.45])
        cell.step(2.5)
        position, orientation = arm.endeffector_pose

        assert position == pytest.approx([0.62, -0.05, 0.45], abs=1e-9)
        assert abs(orientation @ before) == pytest.approx(1.0, abs=1e-12)  # the same turn, of either sign
        weight = 9.80665 * tool.spec.inertia.mass
        assert np.linalg.norm(arm.joint_state.reaction[:3]) == pytest.approx(weight, rel=1e-6)


def test_a_joint_move_ends_at_rest_with_all_joints_together(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "out") as cell:
        arm = cell.robot()
        first = cell.robot().joint_state.position
        ends = [first + np.array([0.4, 0.1, -0.2, 0.0, 0.3, 1.0]), first + 0.05]
        arm.move_joints(*ends)
        state, duration = arm.joint_state, cell.time
        arm.move_to([0.6, 0.1, 0.5])

        assert state.position == pytest.approx(ends[1], abs=1e-12)
        assert np.abs(state.velocity).max() < 0.05  # of the last step, in which it brakes
        assert 0.2 < duration < 2.0
        assert arm.endeffector_pose[0] == pytest.approx([0.6, 0.1, 0.5], abs=1e-9)
    joints = cell.results.joints
    assert max(row["most"] for row in joints) > np.degrees(first.max() + 0.3) - 1e-6
    limits = cell._shop.kinematics.joints
    assert all(row["max_speed"] <= np.degrees(limit) + 1e-6 for row, limit in zip(joints, limits.speed, strict=True))


def test_a_path_cuts_what_the_same_program_cuts(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "session") as cell:
        arm, tool = cell.robot(), cell.tool(1)
        tool.couple(arm)
        tool.spin(500.0)
        arm.run(SLOT)
    program = tmp_path / "slot.nc"
    program.write_text("T1 M6\nG43 H1\nS4775 M3\n" + SLOT.to_gcode().replace("M2\n", "M5\nM2\n"))
    run = gcodesim.simulate(program, _cell(tmp_path), out=tmp_path / "run")

    own = cell.results.stocks["plate"]
    assert own.removed == pytest.approx(run.stocks["plate"].removed, abs=own.error_bound)
    assert own.removed == pytest.approx(20e-3 * 6e-3 * 2e-3, abs=own.error_bound)
    assert cell.results.status == "ok"
    assert {file.name for file in (tmp_path / "session").iterdir()} == {
        file.name for file in (tmp_path / "run").iterdir()
    }
    results = json.loads((tmp_path / "session" / "results.json").read_text())
    assert results["inputs"]["program"]["name"] == Path(__file__).name
    lines = (tmp_path / "session" / "lines.csv").read_text().splitlines()
    assert lines[-1].startswith(Path(__file__).name)


def test_what_is_stepped_through_is_one_run_however_it_is_asked(tmp_path: Path) -> None:
    logs = []
    for name, asks in (("quiet", False), ("asking", True)):
        with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / name) as cell:
            arm = cell.robot()
            arm.set_joint_position({arm.joint_names[1]: -1.2})
            for _ in range(20):
                cell.step(0.004)
                if asks:
                    assert cell.time > 0.0 and len(arm.joint_state.position) == 6
        logs.append(cell.results)

    assert logs[0].joints == logs[1].joints
    assert logs[0].times.feed == pytest.approx(logs[1].times.feed, abs=1e-12)


def test_steps_do_not_wait_without_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A script that steps for a day and asks nothing needs no more memory than one that asks."""
    monkeypatch.setattr(cell_in_hand, "_MOST_WAITING", 10)
    with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "out") as cell:
        arm = cell.robot()
        arm.set_joint_position({arm.joint_names[1]: -1.2})
        for seconds in (*[0.004] * 12, 0.2):
            cell.step(seconds)
            assert cell._waiting_steps < 10
        assert cell.time == pytest.approx(0.248)
        assert arm.joint_state.position[1] > -1.5708
    assert (tmp_path / "out" / "run.mcap").exists()


def test_the_same_session_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "two"):
        with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / name) as cell:
            tool = cell.tool(1)
            tool.couple(cell.robot())
            tool.spin(500.0)
            cell.robot().run(SLOT)

    for file in (tmp_path / "one").iterdir():
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes(), file.name


def test_an_extruder_puts_material_onto_the_stock(tmp_path: Path) -> None:
    path = gcodesim.ToolPath.from_points(1e-3 * np.array([[4.0, 8.0, 3.0], [16.0, 8.0, 3.0]]), feed=0.02)
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        tool = cell.tool(2)
        tool.couple(cell.robot())
        tool.extrude(path)

    assert cell.results.stocks["plate"].deposited > 100e-9


def test_bullet_moves_the_same_way(tmp_path: Path) -> None:
    ends = []
    for world in ("kinematic", "bullet"):
        with gcodesim.open_cell(_cell(tmp_path), world=world) as cell:
            arm = cell.robot()
            arm.set_joint_position({arm.joint_names[0]: 0.1})
            cell.step(0.5)
            ends.append(arm.joint_state)

    assert ends[1].position == pytest.approx(ends[0].position, abs=1e-4)
    assert ends[1].effort == pytest.approx(ends[0].effort, abs=1.0)


def test_a_fault_in_the_script_closes_the_cell_and_keeps_the_log(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "out") as cell:
        cell.step(0.1)
        _ = 1 / 0

    assert (tmp_path / "out" / "run.mcap").exists()
    assert cell.results.status == "ok"


def _held(cell: OpenCell) -> None:
    cell.tool(1).couple(cell.robot())


def _twice(cell: OpenCell) -> None:
    _held(cell)
    cell.tool(2).couple(cell.robot())


def _moving(cell: OpenCell) -> None:
    arm = cell.robot()
    arm.set_joint_position({arm.joint_names[0]: 1.0})
    cell.step(0.05)
    arm.run(SLOT)


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        (lambda cell: cell.robot("leg"), "no channel of this cell moves `leg`; they move `arm`"),
        (lambda cell: cell.tool(9), "the cell has no tool 9; it has 1, 2"),
        (lambda cell: cell.tool(2).activate(), "no robot holds tool 2; call `couple` first"),
        (_twice, "`arm` holds tool 1; decouple that first"),
        (lambda cell: cell.step(0.0), "more than 0; 0 is given"),
        (lambda cell: cell.robot().set_joint_position([0.0]), "`arm` has 6 joints; 1 values are given"),
        (lambda cell: cell.robot().set_joint_position([9.0] + [0.0] * 5), "cannot go to 9: its limits are"),
        (lambda cell: cell.robot().set_joint_position({"elbow": 0.0}), "no joint `elbow`"),
        (lambda cell: cell.robot().set_endeffector_pose([5.0, 0.0, 0.0]), "is out of reach"),
        (lambda cell: cell.robot().set_endeffector_pose([np.nan, 0.0, 0.4]), "finite numbers"),
        (lambda cell: cell.robot().set_endeffector_pose([0.6, np.inf, 0.4]), "finite numbers"),
        (lambda cell: cell.robot().set_endeffector_pose([0.6, 0.0]), "has 3 numbers"),
        (lambda cell: cell.robot().set_endeffector_pose([0.6, 0.0, 0.4], [0.0, 0.0, 0.0, 0.0]), "not all 0"),
        (
            lambda cell: cell.robot().run(SLOT, frame="G60"),
            "there is no frame `G60`; use G54 to G59.3, `world`, `table`",
        ),
        (_moving, "the robot is moving"),
        (lambda cell: (_held(cell), cell.tool(1).extrude(SLOT)), "does not extrude"),
        (lambda cell: cell.results, "after the `with` statement"),
    ],
)
def test_wrong_use_is_told(wrong: Callable[[OpenCell], Any], text: str, tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell, pytest.raises(MisuseError, match=text):
        wrong(cell)


def test_a_closed_cell_and_a_wrong_one_are_told(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        pass
    with pytest.raises(MisuseError, match="this cell is closed"):
        cell.step(1.0)
    (tmp_path / "bad.yaml").write_text(CELL.replace("tools:", "tols:"))
    with pytest.raises(gcodesim.InputError, match="tols"):
        gcodesim.open_cell(tmp_path / "bad.yaml")


def test_files_of_other_folders_are_read_where_the_script_allows_them(tmp_path: Path) -> None:
    (tmp_path / "here").mkdir()
    cell = _cell(tmp_path / "here")
    shutil.copy(DATA / "cells" / "sound" / "vise.stl", tmp_path / "vise.stl")
    cell.write_text(CELL + "fixtures: {vise: {mesh: ../vise.stl, unit: mm, in: world, xyz: [0, 900, 0]}}\n")

    with pytest.raises(gcodesim.InputError, match="GS715"):
        gcodesim.open_cell(cell)
    with gcodesim.open_cell(cell, allow_paths=[str(tmp_path)]) as opened:
        assert "vise" in opened._job.cell.fixtures  # type: ignore[union-attr]
    (tmp_path / "p.nc").write_text("G21\nM2\n")
    codes = [
        {finding.code for finding in gcodesim.simulate(tmp_path / "p.nc", cell, allow_paths=allowed).findings}
        for allowed in ((), (tmp_path,))
    ]
    assert "GS715" in codes[0] and "GS715" not in codes[1]


def test_a_joint_path_is_gone_through_without_a_stop(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm = cell.robot()
        first, limits = arm.joint_state.position, cell._shop.kinematics.joints
        seen: list[np.ndarray[Any, Any]] = []
        cell._job.seen = lambda record: (seen.append(record.world.q.copy()), cell._first._see(record))  # type: ignore[assignment, func-returns-value]
        path = [first + step * np.array([0.1, 0.05, -0.05, 0.1, 0.1, 0.2]) for step in range(1, 6)]
        arm.follow_joints(path)
        assert arm.joint_state.position == pytest.approx(path[-1], abs=1e-12)
        cell._flush()
        q = np.concatenate(seen)
        moving = np.abs(np.diff(q, axis=0)).max(axis=1) > 1e-9
        inner = np.flatnonzero(moving)
        assert moving[inner[0] : inner[-1]].all()
        dt = cell._step_ns * 1e-9
        assert (np.abs(np.diff(q, axis=0)) / dt <= limits.speed * (1.0 + 1e-6)).all()
        with pytest.raises(MisuseError, match="cannot go to"):
            arm.follow_joints([first + 10.0])
        with pytest.raises(MisuseError, match="no joint vectors"):
            arm.follow_joints([])


def test_poses_are_followed_with_their_orientations(tmp_path: Path) -> None:
    """The tip passes every pose, and between two it goes straight to a tenth of a millimetre."""
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm, tool = cell.robot(), cell.tool(1)
        tool.couple(arm)
        down = [1.0, 0.0, 0.0, 0.0]
        lean = [np.cos(0.2), 0.0, np.sin(0.2), 0.0]
        arm.move_to([0.6, -0.1, 0.45], down)
        seen: list[np.ndarray[Any, Any]] = []
        cell._flush()
        cell._job.seen = lambda record: (seen.append(record.window.tip.copy()), cell._first._see(record))  # type: ignore[assignment, func-returns-value]
        arm.follow([[0.6, 0.1, 0.45], [0.6, 0.1, 0.55]], [down, lean])
        position, orientation = arm.endeffector_pose
        cell._flush()
        assert position == pytest.approx([0.6, 0.1, 0.55], abs=1e-6)
        assert abs(float(orientation @ np.array(lean))) == pytest.approx(1.0, abs=1e-9)
        tips = (cell._shop.X_WB.matrix @ np.concatenate(seen))[:, :3, 3]
        first = tips[tips[:, 1] < 0.09]
        assert np.abs(first[:, [0, 2]] - [0.6, 0.45]).max() < 1e-4
        with pytest.raises(MisuseError, match="on the way to pose 1, out of reach: wrist centre"):
            arm.follow([[0.6, 0.0, 0.5], [3.0, 0.0, 0.5]])


def _tips(cell: OpenCell) -> list[np.ndarray[Any, Any]]:
    """Where the tip is in the world after each step from now on, one array for each window."""
    seen: list[np.ndarray[Any, Any]] = []
    cell._flush()

    def see(record: StepRecord) -> None:
        seen.append((cell._shop.X_WB.matrix @ record.window.tip)[:, :3, 3])
        cell._first._see(record)

    cell._job.seen = see
    return seen


def test_poses_are_followed_at_a_feed(tmp_path: Path) -> None:
    """The tip is never faster, and but for the ends, where the joints have to gain speed, never slower."""
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm = cell.robot()
        cell.tool(1).couple(arm)
        arm.move_to([0.6, -0.1, 0.45], [1.0, 0.0, 0.0, 0.0])
        seen, begin = _tips(cell), cell.time
        circle = gcodesim.circular_interpolation([0.6, -0.1, 0.45], [0.6, 0.1, 0.45], 0.1, 40)
        arm.follow(circle.positions, [1.0, 0.0, 0.0, 0.0], feed=0.05)
        duration = cell.time - begin
        cell._flush()
        tips = np.concatenate(seen)
    speed = np.linalg.norm(np.diff(tips, axis=0), axis=1) / (cell._step_ns * 1e-9)
    inner = speed[25:-25]  # 0.1 s at each end

    assert duration == pytest.approx(0.1 * np.pi / 0.05, rel=0.01)
    assert inner.min() > 0.0495 and speed.max() < 0.0505
    assert np.abs(np.hypot(tips[:, 0] - 0.6, tips[:, 1]) - 0.1).max() < 1e-4


def test_a_path_is_given_in_the_world_or_in_a_frame_of_the_cell(tmp_path: Path) -> None:
    """All three are the same way; a work system that lies elsewhere says only how the tool is held."""
    (tmp_path / "cell.yaml").write_text(CELL.replace("G54: {in: table}", "G54: {in: table, xyz: [0, 0, 50]}"))
    in_world = gcodesim.ToolPath.from_points([[0.6, 0.0, 0.4], [0.65, 0.03, 0.42]], feed=0.05)
    ends = []
    for frame, path in (
        ("world", in_world),
        ("table", in_world.translate([-0.6, 0.0, -0.3])),
        ("G54", in_world.translate([-0.6, 0.0, -0.35])),
    ):
        with gcodesim.open_cell(tmp_path / "cell.yaml") as cell:
            arm = cell.robot()
            cell.tool(1).couple(arm)
            arm.run(path, frame=frame)
            cell.draw(path, frame=frame)
            drawn = cell._job.drawings
            assert drawn and drawn[-1].points == pytest.approx(in_world.positions, abs=1e-12)
            position, orientation = arm.endeffector_pose
            ends.append([*position, *np.abs(orientation)])

    assert ends[0][:3] == pytest.approx([0.65, 0.03, 0.42], abs=1e-9)
    assert ends[1] == pytest.approx(ends[0], abs=1e-9) and ends[2] == pytest.approx(ends[0], abs=1e-9)


@pytest.mark.parametrize(
    ("cell_text", "active", "feed", "code"),
    [
        (CELL.replace("stock:", "x-stock:"), True, 0.05, "GS508"),  # nothing to lay it on
        (CELL, True, np.inf, "GS539"),  # in rapids
        (CELL, False, 0.05, "GS542"),  # never
        (CELL, True, 0.05, None),
    ],
)
def test_a_tool_that_is_on_for_nothing_or_never_is_told(
    tmp_path: Path, cell_text: str, active: bool, feed: float, code: str | None
) -> None:
    (tmp_path / "cell.yaml").write_text(cell_text)
    path = gcodesim.ToolPath.from_points([[0.002, -0.008, 0.003], [0.018, -0.008, 0.003]], feed=feed)
    with gcodesim.open_cell(tmp_path / "cell.yaml", out=tmp_path / "out") as cell:
        arm, head = cell.robot(), cell.tool(2)
        head.couple(arm)
        if active:
            head.extrude(path)
        else:
            arm.run(path)
    told = json.loads((tmp_path / "out" / "results.json").read_text())["findings"]

    found = [finding for finding in told if finding["code"] in ("GS508", "GS539", "GS542")]
    assert [finding["code"] for finding in found] == ([code] if code else [])
    assert all(finding["file"] == Path(__file__).name and finding["line"] > 0 for finding in found)


@pytest.mark.parametrize(("flow", "told"), [(0.0, True), (1.6e-7, False)])
def test_a_pump_without_flow_is_told(tmp_path: Path, flow: float, told: bool) -> None:
    path = gcodesim.ToolPath.from_points([[0.002, -0.008, 0.003], [0.018, -0.008, 0.003]], feed=0.01)
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        head = cell.tool(2)
        head.couple(cell.robot())
        head.set("flow", flow)
        head.extrude(path)
    found = [finding.message for finding in cell.results.findings if finding.code == "GS549"]
    assert found == (["T2 is switched on, and its `flow` is 0 all along: the script sets it so"] if told else [])


def test_a_way_that_another_posture_can_go_is_told_with_that_posture(tmp_path: Path) -> None:
    """Joint 4 would have to turn beyond its limit; with the wrist the other way round it does not, as the hint says."""
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm = cell.robot()
        begin = np.array([0.0, -1.5, 1.5, 3.0, 0.8, 0.0])
        end = begin + np.array([0.0, 0.0, 0.0, 0.4, 0.0, 0.0])
        X_BF = cell._shop.kinematics.forward(end[None])[0]
        arm.move_joints(begin)
        goal = X_BF[:3, 3], quaternion_from_rotation(X_BF[:3, :3])
        with pytest.raises(MisuseError, match=r"joint_4 would go to .* begins in another posture") as told:
            arm.follow([goal[0]], goal[1])
        values = re.search(r"move_joints\(\[(.*)\]\)", str(told.value))
        assert values is not None
        arm.move_joints([float(value) for value in values[1].split(",")])
        arm.follow([goal[0]], goal[1])
        position, orientation = arm.endeffector_pose
        assert position == pytest.approx(goal[0], abs=1e-6)
        assert abs(float(orientation @ goal[1])) == pytest.approx(1.0, abs=1e-9)


def test_drawings_are_in_the_log_from_their_time_on(tmp_path: Path) -> None:
    from gcodesim.log.reader import read_messages

    with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "out") as cell:
        arm = cell.robot()
        cell.draw(SLOT)
        cell.step(0.1)
        cell.draw([[0.0, 0.0, 1.0], [0.5, 0.0, 1.0]], color=(0.0, 1.0, 0.0))
        cell.draw_frame(*arm.endeffector_pose)
        cell.step(0.1)
        cell.clear_drawings()
        cell.step(0.1)
        for wrong, said in (([[0.0, 0.0, 1.0]], "two points"), ([[0.0, 0.0, np.nan]] * 2, "finite")):
            with pytest.raises(MisuseError, match=said):
                cell.draw(wrong)
        with pytest.raises(MisuseError, match="no frame `G99`"):
            cell.draw(SLOT, frame="G99")
    counts = [len(update.entities) for _, update in read_messages(tmp_path / "out" / "run.mcap", "/scene/drawn")]
    assert counts == [1, 5, 0]


def test_bodies_beside_the_stock_are_prepared_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each step takes joints farther than before; a script that looks after each had trees of all bodies made anew."""
    made = []
    monkeypatch.setattr(stock_watch._Pairs, "of", lambda *given, of=stock_watch._Pairs.of: made.append(1) or of(*given))
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        arm = cell.robot()
        for step in range(20):
            arm.set_joint_position({arm.joint_names[0]: 0.01 * step})
            cell.step(0.02)
            assert arm.joint_state.position.shape == (6,)
    assert len(made) == 1


def test_a_base_on_axes_is_moved_like_joints(tmp_path: Path) -> None:
    """A robot on two rails and a turntable, as a vehicle would carry it."""
    text = CELL.replace(
        "frames:",
        "externals:\n  agv:\n    carries: arm\n    axes:\n"
        "      U: {travel: [-1 m, 1 m], speed: 1 m/s, acceleration: 1 m/s^2, direction: [1, 0, 0]}\n"
        "      V: {travel: [-1 m, 1 m], speed: 1 m/s, acceleration: 1 m/s^2, direction: [0, 1, 0]}\nframes:",
        1,
    )
    (tmp_path / "cell.yaml").write_text(text)
    with gcodesim.open_cell(tmp_path / "cell.yaml") as cell:
        arm = cell.robot()
        names = [name for name in arm.joint_names if name.endswith(("U", "V"))]
        before, _ = arm.endeffector_pose
        arm.move_joints({names[0]: 0.4, names[1]: -0.3})
        after, _ = arm.endeffector_pose
        assert after - before == pytest.approx([0.4, -0.3, 0.0], abs=1e-9)


def test_a_script_that_is_interrupted_is_an_interrupted_run(tmp_path: Path) -> None:
    """Neither log nor results say that it came to its end, and what it had still to do is left undone."""
    (tmp_path / "cell.yaml").write_text("gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n")
    with pytest.raises(KeyboardInterrupt), gcodesim.open_cell(tmp_path / "cell.yaml", out=tmp_path / "out") as cell:
        cell.step(0.1)
        cell.robot().set_joint_position({"X": 0.02})
        cell.step(0.1)
        assert cell.time == pytest.approx(0.2)
        cell.step(0.4)
        raise KeyboardInterrupt
    assert cell.results.status == "failed"
    assert cell.results.times.total == pytest.approx(0.2)
    assert summary(tmp_path / "out" / "run.mcap").state == "interrupted"


def test_a_script_that_is_interrupted_before_anything_ran_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text("gcodesim: 1\nmachine: gantry_xyz\nsimulation: {world: kinematic}\n")
    with pytest.raises(KeyboardInterrupt), gcodesim.open_cell(tmp_path / "cell.yaml", out=tmp_path / "out"):
        raise KeyboardInterrupt
    assert not (tmp_path / "out").exists()
