"""URScript, the language of Universal Robots' controls: one function that is called at the end of the file."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar, Final

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import Array, Pose
from gcodesim.post.angles import half_turn, rotation_vector
from gcodesim.post.language import RobotLanguage, WrittenFiles, heading, line_of, name_in, number, plain, seen_from
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
from gcodesim.units import MM

ACCELERATION: Final = 1.2
"""[m/s²] of the tip: what the control takes where a program does not say. Universal Robots, "The URScript Programming
Language", `movel(pose, a=1.2, v=0.25, t=0, r=0)`."""
JOINT_ACCELERATION: Final = 1.4
"""[rad/s²] of the joints, likewise: `movej(q, a=1.4, v=1.05, t=0, r=0)`."""
_LEAST_ZONE: Final = 1e-6  # [m] of a blend that is written


class UrScript(RobotLanguage):
    """`--for urscript`."""

    kind: ClassVar[str] = "urscript"
    says: ClassVar[str] = "Universal Robots: NAME.script; movel, movec, movej, blend radius, set_tcp, outputs"
    moves_externals: ClassVar[bool] = False

    def X_BK(self, program: RobotProgram) -> Pose:
        """The base of the control looks away from the arm at zero; that of most URDFs looks along it."""
        found = super().X_BK(program)
        kinematics = program.kinematics
        at_zero = kinematics.forward(program.joint_speeds[None] * 0.0)[0]
        if found.inverse().apply(at_zero[:3, 3])[0] > 0.0:
            return Pose(found.p, multiplied(found.R, half_turn()))
        return found

    def write(self, program: RobotProgram) -> WrittenFiles:
        name = name_in(self, program.name)
        lines = [f"# {line}" for line in heading(program, self)]
        lines.append(f"def {name}():")
        lines += [f"  {line}" for line in _frames(program, self)]
        tool = None
        for step in program.steps:
            if isinstance(step, RobotMove) and step.tool != tool:
                tool = step.tool
                lines += [f"  {line}" for line in _tool(program, tool)]
            lines += [f"  {line}" for line in _said(program, step)]
        return WrittenFiles(files={f"{name}.script": "".join(f"{line}\n" for line in [*lines, "end", f"{name}()"])})


def _frames(program: RobotProgram, language: UrScript) -> Iterator[str]:
    for n, frame in program.frames.items():
        X_KP = language.X_KP(program, frame)
        yield f"frame_{n} = {_pose(X_KP.p, X_KP.R)}"


def _tool(program: RobotProgram, number_of_tool: int) -> Iterator[str]:
    tool = program.tools[number_of_tool]
    yield f"set_tcp({_pose(tool.X_FT.p, tool.X_FT.R)})"
    if tool.mass > 0.0:
        centre = ",".join(number(v, 5) for v in tool.centre)
        yield f"set_target_payload({number(tool.mass, 4)}, [{centre}])"


def _said(program: RobotProgram, step: RobotStep) -> Iterator[str]:
    if isinstance(step, RobotMove):
        yield f"{_move(program, step)}{f'  # {line_of(step)}' if line_of(step) else ''}"
    elif isinstance(step, RobotWait):
        yield f"sleep({number(step.seconds, 3)})"
    elif isinstance(step, RobotAwait):
        yield f"while get_standard_digital_in({step.signal}) != {step.on}:"
        yield from ("  sync()", "end")
    elif isinstance(step, RobotCall):
        yield f"{step.name}({step.argument})"
    elif isinstance(step, RobotHalt):
        text = plain(step.text).replace('"', "'")
        yield f'popup("{text}", title="gcodesim", blocking=True)'
    elif isinstance(step, Remark):
        yield f"# {plain(step.text)}"
    elif isinstance(step, RobotSwitch):
        if step.digital:
            yield f"set_standard_digital_out({step.signal}, {bool(step.value)})"
        else:
            yield f"set_standard_analog_out({step.signal}, {number(step.value, 6)})"


def _move(program: RobotProgram, move: RobotMove) -> str:
    radius = number(move.blend, 6) if move.blend > _LEAST_ZONE else "0"
    if move.kind == "joint":
        joints = ",".join(number(float(q), 7) for q in move.to.q)
        speed = number(max(move.share * float(program.joint_speeds.max()), 0.001), 5)
        time = f", t={number(move.seconds, 4)}" if move.seconds else ""
        return f"movej([{joints}], a={JOINT_ACCELERATION:g}, v={speed}{time}, r={radius})"
    X_BP, frame = program.frames[move.frame].X_BP, f"frame_{move.frame}"
    along = f"a={ACCELERATION:g}, v={number(move.speed, 6)}, r={radius}"
    to = f"pose_trans({frame}, {_place(move.to, X_BP)})"
    if move.via is None:
        return f"movel({to}, {along})"
    return f"movec(pose_trans({frame}, {_place(move.via, X_BP)}), {to}, {along}, mode=1)"


def _place(place: ArmPlace, X_BP: Pose) -> str:
    p, R = seen_from(X_BP, place)
    return _pose(p * MM, R)


def _pose(p: Array, R: Array) -> str:
    values = [*(number(float(v), 7) for v in p), *(number(v, 8) for v in rotation_vector(R))]
    return f"p[{','.join(values)}]"
