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
_CYCLES: Final = frozenset((*(float(code) for code in range(70, 77)), 90.0, 92.0, 94.0))
_OF_LATHE: Final = frozenset("xzuw")
_STRAIGHT: Final = (0, 10)
"""G0 and G1: motions that an approach may end with, so that a block without a G word goes on with them."""


@frozen(eq=False)
class Halted:
    """The `control` as it is when the line is reached, the `file` of the program, and the calls that led there.

    Where cycles of a lathe stay in force or have two lines: the `cycle` in force (90, 92, 94), and the `prepared` ones,
    whose first line has been read. `in_face_plane`: it is between G12.1 and G13.1.
    """

    control: Control
    file: ProgramFile
    frames: tuple[Frame, ...]
    cycle: float | None = None
    prepared: frozenset[float] = frozenset()
    in_face_plane: bool = False

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
        if self.in_face_plane:
            yield "X and C are a plane (polar coordinate interpolation, G12.1)"
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
        if self._is_second(line):
            yield "it is the second of two lines of one cycle"
        if (motion := self._continued(line)) is not None:
            number, code = motion
            yield f"line {number} goes on with the {code.upper()} of an earlier line, whose words it needs"

    def _is_second(self, line: int) -> bool:
        """Whether `line` names a prepared cycle, and the line before it does, too."""
        if not self.prepared:
            return False
        here = self._codes(line - 1) & self.prepared
        before = next((self._codes(i) for i in range(line - 2, -1, -1) if self.file.lines[i].strip()), frozenset())
        return bool(here & before)

    def _codes(self, index: int) -> frozenset[float]:
        """The numbers of the G words of a line, as far as they are written."""
        try:
            words = self.file.block(index).words
        except Fault:
            return frozenset()
        return frozenset(value for letter, value in words if letter == "g" and isinstance(value, float))

    def _continued(self, line: int) -> tuple[int, str] | None:
        """The first line from `line` on that goes on with a motion in which an approach cannot end, and that motion."""
        state, dialect = self.control.state, self.control.dialect
        if self.cycle is None and (state.motion in _STRAIGHT or state.motion < 0):
            return None
        for index in range(line - 1, len(self.file.lines)):
            try:
                block = self.file.block(index)
            except Fault:
                return None
            letters = {letter for letter, _ in block.words}
            codes = self._codes(index)
            groups = {dialect.g_groups.get(round(code * 10.0)) for code in codes}
            if MOTION in groups or (self.cycle is not None and codes & _CYCLES) or block.flow is not None:
                return None
            if letters & (AXIS_LETTERS if self.cycle is None else _OF_LATHE):
                return index + 1, g_name(state.motion if self.cycle is None else round(10.0 * self.cycle))
        return None
