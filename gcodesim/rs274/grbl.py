"""Running a Grbl program: what the small control leaves out, where a table of codes cannot say it."""

from __future__ import annotations

import math
import re
from dataclasses import replace

from gcodesim import canon
from gcodesim.canon.printing import MotionLimits
from gcodesim.diagnostics import SourceText, Span
from gcodesim.rs274.block import Block
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.linuxcnc import LENGTH, NON_MODAL, STOPPING
from gcodesim.rs274.executor import Executor
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.flow import FlowControl
from gcodesim.rs274.program_file import ProgramFile
from gcodesim.rs274.reader import Reader
from gcodesim.rs274.run import Run
from gcodesim.rs274.tokens import VERBATIM, Token
from gcodesim.rs274.words import Words
from gcodesim.units import MM

_REALTIME = "?!~"  # single characters that act at once, wherever they stand
_LAST_SYSTEM = 6
_LONGEST = 79  # characters in its buffer, without blanks and comments
_FREE = (math.inf, math.inf, math.inf, math.inf)
GRBL_LIMITS = MotionLimits(
    speed=_FREE,
    acceleration=_FREE,
    jerk=_FREE,
    printing=math.inf,
    retracting=math.inf,
    travel=math.inf,
    deviation=0.01 * MM,
    buffer=1000,
    plain=True,
)
"""Grbl 1.1: corners by `$11` as it is delivered (`DEFAULT_JUNCTION_DEVIATION` of its defaults.h is 0.01 mm); what axes
can do stands with them, and how many blocks it looks ahead in the dialect."""
_NOTE_OR_BLANK = re.compile(r"\([^)]*\)?|;.*|\s")


class GrblFile(ProgramFile):
    """Lines as Grbl takes them in; a percent sign is no end here, but an error."""

    def __init__(self, source: SourceText, reader: Reader) -> None:
        super().__init__(source, reader)
        self.has_percent, self.first = False, 0

    def block(self, index: int) -> Block:
        known = self._blocks.get(index)
        if known is None:
            known = self._reader.read(index + 1, _as_taken_in(self.lines[index]))
            if self._keeps:
                self._blocks[index] = known
        return known

    def tokens(self, index: int) -> list[Token]:
        text = self.lines[index]
        return [Token(VERBATIM, text, (0, len(text)))] if _as_taken_in(text) != text else super().tokens(index)


class GrblExecutor(Executor):
    """Blocks as in RS274, after what Grbl refuses."""

    def __init__(self, run: Run) -> None:
        super().__init__(run)
        self.settings = replace(self.settings, block_delete=False)  # it passes over the slash itself

    @property
    def _longest_plain_line(self) -> int:
        return _LONGEST

    def _parts(self, source: SourceText) -> tuple[ProgramFile, Control, FlowControl]:
        file = GrblFile(source, self.reader)
        control = Control(self.settings, self.dialect)
        return file, control, FlowControl(control, file, self.reader, self.folders)

    def _initial_path_control(self) -> None:
        super()._initial_path_control()
        limits = GRBL_LIMITS._replace(**self.settings.limits)
        self.control.out.append(canon.PlannerLimits(span=self.control.span, limits=limits))

    def _line(self, file: ProgramFile, index: int, text: str) -> None:
        if text.strip() == "%":
            self.control.span = Span.of_line(file.name, index + 1, text)
            self.control.warn("GS001", "Grbl answers a percent sign with an error", "senders leave it out; do so, too")
            return
        problem = _refusal(text)
        if problem is None:
            super()._line(file, index, text)
            if (lost := _lost_behind(text)) is not None:
                self.control.span = Span.of_line(file.name, index + 1, text)
                message = "the comment is never closed; Grbl passes over the rest of the line"
                self.control.warn("GS003", message, "add `)`", place=lost)
            return
        self.control.span = Span.of_line(file.name, index + 1, text)
        self._fault(problem, file, index, text, None)

    def _obey(self, words: Words) -> None:
        code = words.g.get(NON_MODAL)
        if code == 40 and (seconds := words.get("p")) is not None and seconds < 0.0:
            raise Fault("GS106", f"the dwell is negative: {seconds:g} s", at="p", value=seconds, limit=0)
        if code == 100:
            if not words.has_axes():
                raise Fault("GS103", "G10 needs at least one axis word", at="g10")
            number = words.whole("p", "G10")
            level = words.whole("l", "G10")
            if level not in (2, 20):
                raise Fault("GS105", "G10 knows L2 and L20 only", at="l" if "l" in words.values else "g10")
            if number is not None and number > _LAST_SYSTEM:
                raise Fault("GS106", f"G10 P{number}: P runs from 0 to 6", at="p", value=number, limit=_LAST_SYSTEM)
        if words.g.get(LENGTH) == 431 and {"x", "y"} & words.values.keys():
            raise Fault("GS106", "G43.1 takes Z only", at="g43.1")
        if words.m.get(STOPPING) == 1:
            del words.m[STOPPING]
            self.control.warn("GS194", "Grbl passes over M1: the program does not stop", hint="M0 stops it")
        super()._obey(words)


def _as_taken_in(text: str) -> str:
    """What Grbl makes of a line, column by column.

    A slash is passed over wherever it stands, a comment ends at the first `)` or with the line, and what is in it
    does not matter.
    """
    if "/" not in text and "(" not in text:
        return text
    out, inside = [], False
    for at, char in enumerate(text):
        if inside:
            inside = char != ")"
            out.append(" " if char == "(" else char)
        elif char == ";":
            out.append(text[at:])
            break
        else:
            inside = char == "("
            out.append(" " if char == "/" else char)
    return "".join(out) + ")" * inside


def _lost_behind(text: str) -> tuple[int, int] | None:
    """Where a comment stands that no bracket closes; None in other lines."""
    taken = _as_taken_in(text)
    return (taken.rindex("("), len(text)) if len(taken) > len(text) else None


def _refusal(text: str) -> Fault | None:
    """What is wrong with a line before it is read as a block."""
    head = text.lstrip()[:1]
    if head == "$":
        what = text.strip()
        hint = "send it to the control before the program, not with it"
        return Fault("GS001", f"`{what}` is a command to Grbl, not a block", at=(0, len(text)), hint=hint)
    if head == "%":
        return Fault("GS001", "Grbl knows no percent sign", at=(text.index("%"), text.index("%") + 1))
    length = len(_NOTE_OR_BLANK.sub("", text))
    if length > _LONGEST:
        message = f"the line has {length} characters besides blanks and comments; {_LONGEST} are allowed"
        return Fault("GS002", message, hint="split the line", value=length, limit=_LONGEST)
    for at, char in enumerate(text):
        if char in "(;":
            return None
        if char in _REALTIME:
            message = f"`{char}` acts on the running machine at once; it is no part of a block"
            return Fault("GS001", message, at=(at, at + 1))
    return None
