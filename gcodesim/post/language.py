"""What the language of a robot's control is, whoever adds one: it says a `RobotProgram` in its words."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar, Final

import numpy as np

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.diagnostics import Diagnostic
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.post.moves import ArmPlace, RobotMove, RobotProgram, RobotStep, ToldFrame
from gcodesim.units import DEG, MM

_NO_LETTER: Final = re.compile(r"[^A-Za-z0-9_]")
DIGITS: Final = 5
"""Behind the point, of an angle in degrees."""
_LATE: Final = 0.8  # of the most moves of a file, from which on it ends where the robot stands


@frozen
class WrittenFiles:
    """Files by name, the one to start first; and what of the program they do not say."""

    files: Mapping[str, str]
    findings: tuple[Diagnostic, ...] = ()


class RobotLanguage:
    """The base of all languages. `kind` is the name in the table `LANGUAGES` and on the command line.

    `says` tells in a line what comes out. `most_moves` is how many moves one file takes: longer programs are divided.
    `longest_name` counts the letters of a program's name. `least_output` is the number of the first digital output, for
    languages that number them, and `moves_externals` says whether external axes can be told.
    """

    kind: ClassVar[str] = ""
    says: ClassVar[str] = ""
    most_moves: ClassVar[int] = 4000
    longest_name: ClassVar[int] = 24
    least_output: ClassVar[int] = 0
    moves_externals: ClassVar[bool] = True

    def write(self, program: RobotProgram) -> WrittenFiles:
        """The program in files of this language."""
        raise NotImplementedError

    def signal(self, digital: bool, number: int) -> str:
        """The usual name of an output with this number; empty where there is none."""
        return str(number) if number >= self.least_output else ""

    def X_BK(self, program: RobotProgram) -> Pose:
        """The base frame K of the control, in which frames are told, seen from the base of the arm.

        The link `base` of the robot description, if it stands on the ground and is not the root: this is how
        ROS-Industrial names it. Else the root.
        """
        kinematics = program.kinematics
        names = kinematics.link_names
        if "base" in names[1:]:
            at = names.index("base")
            rest = np.zeros((1, len(kinematics.joints)))
            X = kinematics.link(rest, at)[0]
            if np.array_equal(X, kinematics.link(rest + 0.1, at)[0]):
                return Pose.from_matrix(X)
        return Pose.identity()

    def X_KP(self, program: RobotProgram, frame: ToldFrame) -> Pose:
        """A frame of the program seen from the base of the control."""
        return self.X_BK(program).inverse() @ frame.X_BP


def name_in(language: RobotLanguage, text: str) -> str:
    """A name of letters, digits and underscores for a program that is called `text`; it begins with a letter."""
    name = _NO_LETTER.sub("_", text.rpartition("/")[2].partition(".")[0]) or "program"
    name = name if name[0].isalpha() else f"p{name}"
    return name[: language.longest_name]


def seen_from(X_BP: Pose, place: ArmPlace) -> tuple[Array, Array]:
    """Tip of a place in the frame P: position (3,) [mm] and rotation (3, 3)."""
    X = multiplied(inverse_pose(X_BP.matrix), place.X_BT.matrix)
    return X[:3, 3] / MM, X[:3, :3]


def parts_of(steps: Sequence[RobotStep], most: int) -> Iterator[Sequence[RobotStep]]:
    """The steps in parts of at most `most` moves; a part ends where the robot stands, if it does so near its end."""
    begin = moves = 0
    rest = -1
    for number, step in enumerate(steps):
        if not isinstance(step, RobotMove):
            continue
        moves += 1
        if step.blend == 0.0 and moves >= _LATE * most:
            rest = number
        if moves >= most:
            end = (rest if rest > begin else number) + 1
            yield steps[begin:end]
            moves = sum(isinstance(one, RobotMove) for one in steps[end : number + 1])
            begin, rest = end, -1
    if begin < len(steps) or not steps:
        yield steps[begin:]


def number(value: float, digits: int) -> str:
    """A number with so many digits behind the point; no minus before zero."""
    text = f"{value:.{digits}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def plain(text: str) -> str:
    """A text that fits into a comment of any control: ASCII, one line."""
    return "".join(c if " " <= c <= "~" else "?" for c in text.replace("\t", " "))


def degrees(angles: Array) -> list[float]:
    """Angles [rad] in degrees, as exactly as they are written: what turns and quadrants say fits to the numbers."""
    return [round(float(a) / DEG, DIGITS) + 0.0 for a in angles]


def line_of(step: RobotStep) -> str:
    """The line of the program, as `line 12`; with the file where that is a subprogram."""
    return f"line {step.span.line}" if step.span.line else ""


def external_values(program: RobotProgram, place: ArmPlace) -> list[float]:
    """Where external axes stand [mm, deg]."""
    return [
        float(value) / (MM if slides else DEG)
        for value, slides in zip(place.externals, program.external_slides, strict=True)
    ]


def heading(program: RobotProgram, language: RobotLanguage) -> list[str]:
    """Lines that stand at the top of a program, without the marks of a comment."""
    lines = [f"{program.source} in {program.cell}, as gcodesim has checked it ({language.kind})"]
    lines += [f"frame {n}: {frame.name}" for n, frame in program.frames.items()]
    lines += [f"tool {n}: {tool.name}" for n, tool in program.tools.items()]
    if program.external_names:
        lines.append(f"external axes, from the first on: {', '.join(program.external_names)}")
    return [plain(line) for line in lines]
