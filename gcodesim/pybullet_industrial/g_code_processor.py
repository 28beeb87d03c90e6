"""Runs lists of G-code on a robot in the client, one elementary operation at a time.

This is the small language of PyBullet Industrial: one G, M or T a line, lengths in m, angles in rad. Programs of
machines are read by `gcodesim.read` and run by `gcodesim run`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final

import numpy as np
import pybullet as p

from gcodesim.arithmetic.matrices import norms
from gcodesim.frames import Array
from gcodesim.pybullet_industrial.endeffector_tool import EndeffectorTool
from gcodesim.pybullet_industrial.g_code_simplifier import JOINT_KEY, Lines
from gcodesim.pybullet_industrial.interpolation import circular_interpolation, linear_interpolation
from gcodesim.pybullet_industrial.joint_path import JointPath
from gcodesim.pybullet_industrial.robot_base import RobotBase
from gcodesim.pybullet_industrial.toolpath import ToolPath

Operation = Callable[[], Any]
Commands = Mapping[str, Sequence[Operation]]

_POSE_WORDS: Final = frozenset("XYZABCR")
_MOTION_WORDS: Final = frozenset("GXYZABCRF")
_WORD: Final = re.compile(r"([A-Za-z]+)(-?[0-9]*\.?[0-9]*)")
_NO_OFFSET: Final = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
_LAST_OF_MOTION: Final = 3  # G0 to G3 move


class GCodeProcessor:
    """Iterating runs one operation, or reads the next line and returns it; the caller steps the client in between.

    `m_commands` and `t_commands` give for a number, as text, the functions to call; `g_commands` those of further G.
    `offset` (2, 3) is the origin [m] and its angles [rad], `axis` that of arcs. G1 to G3 go in steps of
    `interpolation_precision` [m]; `interpolation_approach` points are used to find the length.
    """

    def __init__(
        self,
        g_code_input: str | None = None,
        robot: RobotBase | None = None,
        endeffector_list: Sequence[EndeffectorTool] | None = None,
        m_commands: Commands | None = None,
        t_commands: Commands | None = None,
        offset: Any = _NO_OFFSET,
        axis: int = 2,
        interpolation_precision: float = 0.01,
        interpolation_approach: int = 1000,
    ) -> None:
        if g_code_input is not None:
            self.g_code = self.read_g_code(g_code_input)
        self.robot, self.endeffector_list = robot, endeffector_list
        self.m_commands, self.t_commands = m_commands or {}, t_commands or {}
        self.offset, self.axis = np.array(offset, dtype=float), axis
        self.interpolation_precision, self.interpolation_approach = interpolation_precision, interpolation_approach
        self.g_commands: dict[str, Sequence[Operation]] = {
            "54": [self._set_offset],
            "500": [self._clear_offset],
            "17": [partial(setattr, self, "axis", 2)],
            "18": [partial(setattr, self, "axis", 1)],
            "19": [partial(setattr, self, "axis", 0)],
        }
        self.new_point = self.new_or = self.last_point = self.last_or = np.zeros(3)
        self.active_endeffector = self._held_tool()
        self.joint_order: list[str] = []
        if robot is not None:
            self._stand()
            self.joint_order = robot.get_moveable_joints()[0]

    # ---- text and paths

    @staticmethod
    def read_g_code(g_code_input: str) -> Lines:
        """Lines as dictionaries of words; empty lines and those that begin with % are left out.

        Numbers with a point are floats, others integers. ValueError, with the line, where a word has no number.
        """
        lines = []
        for number, text in enumerate(g_code_input.splitlines(), start=1):
            if text.strip() and not text.strip().startswith("%"):
                lines.append(dict(_word(word, number) for word in text.split()))
        return lines

    @staticmethod
    def tool_path_to_g_code(tool_path: ToolPath) -> Lines:
        """G1 with X, Y, Z [m] and A, B, C [rad] for every point of a path."""
        lines = []
        for position, orientation, _ in tool_path:
            values = [*position, *p.getEulerFromQuaternion(orientation)]
            lines.append({"G": 1, **dict(zip("XYZABC", values, strict=True))})
        return lines

    @staticmethod
    def joint_path_to_g_code(joint_path: JointPath) -> Lines:
        """G1 with RA1, RA2 … [rad, m] for every vector of a path."""
        names = [f"{JOINT_KEY}{number + 1}" for number in range(len(joint_path.joint_order))]
        return [{"G": 1, **dict(zip(names, joints.values(), strict=True))} for joints, _ in joint_path]

    # ---- running

    def __iter__(self) -> GCodeProcessor:
        self._stand()
        self.elementary_operations: list[Operation] = []
        self.index_operation = self.index_g_code = 0
        return self

    def __next__(self) -> dict[str, Any] | None:
        if self.index_operation < len(self.elementary_operations):
            self.index_operation += 1
            self.elementary_operations[self.index_operation - 1]()
            return None
        if self.index_g_code >= len(self.g_code):
            raise StopIteration
        line = self.g_code[self.index_g_code]
        self.last_point, self.last_or = np.array(self.new_point), np.array(self.new_or)
        self.elementary_operations, self.index_operation = self._operations(line), 0
        self.index_g_code += 1
        return line

    def _operations(self, line: Mapping[str, Any]) -> list[Operation]:
        if "G" in line:
            if _POSE_WORDS & line.keys():
                return self._moves(line)
            if any(word.startswith(JOINT_KEY) for word in line):
                return [partial(self._robot.set_joint_position, self._joints(line))]
            return _named(self.g_commands, "G", line["G"]) if line["G"] > _LAST_OF_MOTION else []
        if "M" in line:
            return _named(self.m_commands, "M", line["M"])
        return [*_named(self.t_commands, "T", line["T"]), self._stand] if "T" in line else []

    def _moves(self, line: Mapping[str, Any]) -> list[Operation]:
        self._aim(line)
        go: Callable[[Any, Any], None]
        if self.active_endeffector == -1 or self.endeffector_list is None:
            go = self._robot.set_endeffector_pose
        else:
            go = self.endeffector_list[self.active_endeffector].set_tool_pose
        return [partial(go, position, orientation) for position, orientation, _ in self._path(line)]

    def _aim(self, line: Mapping[str, Any]) -> None:
        """Where the line ends: words that it does not have stay as they are."""
        unknown = line.keys() - _MOTION_WORDS
        if unknown:
            raise KeyError(f"a move has no word `{min(unknown)}`")
        point = [
            line[w] + o if w in line else at for w, at, o in zip("XYZ", self.last_point, self.offset[0], strict=True)
        ]
        angles = [line.get(w, last - o) for w, last, o in zip("ABC", self.last_or, self.offset[1], strict=True)]
        own, origin = p.getQuaternionFromEuler(angles), p.getQuaternionFromEuler(self.offset[1])
        turned = p.multiplyTransforms((0, 0, 0), own, (0, 0, 0), origin)[1]
        self.new_point, self.new_or = np.array(point, dtype=float), np.array(p.getEulerFromQuaternion(turned))

    def _path(self, line: Mapping[str, Any]) -> ToolPath:
        start, end = p.getQuaternionFromEuler(self.last_or), p.getQuaternionFromEuler(self.new_or)
        if line["G"] == 0:
            return linear_interpolation(self.last_point, self.new_point, 2, end)
        if line["G"] not in (1, 2, 3):
            raise ValueError(f"G{line['G']} is no move; G0 to G3 are")

        def drawn(samples: int) -> ToolPath:
            if line["G"] == 1:
                return linear_interpolation(self.last_point, self.new_point, samples, start, end)
            if "R" not in line:
                raise ValueError(f"G{line['G']} needs its radius, R")
            clockwise = line["G"] == 2
            ends = (self.last_point, self.new_point)
            return circular_interpolation(*ends, line["R"], samples, self.axis, clockwise, start, end)

        steps = np.diff(drawn(self.interpolation_approach).positions, axis=1)
        length = float(norms(np.ascontiguousarray(steps.T)).sum())
        return drawn(int(np.ceil(length / self.interpolation_precision)) + 1)

    def _joints(self, line: Mapping[str, Any]) -> dict[str, float]:
        words = ((word, value) for word, value in line.items() if word.startswith(JOINT_KEY))
        return {self.joint_order[int(word[len(JOINT_KEY) :]) - 1]: value for word, value in words}

    # ---- where it stands

    @property
    def _robot(self) -> RobotBase:
        if self.robot is None:
            raise ValueError("there is no robot to move; give one to GCodeProcessor")
        return self.robot

    def _held_tool(self) -> int:
        """The number of the first tool of the list that a robot holds; -1 if there is none."""
        tools = self.endeffector_list or ()
        return next((number for number, tool in enumerate(tools) if tool.is_coupled()), -1)

    def _stand(self) -> None:
        """Take over the pose of the tool in use, or of the robot."""
        self.active_endeffector = self._held_tool()
        pose: tuple[Array, Array]
        if self.active_endeffector == -1 or self.endeffector_list is None:
            pose = self._robot.get_endeffector_pose()
        else:
            pose = self.endeffector_list[self.active_endeffector].get_tool_pose()
        self.new_point, self.new_or = pose[0], np.array(p.getEulerFromQuaternion(pose[1]))

    def _set_offset(self) -> None:
        self.offset = np.array([self.last_point, self.last_or])

    def _clear_offset(self) -> None:
        self.offset = np.array(_NO_OFFSET)


def _named(commands: Commands, letter: str, number: Any) -> list[Operation]:
    if str(number) not in commands:
        raise KeyError(f"nothing is given for {letter}{number}")
    return list(commands[str(number)])


def _word(text: str, line: int) -> tuple[str, float | int]:
    name, equals, value = text.partition("=")
    if not equals:
        found = _WORD.match(text)
        if found is None:
            raise ValueError(f"line {line}: `{text}` is no word")
        name, value = found.groups()
    try:
        return name.upper(), float(value) if "." in value else int(value)
    except ValueError:
        raise ValueError(f"line {line}: `{text}` has no number") from None
