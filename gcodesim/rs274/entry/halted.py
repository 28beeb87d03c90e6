"""A control that has executed all lines before one, and what keeps others from going on there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from gcodesim.frozen import frozen
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.linuxcnc import MOTION
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import ZERO
from gcodesim.rs274.words import AXIS_LETTERS

if TYPE_CHECKING:
    from gcodesim.diagnostics import SourceText
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.frame import Frame
    from gcodesim.rs274.program_file import ProgramFile

_G52: Final = 520
_STRAIGHT: Final = (0, 10)
"""G0 and G1: motions that an approach may end with, so that a block without a G word goes on with them."""


@frozen
class Modal:
    """A G word, ten times its number, that goes on where a block has words of some letters and no G word of motion.

    G words of the numbers `ended_by` end it, too.
    """

    code: int
    repeated_by: frozenset[str]
    ended_by: frozenset[float] = frozenset()


@frozen(eq=False)
class Halted:
    """The `control` as it is when the line is reached, the `file` of the program, and the calls that led there."""

    control: Control
    file: ProgramFile
    frames: tuple[Frame, ...]

    def inside(self, source: SourceText) -> Halted:
        """The same in the whole program, where what was read ends at the line."""
        return replace(self, file=self.file.of(source))

    def obstacles(self, line: int) -> Iterator[str]:
        """Why nobody can begin at `line`: what it is inside of, in the words of a finding."""
        state, control = self.control.state, self.control
        if len(self.frames) > 1:
            yield "it is in a subroutine, which knows only its caller where it goes on"
        for opened in self.file.outline.open_at(line - 1):
            yield f"it is inside the `{opened.keyword}` of line {opened.at + 1}"
        if state.side:
            yield "cutter compensation is on, and begins only with a move of its own"
        if state.point_control:
            yield "the control holds the tip of the tool while axes turn (G43.4, G43.5)"
        if self.frames[-1].calls_at_moves:
            yield "each move calls a macro (G66)"
        if control.has_figure:
            yield "the plane of the program is tilted, turned, scaled or mirrored"
        can_shift = _G52 in control.dialect.g_groups or control.dialect.prints
        if control.shift() != ZERO and not can_shift:
            yield "the shift of G92 is in force, which this control can only set where the tool stands"
        if state.nurbs_order:
            yield "it is inside a spline"
        if state.strayed is not None:
            yield "the position after G88 is the operator's"
        yield from self.own_obstacles(line)
        if (modal := self._in_force()) is not None and (number := self._repeated(line, modal)) is not None:
            code = g_name(modal.code).upper()
            yield f"line {number} goes on with the {code} of an earlier line, whose words it needs"

    def own_obstacles(self, line: int) -> Iterator[str]:
        """Those of one kind of machine."""
        yield from ()

    def cycle(self) -> Modal | None:
        """A cycle of one kind of machine that is in force."""
        return None

    def codes(self, index: int) -> frozenset[float]:
        """The numbers of the G words of a line, as far as they are written."""
        try:
            words = self.file.block(index).words
        except Fault:
            return frozenset()
        return frozenset(value for letter, value in words if letter == "g" and isinstance(value, float))

    def _in_force(self) -> Modal | None:
        motion = self.control.state.motion
        straight = motion in _STRAIGHT or motion < 0
        return self.cycle() or (None if straight else Modal(code=motion, repeated_by=AXIS_LETTERS))

    def _repeated(self, line: int, modal: Modal) -> int | None:
        """The first line from `line` on that goes on with what is in force."""
        groups = self.control.dialect.g_groups
        for index in range(line - 1, len(self.file.lines)):
            try:
                block = self.file.block(index)
            except Fault:
                return None
            codes = self.codes(index)
            moves = any(groups.get(round(code * 10.0)) == MOTION for code in codes)
            if moves or codes & modal.ended_by or block.flow is not None:
                return None
            if {letter for letter, _ in block.words} & modal.repeated_by:
                return index + 1
        return None
