"""The unit of length."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.dialects.linuxcnc import UNITS
from gcodesim.rs274.watch.watch import FEEDS, Watch, word_span
from gcodesim.rs274.words import Words
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.watch.doubt import Doubt

_NAMES = {200: "inches", 210: "millimetres"}


class UnitChange(Watch):
    """GS186: moves in one unit after cuts in the other.

    A header may name both as long as nothing has moved, and the last lines may restore the unit of the shop.
    """

    def __init__(self) -> None:
        self._unit = 210
        self._cut: Span | None = None  # the first feed move in the unit in force
        self._change: Diagnostic | None = None  # waits for a move
        self._found: list[Diagnostic] = []

    def block(self, words: Words, control: Control) -> None:
        code = words.g.get(UNITS)
        if code is None or code == self._unit:
            return
        self._change = None
        if self._cut is not None and not control.span.callers:
            name = f"G{code // 10}"
            self._change = Diagnostic(
                code="GS186",
                message=f"{name} in mid-program: the program has cut in {_NAMES[self._unit]} so far, "
                f"from here 1 is {'25.4 mm' if code == 200 else '1 mm, no longer 25.4 mm'}",
                span=word_span(words, name.lower(), control),
                hint="write a program in one unit, and name it in the first lines",
                related=self._cut,
            )
        self._unit = code
        self._cut = None

    def event(self, event: canon.Event) -> None:
        if not isinstance(event, canon.Move):
            return
        if self._change is not None and event.word not in ("G28", "G30"):
            self._found.append(self._change)
            self._change = None
        if self._cut is None and isinstance(event, FEEDS):
            self._cut = event.span

    def doubt(self, doubt: Doubt) -> None:
        if doubt.may_say("g20", "g21"):
            self._unit = 210 if doubt.unit == MM else 200
            self._cut = self._change = None

    def somewhere(self, event: canon.Move) -> None:
        self.event(event)

    def moves(self, batch: MoveBatch) -> None:
        if self._change is not None:
            self._found.append(self._change)
            self._change = None
        feeds = batch.kind != 0
        if self._cut is None and feeds.any():
            self._cut = batch.span(int(feeds.argmax()))

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        return self._found[:1]
