"""RAPID, the language of ABB's controls (IRC5, OmniCore): a module, or several for long programs."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar, Final

from gcodesim.frames import Array, Pose
from gcodesim.post.angles import quaternion
from gcodesim.post.language import (
    RobotLanguage,
    WrittenFiles,
    degrees,
    external_values,
    heading,
    line_of,
    name_in,
    number,
    parts_of,
    plain,
    seen_from,
)
from gcodesim.post.moves import (
    ArmPlace,
    Remark,
    RobotAwait,
    RobotCall,
    RobotHalt,
    RobotMove,
    RobotProgram,
    RobotStep,
    RobotSwitch,
    RobotWait,
)
from gcodesim.post.posture import posture_of
from gcodesim.units import MM

_NO_AXIS: Final = "9E9"
_AXES: Final = 6  # external ones that a target has
_LEAST_ZONE: Final = 1e-6  # [m] of a blend that is written
_FULL_SPEED: Final = 7.0  # [m/s] that stands for full speed of the joints
_LEAST_MASS: Final = 0.001  # [kg] of a tool that a control takes


class RapidCode(RobotLanguage):
    """`--for rapid`."""

    kind: ClassVar[str] = "rapid"
    says: ClassVar[str] = "ABB: NAME.mod; wobjdata, tooldata, MoveL, MoveC, MoveAbsJ, zones, confdata, SetDO"
    most_moves: ClassVar[int] = 4000
    longest_name: ClassVar[int] = 24

    def signal(self, digital: bool, number: int) -> str:
        return f"{'do' if digital else 'ao'}{number}"

    def write(self, program: RobotProgram) -> WrittenFiles:
        name = name_in(self, program.name)
        parts = list(parts_of(program.steps, self.most_moves))
        writer = _Writer(self, program)
        head = [f"  ! {line}" for line in heading(program, self)]
        data = [f"  {line}" for line in writer.declared()]
        if len(parts) == 1:
            body = writer.procedure(name, parts[0])
            return WrittenFiles(files={f"{name}.mod": _module(name, [*head, *data, *body])})
        names = [f"{name}_{number}" for number in range(1, len(parts) + 1)]
        calls = [f"  PROC {name}()", *(f"    {one};" for one in names), "  ENDPROC"]
        files = {f"{name}.mod": _module(f"{name}_0", [*head, *data, *calls])}
        for one, part in zip(names, parts, strict=True):
            files[f"{one}.mod"] = _module(
                f"{one}_m", [f"  ! a part of {name}, by gcodesim", *writer.procedure(one, part)]
            )
        return WrittenFiles(files=files)


def _module(name: str, lines: Iterable[str]) -> str:
    return "".join(f"{line}\r\n" for line in [f"MODULE {name}", *lines, "ENDMODULE"])


class _Writer:
    """Puts steps into words, each of which says all that holds for it."""

    def __init__(self, language: RapidCode, program: RobotProgram) -> None:
        self.language, self.program = language, program

    def declared(self) -> Iterator[str]:
        """Tools and work objects. Where the arm stands on a track, its base frame has to be moved by that on the
        control."""
        for n, tool in self.program.tools.items():
            load = ",".join(number(v / MM, 3) for v in tool.centre)
            mass = number(max(tool.mass, _LEAST_MASS), 4)
            yield f"PERS tooldata tool_{n}:=[TRUE,{_pose(tool.X_FT)},[{mass},[{load}],[1,0,0,0],0,0,0]];"
        for n, frame in self.program.frames.items():
            X_KP = self.language.X_KP(self.program, frame)
            yield f'PERS wobjdata wobj_{n}:=[FALSE,TRUE,"",{_pose(X_KP)},[[0,0,0],[1,0,0,0]]];'

    def procedure(self, name: str, steps: Sequence[RobotStep]) -> Iterator[str]:
        yield f"  PROC {name}()"
        taken = -1
        for at, step in enumerate(steps):
            if at == taken:
                continue
            after = steps[at + 1] if at + 1 < len(steps) else None
            if _at_corner(step, after):
                taken = at + 1
            for line in self._said(step, after if taken == at + 1 else None):
                yield f"    {line}"
        yield "  ENDPROC"

    def _said(self, step: RobotStep, switch: RobotStep | None) -> Iterator[str]:
        if isinstance(step, RobotMove):
            yield self._move(step, switch if isinstance(switch, RobotSwitch) else None)
        elif isinstance(step, RobotWait):
            yield f"WaitTime \\InPos,{number(step.seconds, 3)};"
        elif isinstance(step, RobotAwait):
            yield f"WaitDI {step.signal},{int(step.on)};"
        elif isinstance(step, RobotCall):
            yield f"{step.name} {step.argument};"
        elif isinstance(step, RobotHalt):
            yield f"! {plain(step.text)}"
            yield "Stop;"
        elif isinstance(step, Remark):
            yield f"! {plain(step.text)}"
        elif isinstance(step, RobotSwitch):
            yield f"SetDO {step.signal},{int(bool(step.value))};" if step.digital else _analog(step)

    def _move(self, move: RobotMove, switch: RobotSwitch | None) -> str:
        where = f" ! {line_of(move)}" if line_of(move) else ""
        zone = "fine" if move.blend <= _LEAST_ZONE else _zone(move.blend)
        tool = f"tool_{move.tool}"
        if move.kind == "joint":
            joints = ",".join(number(v, 5) for v in degrees(move.to.q))
            speed = _speed(max(move.share * _FULL_SPEED, 0.001))
            if move.seconds:
                speed += f"\\T:={number(move.seconds, 4)}"
            return f"MoveAbsJ [[{joints}],{self._externals(move.to)}]\\NoEOffs,{speed},{zone},{tool};{where}"
        frame = self.program.frames[move.frame]
        to, speed = self._target(move.to, frame.X_BP), _speed(move.speed)
        along = f"{speed},{zone},{tool}\\WObj:=wobj_{move.frame}"
        if move.via is not None:
            return f"MoveC {self._target(move.via, frame.X_BP)},{to},{along};{where}"
        if switch is not None:
            return f"MoveLDO {to},{along},{switch.signal},{int(bool(switch.value))};{where}"
        return f"MoveL {to},{along};{where}"

    def _target(self, place: ArmPlace, X_BP: Pose) -> str:
        p, R = seen_from(X_BP, place)
        tip = ",".join(number(float(v), 4) for v in p)
        return f"[[{tip}],{_quaternion(R)},{self._conf(place)},{self._externals(place)}]"

    def _conf(self, place: ArmPlace) -> str:
        """Quadrants of axes 1, 4 and 6, and how the arm stands."""
        quarters = [math.floor(a / 90.0) for a in degrees(place.q)[:6]]
        posture = posture_of(self.program.kinematics, place.q)
        stands = 0 if posture is None else 4 * posture.behind + 2 * posture.elbow_back + posture.wrist_negative
        return f"[{quarters[0]},{quarters[3]},{quarters[5]},{stands}]"

    def _externals(self, place: ArmPlace) -> str:
        values = [number(v, 5) for v in external_values(self.program, place)]
        return f"[{','.join([*values, *[_NO_AXIS] * (_AXES - len(values))])}]"


def _at_corner(step: RobotStep, after: RobotStep | None) -> bool:
    """Whether an output is switched in the corner at the end of a line: one instruction says both."""
    line = isinstance(step, RobotMove) and step.kind == "linear"
    return line and isinstance(after, RobotSwitch) and after.digital and after.with_motion


def _analog(step: RobotSwitch) -> str:
    return f"SetAO {step.signal},{number(step.value, 6)};"


def _pose(X: Pose) -> str:
    return f"[[{','.join(number(float(v) / MM, 4) for v in X.p)}],{_quaternion(X.R)}]"


def _quaternion(R: Array) -> str:
    """q1 to q4, of which q1 is the real part."""
    x, y, z, w = quaternion(R)
    return f"[{','.join(number(float(v), 9) for v in (w, x, y, z))}]"


def _speed(speed: float) -> str:
    """Of the tip [mm/s], of turns [deg/s], of external axes [mm/s, deg/s]."""
    return f"[{number(speed / MM, 3)},500,5000,1000]"


def _zone(blend: float) -> str:
    """The tip's zone [mm], those of turns and of external axes half as much again, as in the data of the control."""
    tip, wide = number(blend / MM, 3), number(1.5 * blend / MM, 3)
    turn = number(max(0.15 * blend / MM, 0.01), 3)
    return f"[FALSE,{tip},{wide},{wide},{turn},{wide},{turn}]"
