"""The length offset: of another tool, or of the tool before."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Findings, Span
from gcodesim.rs274.dialects.linuxcnc import CHANGING, LENGTH, NON_MODAL
from gcodesim.rs274.watch.watch import FEEDS, TINY, Watch, word_span
from gcodesim.rs274.words import Words
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.watch.doubt import Doubt

_OF_TABLE = frozenset((430, 434, 435, 440))  # G43, G43.4, G43.5, G44: the length of H
_DYNAMIC = frozenset((431, 432))
_SECOND_SETS = 20  # H21 or H101 for T1 is a second set of offsets of the same tool


def _length(number: int, control: Control) -> float:
    """Length of a tool [mm] as the table has it."""
    entry = control.tools.get(number)
    return entry.offset[2] / MM if entry is not None else 0.0


class LengthOfAnotherTool(Watch):
    """GS161: G43 H2 while T1 is in the spindle."""

    def __init__(self) -> None:
        self._found = Findings()
        self._sure = True  # which tool is in the spindle

    def doubt(self, doubt: Doubt) -> None:
        self._sure = self._sure and not ("t" in doubt.letters or doubt.may_say("m6"))

    def block(self, words: Words, control: Control) -> None:
        self._sure = self._sure or ("t" in words.values and CHANGING in words.m)
        if not self._sure:
            return
        if words.g.get(LENGTH) not in _OF_TABLE or "h" not in words.values:
            return
        tool, number = control.state.tool, round(words.values["h"])
        if not tool or not number or number == tool or _is_second_set(number, tool):
            return
        own, other = _length(tool, control), _length(number, control)
        self._found.add(
            Diagnostic(
                code="GS161",
                message=f"H{number} is not the tool in the spindle, T{tool}"
                + (f": {other:.3f} mm are taken into account, it is {own:.3f} mm long" if own != other else ""),
                span=word_span(words, "h", control),
                hint=f"write G43 H{tool}, or G43 alone for the tool in the spindle"
                if control.dialect.name == "linuxcnc"
                else f"write G43 H{tool}",
                value=other,
                limit=own,
                unit="mm",
            ),
            key=(tool, number),
        )

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        return self._found


def _is_second_set(number: int, tool: int) -> bool:
    ahead = number - tool
    return ahead >= _SECOND_SETS and ahead % 10 == 0


class MoveWithoutLength(Watch):
    """GS162: after a tool change the tool moves in Z or cuts before G43, in a program that uses G43.

    A probe that measures the tool has no length yet; nor have G28, G30 and G53, which
    name places of the machine.
    """

    def __init__(self) -> None:
        self._uses = False  # G43 anywhere in the program
        self._length_of: int | None = None  # the tool whose length is in force
        self._offset = 0.0  # [mm]
        self._pending: tuple[int, Span] | None = None  # tool and change without a length so far
        self._own = 0.0
        self._machine = False  # the block at hand moves in machine coordinates
        self._added = 0.0  # [m] of the offset in force: with it Z is that of the machine
        self._at: canon.Point | None = None  # [m] X, Y, Z; None before the first move, which may start anywhere
        self._tip = False  # the control holds the tip, so that X, Y, Z are those of the work
        self._up: canon.Point = (0.0, 0.0, 1.0)  # along the tool; it leans with a plane on which the tool stands
        self._at_home = False  # the last move of Z was one to a place of the machine
        self._found: list[Diagnostic] = []

    def block(self, words: Words, control: Control) -> None:
        if CHANGING in words.m:
            tool = control.state.tool
            self._pending = None
            if tool and tool != self._length_of:
                self._pending = (tool, control.span)
                self._own = _length(tool, control)
        code = words.g.get(LENGTH)
        if code is not None:
            self._pending = None
            if code in _OF_TABLE or code in _DYNAMIC:
                self._uses = True
                number = round(words.values.get("h", 0.0)) if code in _OF_TABLE else 0
                self._length_of = number or control.state.tool
                self._offset = _length(self._length_of, control)
            else:
                self._length_of = None
        self._machine = words.g.get(NON_MODAL) in (530, 280, 300)
        self._up = control.normal(2) if control.state.point_control else (0.0, 0.0, 1.0)

    def settled(self, words: Words, control: Control) -> None:
        self._machine = False

    def doubt(self, doubt: Doubt) -> None:
        self._at = None
        if not doubt.letters.isdisjoint("th") or doubt.may_say("m6", "g43", "g44", "g49", "g43.1", "g43.2", "g43.4"):
            self._pending = None
            self._at_home = True

    def event(self, event: canon.Event) -> None:
        if not isinstance(event, canon.Move):  # asked first: nearly all of them are moves
            if isinstance(event, canon.ToolOffset):
                self._added = event.offset[2]
            elif isinstance(event, canon.PointControl):
                self._tip = event.on
                self._at = self._place(event.at)
            return
        before, self._at = self._at, self._place(event.end)
        of_machine = self._machine or (isinstance(event, canon.Rapid) and event.word in ("G28", "G30"))
        climbs = before is not None and abs(self._climb(before, self._at)) > TINY
        if climbs or before is None:
            self._at_home = of_machine
        if self._pending is None or of_machine:
            return
        if isinstance(event, canon.ProbeMove):
            self._pending = None
        elif climbs or (isinstance(event, FEEDS) and not self._at_home):
            self._report(event.span)

    def _place(self, end: canon.Axes) -> canon.Point:
        """Where the spindle stands, whatever the length: with the tip held, X, Y, Z are told anew when that changes."""
        return (end[0], end[1], end[2] if self._tip else end[2] + self._added)

    def _climb(self, start: canon.Point, end: canon.Point) -> float:
        x, y, z = self._up
        return x * (end[0] - start[0]) + y * (end[1] - start[1]) + z * (end[2] - start[2])

    def _report(self, span: Span) -> None:
        assert self._pending is not None
        tool, change = self._pending
        self._pending = None
        if self._length_of is None:
            state = "without a length offset"
        else:
            state = f"with the length offset of T{self._length_of}"
        numbers = f" ({self._offset if self._length_of else 0.0:.3f} mm)" if self._own or self._offset else ""
        own = f"; T{tool} is {self._own:.3f} mm long" if self._own else ""
        self._found.append(
            Diagnostic(
                code="GS162",
                message=f"T{tool} moves {state}{numbers}, though the program uses G43{own}",
                span=span,
                hint=f"say G43 H{tool} after the tool change",
                related=change,
                value=self._offset if self._length_of else 0.0,
                limit=self._own,
                unit="mm",
            )
        )

    def moves(self, batch: MoveBatch) -> None:
        rest = self.singly_until(batch, lambda: self._pending is None)
        if len(rest):
            x, y, z, a, b, c = rest.end[-1].tolist()
            self._at, self._at_home = self._place((x, y, z, a, b, c)), False

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        return self._found if self._uses else ()
