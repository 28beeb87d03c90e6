"""Teach pendant programs of Fanuc's robots as text (.ls)."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

import numpy as np

from gcodesim.diagnostics import Diagnostic, Severity
from gcodesim.frames import Array, Pose
from gcodesim.post.angles import rpy_of
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
from gcodesim.units import DEG, MM

REGISTER: Final = 99
"""The position register through which frames and tools are set; another program must not need it."""
FASTEST: Final = 2000.0
"""[mm/s] of a linear move."""
_LEAST_ZONE: Final = 1e-6  # [m] of a blend that is written
_WIDEST_COMMENT: Final = 32
_ACCELERATION: Final = 1.2
"""[m/s²] by which the tip is taken to brake where a zone becomes a CNT: an assumption, since the manuals name none. It
is what `ACCELERATION` is for another maker's arms of this size."""
_TURN: Final = 180.0 * DEG


class FanucLs(RobotLanguage):
    """`--for fanuc-ls`."""

    kind: ClassVar[str] = "fanuc-ls"
    says: ClassVar[str] = "Fanuc robots: NAME.ls; UFRAME, UTOOL, L, C, J, CNT, CONFIG, DO"
    most_moves: ClassVar[int] = 1000
    longest_name: ClassVar[int] = 24
    least_output: ClassVar[int] = 1

    def X_BK(self, program: RobotProgram) -> Pose:
        """The world frame of the control lies where axes 1 and 2 are at one height, above the root."""
        found = super().X_BK(program)
        if "base" in program.kinematics.link_names[1:]:
            return found
        arm = getattr(program.kinematics, "arm", None)
        if arm is None:
            return found
        return Pose(np.array(arm.p_BP), found.R)

    def write(self, program: RobotProgram) -> WrittenFiles:
        name = name_in(self, program.name).upper()
        parts = list(parts_of(program.steps, self.most_moves))
        writer = _Writer(self, program)
        if len(parts) == 1:
            files = {f"{name}.ls": writer.program_text(name, [*writer.opening(), *writer.body(parts[0])])}
            return WrittenFiles(files=files, findings=tuple(writer.findings))
        names = [f"{name}_{number}" for number in range(1, len(parts) + 1)]
        files = {f"{name}.ls": writer.program_text(name, [*writer.opening(), *(f"  CALL {one}" for one in names)])}
        for one, part in zip(names, parts, strict=True):
            files[f"{one}.ls"] = writer.program_text(one, ["  !a part, by gcodesim", *writer.body(part)])
        return WrittenFiles(files=files, findings=tuple(writer.findings))


class _Writer:
    """What the control knows so far, and the points of the file that is being written."""

    def __init__(self, language: FanucLs, program: RobotProgram) -> None:
        self.language, self.program = language, program
        self.findings: list[Diagnostic] = []
        self.points: list[str] = []
        self.counted = 0
        self.held: dict[str, int] = {}

    def program_text(self, name: str, lines: Sequence[str]) -> str:
        """A file with these lines, and the points that they have noted, which are forgotten then."""
        head = [
            f"/PROG  {name}",
            "/ATTR",
            "OWNER = MNEDITOR;",
            f'COMMENT = "{plain(self.program.source)[:16]}";',
            f"LINE_COUNT = {len(lines)};",
            "PROTECT = READ_WRITE;",
            "TCD:  STACK_SIZE = 0,",
            "      TASK_PRIORITY = 50,",
            "      TIME_SLICE = 0,",
            "      BUSY_LAMP_OFF = 0,",
            "      ABORT_REQUEST = 0,",
            "      PAUSE_REQUEST = 0;",
            "DEFAULT_GROUP = 1,*,*,*,*;",
            "CONTROL_CODE = 00000000 00000000;",
            "/MN",
        ]
        numbered = [f"{n:4d}:{line} ;" for n, line in enumerate(lines, start=1)]
        text = "".join(f"{line}\r\n" for line in [*head, *numbered, "/POS", *self.points, "/END"])
        self.points.clear()
        self.counted = 0
        return text

    def opening(self) -> Iterator[str]:
        """What stands first: comments, frames and tools."""
        for line in heading(self.program, self.language):
            yield from _remark(line)
        yield f"  PR[{REGISTER}]=LPOS"
        for n, frame in self.program.frames.items():
            yield from _set("UFRAME", n, self.language.X_KP(self.program, frame))
        for n, tool in enumerate(self.program.tools.values(), start=1):
            yield from _set("UTOOL", n, tool.X_FT)

    def body(self, steps: Sequence[RobotStep]) -> Iterator[str]:
        """The lines of these steps; their points are noted."""
        self.held.clear()
        for step in steps:
            yield from self._said(step)

    def _said(self, step: RobotStep) -> Iterator[str]:
        if isinstance(step, RobotMove):
            yield from self._move(step)
        elif isinstance(step, RobotWait):
            yield f"  WAIT {number(step.seconds, 2)}(sec)"
        elif isinstance(step, RobotAwait):
            yield f"  WAIT DI[{step.signal}]={'ON' if step.on else 'OFF'}"
        elif isinstance(step, RobotCall):
            yield f"  CALL {step.name.upper()}({step.argument})"
        elif isinstance(step, RobotHalt):
            yield from _remark(step.text)
            yield "  PAUSE"
        elif isinstance(step, Remark):
            yield from _remark(step.text)
        elif isinstance(step, RobotSwitch):
            if step.digital:
                yield f"  DO[{step.signal}]={'ON' if step.value else 'OFF'}"
            else:
                yield f"  AO[{step.signal}]={number(step.value, 3)}"

    def _move(self, move: RobotMove) -> Iterator[str]:
        tool = list(self.program.tools).index(move.tool) + 1
        for what, value in (("UFRAME_NUM", move.frame), ("UTOOL_NUM", tool)):
            if self.held.get(what) != value:
                self.held[what] = value
                yield f"  {what}={value}"
        if line_of(move) and self.held.get("line") != move.span.line:
            self.held["line"] = move.span.line
            yield f"  !{line_of(move)}"
        ending = self._ending(move)
        if move.kind == "joint":
            speed = f"{number(move.seconds, 2)}sec" if move.seconds >= 0.01 else f"{max(1, round(100.0 * move.share))}%"
            yield f"J P[{self._point(move, move.to, tool, by_joints=True)}] {speed} {ending}"
        elif move.via is None:
            yield f"L P[{self._point(move, move.to, tool)}] {self._speed(move)} {ending}"
        else:
            via, to = self._point(move, move.via, tool), self._point(move, move.to, tool)
            yield f"C P[{via}]\r\n    :  P[{to}] {self._speed(move)} {ending}"  # one instruction in two lines of text

    def _speed(self, move: RobotMove) -> str:
        """In mm/s if one digit behind the point says it, else in cm/min."""
        speed = move.speed / MM
        if speed > FASTEST:
            self._once(
                "GS803",
                move,
                f"the tip goes at {move.speed:.2f} m/s here; a line has at most {FASTEST * MM:g} m/s, which is posted",
                "the program will take longer than the run says",
            )
        speed = min(speed, FASTEST)
        if abs(round(speed, 1) - speed) < 1e-3 * speed:
            return f"{number(speed, 1)}mm/sec"
        return f"{number(max(speed * 6.0, 0.1), 1)}cm/min"

    def _ending(self, move: RobotMove) -> str:
        """How sharp the corner is. CNT is no distance: it says how early the robot may begin to turn, as a share of
        the way on which it would brake."""
        if move.blend <= _LEAST_ZONE:
            return "FINE"
        self._once(
            "GS804",
            move,
            "corners are rounded by CNT, which is no distance: how far they are cut depends on the robot",
            "watch the first corners at reduced speed, or write exact stops (G61.1) into the program",
        )
        braking = move.speed * move.speed / (2.0 * _ACCELERATION)
        share = 1.0 if move.kind == "joint" or braking <= 0.0 else move.blend / braking
        return f"CNT{max(1, min(100, round(100.0 * share)))}"

    def _once(self, code: str, move: RobotMove, message: str, hint: str) -> None:
        if all(finding.code != code for finding in self.findings):
            severity = Severity.WARNING if code == "GS803" else Severity.NOTE
            self.findings.append(Diagnostic(code=code, severity=severity, span=move.span, message=message, hint=hint))

    def _point(self, move: RobotMove, place: ArmPlace, tool: int, *, by_joints: bool = False) -> int:
        """Note a place; its number."""
        self.counted += 1
        n = self.counted
        self.points += [f"P[{n}]{{", "   GP1:"]
        frame = f"\tUF : {move.frame}, UT : {tool},"
        outside = [
            f"\tE{k}= {number(v, 3)} {'mm' if slides else 'deg'}"
            for k, (v, slides) in enumerate(
                zip(external_values(self.program, place), self.program.external_slides, strict=True), start=1
            )
        ]
        if by_joints:
            angles = [f"J{k}= {number(a, 5)} deg" for k, a in enumerate(degrees(_coupled(place)), start=1)]
            rows = [f"\t{',	'.join(angles[:3])}", f"\t{',	'.join(angles[3:])}", *outside]
            self.points += [frame, *(f"{row}," for row in rows[:-1]), rows[-1], "};"]
            return n
        p, R = seen_from(self.program.frames[move.frame].X_BP, place)
        xyz = ",\t".join(f"{letter} = {number(float(v), 4)} mm" for letter, v in zip("XYZ", p, strict=True))
        wpr = ",\t".join(f"{letter} = {number(v, 5)} deg" for letter, v in zip("WPR", rpy_of(R), strict=True))
        rows = [f"\t{xyz}", f"\t{wpr}", *outside]
        self.points += [f"{frame}\t\tCONFIG : '{self._config(move, place)}',"]
        self.points += [*(f"{row}," for row in rows[:-1]), rows[-1], "};"]
        return n

    def _config(self, move: RobotMove, place: ArmPlace) -> str:
        posture = posture_of(self.program.kinematics, place.q)
        if posture is None:
            self._once(
                "GS804",
                move,
                "the configuration of this arm is not told: its wrist is not spherical",
                "compare the joints of the first point on the control",
            )
            return "N U T, 0, 0, 0"
        # the wrist is not flipped while joint 5 is negative: the tool hangs down then with joint 4 at zero
        stands = (
            "N" if posture.wrist_negative else "F",
            "D" if posture.elbow_back else "U",
            "B" if posture.behind else "T",
        )
        turns = [math.floor((float(_coupled(place)[k]) + _TURN) / (2.0 * _TURN)) for k in (0, 3, 5)]
        return f"{' '.join(stands)}, {', '.join(map(str, turns))}"


def _coupled(place: ArmPlace) -> Array:
    """Joints as the control counts them: joint 3 from the horizontal, whatever joint 2 does."""
    q = np.array(place.q)
    if len(q) == 6:
        q[2] -= q[1]
    return q


def _set(what: str, n: int, X: Pose) -> Iterator[str]:
    values = [*(float(v) / MM for v in X.p), *rpy_of(X.R)]
    for k, value in enumerate(values, start=1):
        text = number(value, 4)
        yield f"  PR[{REGISTER},{k}]={f'({text})' if text.startswith('-') else text}"
    yield f"  {what}[{n}]=PR[{REGISTER}]"


def _remark(text: str) -> Iterator[str]:
    for line in textwrap.wrap(plain(text).replace(";", ","), _WIDEST_COMMENT) or [""]:
        yield f"  !{line}"
