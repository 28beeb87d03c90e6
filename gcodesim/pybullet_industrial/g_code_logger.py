"""Writes down where a robot goes, as lists of G-code and as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.pybullet_industrial.g_code_simplifier import JOINT_KEY, Lines, is_joint
from gcodesim.pybullet_industrial.robot_base import RobotBase

_ORDER = ("G", "X", "Y", "Z", "A", "B", "C")


class GCodeLogger:
    """Notes the pose and the joints of `robot` whenever it is asked and they have changed.

    `g_code_robot_view` and `g_code_joint_position` are the lines so far, G1 with X, Y, Z [m], A, B, C [rad], or RA1 ….
    """

    def __init__(self, robot: RobotBase) -> None:
        self.robot = robot
        self.current_robot_pose = dict.fromkeys("XYZABC", 0.0)
        self.current_joint_position = dict.fromkeys(self._joint_words(), 0.0)
        self.g_code_robot_view: Lines = []
        self.g_code_joint_position: Lines = []

    @staticmethod
    def write_g_code(
        g_code: Sequence[Mapping[str, Any]],
        textfile: str,
        translate: Mapping[str, str] | None = None,
        prefix: str | None = None,
        postfix: str | None = None,
    ) -> None:
        """Write lines to a file, between `prefix` and `postfix`.

        Words come in the order G X Y Z A B C, joints by number, then the others, of which `translate` may replace one
        with its number, as {"M11": "%call"}. Numbers have no zeros at the end and at most ten decimals if tiny.
        """
        lines = [_line_text(line, translate or {}) for line in g_code]
        framed = [*([] if prefix is None else [prefix]), *lines, *([] if postfix is None else [postfix])]
        Path(textfile).write_text("".join(f"{line}\n" for line in framed), encoding="utf-8")

    def update_g_code(self, only_changed_values: bool = True) -> None:
        """Note both pose and joints; words that have not changed are left out, or not."""
        self.update_g_code_robot_view(only_changed_values)
        self.update_g_code_joint_position(only_changed_values)

    def update_g_code_robot_view(self, only_changed_values: bool = True) -> None:
        """Note the pose of the end effector."""
        _note(self._get_robot_pose(), self.current_robot_pose, self.g_code_robot_view, only_changed_values)

    def update_g_code_joint_position(self, only_changed_values: bool = True) -> None:
        """Note the joints, within their limits."""
        _note(self._get_joint_position(), self.current_joint_position, self.g_code_joint_position, only_changed_values)

    def _get_robot_pose(self) -> dict[str, float]:
        position, orientation = self.robot.get_endeffector_pose()
        values = [*position.tolist(), *p.getEulerFromQuaternion(orientation)]
        return dict(zip("XYZABC", values, strict=True))

    def _get_joint_position(self) -> dict[str, float]:
        lower, upper = self.robot.get_joint_limits()
        at = self.robot.get_joint_position()
        values = [float(np.clip(at[name], lower[name], upper[name])) for name in self.robot.get_moveable_joints()[0]]
        return dict(zip(self._joint_words(), values, strict=True))

    def _joint_words(self) -> list[str]:
        return [f"{JOINT_KEY}{number + 1}" for number in range(len(self.robot.get_moveable_joints()[0]))]


def _note(now: dict[str, float], before: dict[str, float], lines: Lines, only_changed: bool) -> None:
    changed = {word: value for word, value in now.items() if value != before[word]}
    if changed:
        lines.append({"G": 1, **(changed if only_changed else now)})
        before.update(now)


def _line_text(line: Mapping[str, Any], translate: Mapping[str, str]) -> str:
    joints = sorted((word for word in line if is_joint(word)), key=lambda word: int(word[len(JOINT_KEY) :]))
    first = [word for word in (*_ORDER, *joints) if word in line]
    texts = [f"{word}{'=' if word.startswith(JOINT_KEY) else ''}{_number_text(line[word])}" for word in first]
    others = [word for word in line if word not in first]
    texts += [translate.get(f"{word}{line[word]}", f"{word}{_number_text(line[word])}") for word in others]
    return " ".join(texts)


def _number_text(value: Any) -> str:
    text = str(value)
    if "e" in text.lower():
        text = f"{value:.10f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
