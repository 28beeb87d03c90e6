"""KRL, the language of KUKA's controls (KSS 8): a program in .src, its points in the .dat beside it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, Final

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
from gcodesim.units import MM

FASTEST: Final = 3.0
"""[m/s] beyond which the control takes no `$VEL.CP`."""
_LEAST_ZONE: Final = 1e-6  # [m] of a blend that is written


class Krl(RobotLanguage):
    """`--for krl`."""

    kind: ClassVar[str] = "krl"
    says: ClassVar[str] = "KUKA: NAME.src and NAME.dat; BASE, TOOL, LIN, CIRC, PTP, C_DIS, $OUT"
    most_moves: ClassVar[int] = 2000
    longest_name: ClassVar[int] = 20
    least_output: ClassVar[int] = 1

    def write(self, program: RobotProgram) -> WrittenFiles:
        name = name_in(self, program.name)
        parts = list(parts_of(program.steps, self.most_moves))
        writer = _Writer(self, program)
        if len(parts) == 1:
            source, data = writer.module(name, parts[0], first=True)
            return WrittenFiles(files={f"{name}.src": source, f"{name}.dat": data}, findings=tuple(writer.findings))
        files: dict[str, str] = {}
        names = [f"{name}_{number}" for number in range(1, len(parts) + 1)]
        calls = [f"  {one}()" for one in names]
        files[f"{name}.src"] = _text([*_OPENING, f"DEF {name}()", *_comments(program, self), *calls, "END"])
        for one, part in zip(names, parts, strict=True):
            files[f"{one}.src"], files[f"{one}.dat"] = writer.module(one, part, first=one == names[0])
        return WrittenFiles(files=files, findings=tuple(writer.findings))


_OPENING: Final = ("&ACCESS RVP", "&REL 1")


class _Writer:
    """What the control knows so far: what holds already is not said again."""

    def __init__(self, language: Krl, program: RobotProgram) -> None:
        self.language, self.program = language, program
        self.findings: list[Diagnostic] = []
        self.held: dict[str, str] = {}

    def module(self, name: str, steps: Sequence[RobotStep], *, first: bool) -> tuple[str, str]:
        """Source and data of one module."""
        points: list[str] = []
        lines = [*_OPENING, f"DEF {name}()", *_comments(self.program, self.language)]
        if first:
            lines += [
                "  BAS(#INITMOV,0)",
                "  $ADVANCE=5",
                "  $ORI_TYPE=#VAR",
                "  $CIRC_TYPE=#BASE",
                "  $IPO_MODE=#BASE",
            ]
        for step in steps:
            lines += [f"  {line}" for line in self._said(step, points)]
        data = [*_OPENING, f"DEFDAT {name}", "  ; points, by gcodesim", *(f"  {point}" for point in points), "ENDDAT"]
        return _text([*lines, "END"]), _text(data)

    def _said(self, step: RobotStep, points: list[str]) -> Iterator[str]:
        if isinstance(step, RobotMove):
            yield from self._move(step, points)
        elif isinstance(step, RobotWait):
            yield f"WAIT SEC {number(step.seconds, 3)}"
        elif isinstance(step, RobotAwait):
            yield f"WAIT FOR $IN[{step.signal}]=={'TRUE' if step.on else 'FALSE'}"
        elif isinstance(step, RobotCall):
            yield f"{step.name}({step.argument})"
        elif isinstance(step, RobotHalt):
            yield f"HALT ; {plain(step.text)}"
        elif isinstance(step, Remark):
            yield f"; {plain(step.text)}"
        elif isinstance(step, RobotSwitch):
            yield self._switch(step)

    def _switch(self, step: RobotSwitch) -> str:
        if not step.digital:
            return f"$ANOUT[{step.signal}]={number(step.value, 6)}"
        setting = f"$OUT[{step.signal}]={'TRUE' if step.value else 'FALSE'}"
        return f"TRIGGER WHEN DISTANCE=0 DELAY=0 DO {setting}" if step.with_motion else setting

    def _move(self, move: RobotMove, points: list[str]) -> Iterator[str]:
        program = self.program
        yield from self._changed(
            "tool", f"$TOOL={_frame(program.tools[move.tool].X_FT)} ; {plain(program.tools[move.tool].name)}"
        )
        where = f" ; {line_of(move)}" if line_of(move) else ""
        if move.kind == "joint":
            yield from self._changed("share", f"BAS(#VEL_PTP,{max(1, round(100.0 * move.share))})")
            zone = " C_PTP" if move.blend > _LEAST_ZONE else ""
            points.append(f"DECL E6AXIS P{len(points) + 1}={self._axes(move.to)}")
            yield f"PTP P{len(points)}{zone}{where}"
            return
        frame = program.frames[move.frame]
        X_KP = self.language.X_KP(program, frame)
        yield from self._changed("base", f"$BASE={_frame(X_KP)} ; {frame.name}")
        if move.speed > FASTEST:
            self._too_fast(move)
        yield from self._changed("speed", f"$VEL.CP={number(min(move.speed, FASTEST), 6)}")
        zone = ""
        if move.blend > _LEAST_ZONE:
            yield from self._changed("zone", f"$APO.CDIS={number(move.blend / MM, 3)}")
            zone = " C_DIS"
        first = len(points) + 1
        for place in (move.to,) if move.via is None else (move.via, move.to):
            points.append(f"DECL E6POS P{len(points) + 1}={self._position(place, frame.X_BP)}")
        if move.via is None:
            yield f"LIN P{first}{zone}{where}"
        else:
            yield f"CIRC P{first},P{first + 1}{zone}{where}"

    def _changed(self, what: str, line: str) -> Iterator[str]:
        """The line that sets something, unless it stands so already."""
        if self.held.get(what) != line:
            self.held[what] = line
            yield line

    def _axes(self, place: ArmPlace) -> str:
        values = [f"A{k} {number(a, 5)}" for k, a in enumerate(degrees(place.q), start=1)]
        return "{" + ",".join([*values, *self._externals(place)]) + "}"

    def _position(self, place: ArmPlace, X_BP: Pose) -> str:
        p, R = seen_from(X_BP, place)
        posture = posture_of(self.program.kinematics, place.q)
        stands = []
        if posture is not None:
            status = posture.behind + 2 * (not posture.elbow_back) + 4 * posture.wrist_negative
            turn = sum(1 << k for k, angle in enumerate(degrees(place.q)) if angle < 0.0)
            stands = [f"S {status}", f"T {turn}"]
        return "{" + ",".join([*_words(p, R), *stands, *self._externals(place)]) + "}"

    def _externals(self, place: ArmPlace) -> list[str]:
        return [f"E{k} {number(v, 5)}" for k, v in enumerate(external_values(self.program, place), start=1)]

    def _too_fast(self, move: RobotMove) -> None:
        if any(finding.code == "GS803" for finding in self.findings):
            return
        self.findings.append(
            Diagnostic(
                code="GS803",
                severity=Severity.WARNING,
                span=move.span,
                message=f"the tip goes at {move.speed:.2f} m/s here; KRL takes {FASTEST:g} m/s, which is posted",
                value=move.speed,
                limit=FASTEST,
                unit="m/s",
                hint="the program will take longer than the run says",
            )
        )


def _words(p: Array, R: Array) -> list[str]:
    c, b, a = rpy_of(R)
    return [
        *(f"{letter} {number(float(v), 4)}" for letter, v in zip("XYZ", p, strict=True)),
        *(f"{letter} {number(v, 5)}" for letter, v in zip("ABC", (a, b, c), strict=True)),
    ]


def _frame(X: Pose) -> str:
    return "{" + ",".join(_words(X.p / MM, X.R)) + "}"


def _comments(program: RobotProgram, language: RobotLanguage) -> list[str]:
    return [f"  ; {line}" for line in heading(program, language)]


def _text(lines: Sequence[str]) -> str:
    return "".join(f"{line}\r\n" for line in lines)
