"""Several machines of a cell moved by one script: one clock, one stock, tools that change hands."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.log.logfile import LogFile
from gcodesim.log.reader import read_messages
from gcodesim.motion.tool_path import EXACT_STOP
from gcodesim.session import MisuseError, OpenCell

CELL = """\
gcodesim: 1
robots:
  left: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid}
  right: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0], stiffness: rigid,
          base: {in: world, xyz: [1700, 0, 0], rpy: [0, 0, 180]}}
externals:
  table: {robot: left, axes: {C: {travel: unlimited, speed: 90 deg/s}}, base: {in: world, xyz: [850, 0, 300]}}
stock: {plate: {box: [80, 60, 10], in: table, resolution: 0.25, zero: top-center, xyz: [0, 0, 10]}}
channels:
  main: {robot: left, work_offsets: {G54: {in: table, xyz: [0, 0, 10]}}, orientation: {tool_axis: -Z of G54}}
  right: {robot: right, work_offsets: {G54: {in: table, xyz: [0, 0, 10]}}, orientation: {tool_axis: -Z of G54}}
tools:
  1: {type: flat_end_mill, diameter: 6, flutes: 3, length: 60}
  2: {type: flat_end_mill, diameter: 4, flutes: 2, length: 60}
magazine: {change_time: 0.5 s}
simulation: {world: kinematic}
"""
_CORNERS = 1e-3 * np.array([[10.0, 20.0, 8.0], [10.0, 20.0, -2.0], [30.0, 20.0, -2.0], [30.0, 20.0, 8.0]])
SLOT = replace(gcodesim.ToolPath.from_points(_CORNERS, feed=0.05), mode=np.full(3, EXACT_STOP, dtype=np.uint8))


def _cell(tmp_path: Path, text: str = CELL) -> Path:
    (tmp_path / "cell.yaml").write_text(text)
    return tmp_path / "cell.yaml"


@pytest.mark.parametrize("world", ["kinematic", "bullet"])
def test_all_robots_go_to_their_targets_in_the_same_time(tmp_path: Path, world: str) -> None:
    with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "out", world=world) as cell:
        left, right = cell.robots
        assert (left.name, right.name) == ("left", "right") and cell.robot() is cell.robot("left")
        left.set_joint_position({left.joint_names[0]: 0.4})
        right.move_joints({right.joint_names[0]: -0.3})
        began = left.joint_state.position[0]
        assert 0.0 < began <= 0.4  # it went on while the other one was waited for
        assert right.joint_state.position[0] == pytest.approx(-0.3, abs=1e-6)
        cell.step(0.5)
        assert left.joint_state.position[0] == pytest.approx(0.4, abs=1e-6)
        assert right.joint_state.position[0] == pytest.approx(-0.3, abs=1e-6)
        end = cell.time
    results = json.loads((tmp_path / "out" / "results.json").read_text())
    assert {name: channel["mover"] for name, channel in results["channels"].items()} == {
        "main": "left",
        "right": "right",
    }
    assert [channel["end_s"] for channel in results["channels"].values()] == pytest.approx([end, end])
    log = tmp_path / "out" / "run.mcap"
    last = {topic: list(read_messages(log, topic))[-1] for topic in ("/joint_states", "/right/joint_states")}
    assert [at * 1e-9 for at, _ in last.values()] == pytest.approx([end, end])
    assert [message.joints[0].position for _, message in last.values()] == pytest.approx([0.4, -0.3], abs=1e-6)


def test_each_cuts_the_same_stock_and_all_is_counted(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        left, right = cell.robots
        cell.tool(1).couple(left)
        cell.tool(1).spin(800.0)
        left.run(SLOT)
        left.move_to([0.6, 0.0, 0.6])
        cell.tool(2).couple(right)
        cell.tool(2).spin(800.0)
        right.run(SLOT.translate([0.0, -40e-3, 0.0]))
    slots = [2.0 * (20.0 * d + np.pi / 4.0 * d * d) for d in (6.0, 4.0)]  # mm³, two deep
    assert 1e9 * cell.results.stocks["plate"].removed == pytest.approx(sum(slots), rel=0.02)


def test_work_that_another_machine_turns_is_taken_where_it_stands(tmp_path: Path) -> None:
    def cut(turned: float) -> tuple[float, np.ndarray]:
        with gcodesim.open_cell(_cell(tmp_path)) as cell:
            left, right = cell.robots
            left.move_joints({"table/C": turned})
            cell.tool(1).couple(right)
            cell.tool(1).spin(800.0)
            right.run(SLOT)
            tip = right.endeffector_pose[0]
        return cell.results.stocks["plate"].removed, tip

    at_home, tip = cut(0.0)
    turned, tip_turned = cut(np.pi / 2.0)
    assert turned == pytest.approx(at_home, rel=1e-3) and at_home > 0.0
    assert tip == pytest.approx([0.88, 0.02, 0.318], abs=1e-6)
    assert tip_turned == pytest.approx([0.83, 0.03, 0.318], abs=1e-6)


def test_work_on_a_machine_that_moves_is_refused(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        left, right = cell.robots
        left.set_joint_position({"table/C": 2.0})
        cell.step(0.6)
        cell.tool(1).couple(right)
        with pytest.raises(MisuseError, match="`left`, on which the work stands, is moving"):
            right.run(SLOT)
        cell.step(2.0)
        right.run(SLOT)


def test_a_tool_is_in_one_hand_at_a_time(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        left, right = cell.robots
        tool = cell.tool(1)
        tool.couple(left)
        with pytest.raises(MisuseError, match="`left` holds tool 1; decouple it there first"):
            tool.couple(right)
        tool.decouple()
        tool.couple(right)
        cell.tool(2).couple(left)
        assert (left.tool, right.tool) == (cell.tool(2), tool)
        cell.step(0.01)
        assert cell.time == pytest.approx(1.508)  # three changes of the left one, two steps of 4 ms


def _script(cell: OpenCell, *, looks: bool) -> None:
    left, right = cell.robots

    def look() -> None:
        if looks:
            assert len(right.joint_state.position) == len(cell.robot("right").joint_names) and cell.time >= 0.0

    left.set_joint_position({left.joint_names[0]: 0.5})
    look()
    cell.step(0.1)
    cell.tool(1).couple(right)
    look()
    cell.step(0.1)
    look()
    left.set_joint_position({left.joint_names[0]: 0.0})
    right.move_to([1.0, 0.0, 0.5])
    look()
    cell.tool(1).spin(800.0)
    cell.tool(2).couple(left)
    right.run(SLOT)
    look()
    cell.step(0.05)


def test_results_do_not_depend_on_who_looks_when(tmp_path: Path) -> None:
    written: list[dict[str, Any]] = []
    for looks in (False, True):
        out = tmp_path / str(looks)
        with gcodesim.open_cell(_cell(tmp_path), out=out) as cell:
            _script(cell, looks=looks)
        written.append({name: (out / name).read_bytes() for name in ("results.json", "lines.csv", "plate.stl")})
    assert written[0] == written[1]


def test_a_machine_goes_on_while_another_changes_its_tool(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        left, right = cell.robots
        left.set_joint_position({left.joint_names[0]: 2.0})
        cell.tool(1).couple(right)
        cell.step(0.1)
        assert cell.time == pytest.approx(0.6)
        alone = left.joint_state.position[0]
    with gcodesim.open_cell(_cell(tmp_path)) as cell:
        left, _ = cell.robots
        left.set_joint_position({left.joint_names[0]: 2.0})
        cell.step(0.6)
        assert left.joint_state.position[0] == pytest.approx(alone, abs=1e-9)


def test_a_sensor_on_the_second_arm_is_read_there(tmp_path: Path) -> None:
    mill = "{type: flat_end_mill, diameter: 4, flutes: 2, length: 60}"
    text = CELL.replace(mill, "{type: camera, length: 60, width: 32, height: 24, field_of_view: 60 deg}")
    with gcodesim.open_cell(_cell(tmp_path, text)) as cell:
        _, right = cell.robots
        cell.tool(2).couple(right)
        cell.step(0.1)
        assert cell.camera("T2").picture().shape == (24, 32, 3)


def test_pictures_show_the_tools_of_all_machines(tmp_path: Path) -> None:
    """Two arms alike, beside each other: the picture from above the one is that from above the other."""
    cell_text = CELL.replace("xyz: [1700, 0, 0], rpy: [0, 0, 180]", "xyz: [0, 3000, 0]")
    cell_text = cell_text.replace(
        "type: flat_end_mill, diameter: 4, flutes: 2", "type: flat_end_mill, diameter: 6, flutes: 3"
    )

    def seen(cell: OpenCell) -> list[np.ndarray]:
        at = [arm.endeffector_pose[0] for arm in cell.robots]
        return [cell.picture(p + np.array([0.3, 0.0, 0.1]), p, width=80, height=60, field_of_view=0.6) for p in at]

    with gcodesim.open_cell(_cell(tmp_path, cell_text)) as cell:
        bare = seen(cell)
        for number, arm in enumerate(cell.robots, 1):
            cell.tool(number).couple(arm)
        cell.step(0.1)
        held = seen(cell)
    assert np.array_equal(*bare) and np.array_equal(*held)
    assert not np.array_equal(bare[0], held[0])


def test_what_links_hit_is_told_with_the_line_of_the_script(tmp_path: Path) -> None:
    """Fixtures, the machine itself and stocks, as in a run; asking meanwhile changes nothing."""
    post = "fixtures: {post: {box: [200, 200, 1200], xyz: [0, 600, 0]}}\nsimulation:"

    def told(*, asks: bool) -> list[tuple[str, str]]:
        with gcodesim.open_cell(_cell(tmp_path, CELL.replace("simulation:", post))) as cell:
            left, _ = cell.robots
            left.move_joints({left.joint_names[1]: -0.5, left.joint_names[2]: 0.3})
            assert not asks or not cell.findings
            left.move_joints({left.joint_names[0]: -1.2})
            assert not asks or [finding.code for finding in cell.findings] == ["GS305"]
            left.move_joints({left.joint_names[0]: 0.0})
            left.move_to([0.85, 0.0, 0.2])  # into the plate, and the fork of the arm after the flange
        lines = Path(__file__).read_text().splitlines()
        return [(found.code, lines[found.span.line - 1].strip()) for found in cell.results.findings]

    found = told(asks=False)
    assert {code for code, _ in found} >= {"GS305", "GS307"} and found == told(asks=True)
    assert ("GS305", "left.move_joints({left.joint_names[0]: -1.2})") in found
    assert all("move_to" in line for code, line in found if code == "GS307")


def test_the_log_has_one_copy_of_the_script(tmp_path: Path) -> None:
    with gcodesim.open_cell(_cell(tmp_path), out=tmp_path / "out") as cell:
        cell.step(0.01)
    attached = LogFile.open(tmp_path / "out" / "run.mcap").attachments
    assert "program.nc" in attached and Path(__file__).name not in attached
