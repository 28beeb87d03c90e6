"""Values that a script gives are checked where they come in, and told in words; nothing of the cell changes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gcodesim
from gcodesim.session import MisuseError, OpenCell

CELL = """\
gcodesim: 1
robots: {arm: {model: kuka_kr10_r1100_2, home: [0, -90, 90, 0, 90, 0]}}
tools: {1: {type: flat_end_mill, diameter: 6, flutes: 3, length: 60}}
simulation: {world: kinematic}
"""
NAN = float("nan")
PATH = gcodesim.ToolPath.from_points(np.array([[0.0, 0.0, 0.0], [0.01, 0.0, 0.0]]), feed=0.1)
CASES: list[tuple[Callable[[OpenCell], Any], str]] = [
    (lambda cell: cell.robot([1]), "no channel of this cell moves"),  # type: ignore[arg-type]
    (lambda cell: cell.tool("1"), "no tool '1'"),  # type: ignore[arg-type]
    (lambda cell: cell.step("1"), "finite number; '1' is given"),  # type: ignore[arg-type]
    (lambda cell: cell.step(None), "is a number; None is given"),  # type: ignore[arg-type]
    (lambda cell: cell.step(NAN), "finite number"),
    (lambda cell: cell.step(0.0), "is more than 0"),
    (lambda cell: cell.picture([1, 0], [0, 0, 0]), "the place of the camera has 3 numbers"),
    (lambda cell: cell.picture([1, 0, 1], [0, 0, 0], width=2.5), "pixels"),  # type: ignore[arg-type]
    (lambda cell: cell.picture([1, 0, 1], [0, 0, 0], up=[1, 1]), "`up` has 3 numbers"),
    (lambda cell: cell.draw("x"), "a drawing has rows of 3 numbers"),
    (lambda cell: cell.draw([[0, 0, 0], [1, 1, 1]], color=[1, 2]), "red, green and blue"),
    (lambda cell: cell.draw([[0, 0, 0], [1, 1, 1]], color=[NAN, 0, 0]), "finite numbers"),
    (lambda cell: cell.draw_frame([0, 0]), "the place of a frame"),
    (lambda cell: cell.draw_frame([0, 0, 0], [0, 0, 0, 0]), "not all 0"),
    (lambda cell: cell.draw_frame([0, 0, 0], length=NAN), "the length of axes"),
    (lambda cell: cell.robot().set_joint_position({"joint_1": "a"}), "the place of joint_1 is a number"),  # type: ignore[dict-item]
    (lambda cell: cell.robot().set_joint_position(["a"] * 6), "a joint vector has numbers"),
    (lambda cell: cell.robot().follow_joints(3), "a list of joint vectors"),  # type: ignore[arg-type]
    (lambda cell: cell.robot().follow(None), "rows of 3 numbers"),  # type: ignore[arg-type]
    (lambda cell: cell.robot().follow([[0.6, 0, 0.8]], [0, 0, 1]), "the orientation of a pose has 4 numbers"),
    (lambda cell: cell.robot().follow([[0.6, 0, 0.8]], [0, 0, 0, 0]), "not all 0"),
    (lambda cell: cell.robot().follow([[0.6, 0, 0.8]], spacing="x"), "the spacing of poses"),  # type: ignore[arg-type]
    (lambda cell: cell.robot().follow([]), "rows of 3 numbers"),
    (lambda cell: cell.robot().move_to([0.6, 0, 0.8], "x"), "the orientation of a pose"),  # type: ignore[arg-type]
    (lambda cell: cell.robot().run([[0, 0, 0]]), "`gcodesim.ToolPath`; list is given"),  # type: ignore[arg-type]
    (lambda cell: cell.robot().run(PATH, 3), "no frame `3`"),  # type: ignore[arg-type]
    (lambda cell: setattr(cell.robot(), "controller", None), "one of `gcodesim.controllers`; NoneType"),
    (lambda cell: cell.robot().tool.spin("x"), "the speed of a spindle"),  # type: ignore[union-attr, arg-type]
    (lambda cell: cell.robot().tool.apply_tcp_force("abc"), "a force"),  # type: ignore[union-attr, arg-type]
    (lambda cell: cell.robot().tool.apply_tcp_force([1, 2, 3], [1]), "a torque"),  # type: ignore[union-attr]
]


@pytest.mark.parametrize(("call", "says"), CASES)
def test_a_wrong_value_is_told_in_words(tmp_path: Path, call: Callable[[OpenCell], Any], says: str) -> None:
    (tmp_path / "cell.yaml").write_text(CELL)
    with gcodesim.open_cell(tmp_path / "cell.yaml") as cell:
        cell.tool(np.int64(1)).couple(cell.robot())  # type: ignore[arg-type]  # numpy's numbers are numbers
        with pytest.raises(MisuseError, match=says):
            call(cell)
        assert cell.time == 0.0


def test_a_world_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "cell.yaml").write_text(CELL)
    with pytest.raises(MisuseError, match="no world `moon`; there are bullet, kinematic"):
        gcodesim.open_cell(tmp_path / "cell.yaml", world="moon")
