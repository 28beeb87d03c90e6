"""Cutter compensation: rapids below the safe height, and compensation still on when the program ends."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.linuxcnc import COMPENSATION, STOPPING
from gcodesim.rs274.watch.watch import TINY, Watch, word_span
from gcodesim.rs274.words import Words
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.watch.doubt import Doubt

_OFF, _G17 = 400, 170
_ENDS = frozenset((2, 30))


class RapidInCompensation(Watch):
    """GS154: a rapid goes sideways on the offset path, lower than where rapids went before it was switched on.

    A path that is offset from the contour is at the contour. On lathes, where it lies along Z, no height is safe.
    """

    def __init__(self) -> None:
        self._on = False
        self._safe: float | None = None  # where the last rapid ended that was not in compensation, or rose
        self._at: tuple[float, ...] | None = None
        self._zero = 0.0
        self._leaving: Span | None = None  # the block of G40: moves held back until then are still on the path
        self._found: list[Diagnostic] = []

    def block(self, words: Words, control: Control) -> None:
        code = words.g.get(COMPENSATION)
        self._on = control.state.plane == _G17 and (self._on or code not in (None, _OFF))
        self._leaving = control.span if code == _OFF else None

    def doubt(self, doubt: Doubt) -> None:
        self._safe = self._at = None
        if doubt.may_say("g40", "g41", "g42", "g41.1", "g42.1"):
            self._on = False

    def settled(self, words: Words, control: Control) -> None:
        if words.g.get(COMPENSATION) == _OFF or words.m.get(STOPPING) in _ENDS:
            self._on = False

    def event(self, event: canon.Event) -> None:
        if isinstance(event, canon.WorkSystem):
            self._zero = event.offset[2] + event.g92[2]
        if not isinstance(event, canon.Move):
            return
        at, self._at = self._at, event.end
        if not isinstance(event, canon.Rapid):
            return
        if not self._on or self._safe is None or at is None or event.span == self._leaving:
            self._safe = event.end[2]
        elif self._is_too_low(at, event.end):
            self._report(event.span, min(event.end[2], at[2]))

    def _is_too_low(self, at: tuple[float, ...], end: tuple[float, ...]) -> bool:
        """Whether a rapid on the offset path is; one that goes straight up moves the safe height instead."""
        assert self._safe is not None
        if abs(end[0] - at[0]) > TINY or abs(end[1] - at[1]) > TINY:
            return min(end[2], at[2]) < self._safe - TINY
        if end[2] > at[2]:
            self._safe = min(self._safe, end[2])
        return False

    def _report(self, span: Span, height: float) -> None:
        assert self._safe is not None
        z, safe = (height - self._zero) / MM, (self._safe - self._zero) / MM
        self._found.append(
            Diagnostic(
                code="GS154",
                message=f"a rapid along the compensated path at Z{z:.3f} mm; the last safe height was Z{safe:.3f} mm",
                span=span,
                hint="retract before, or use G1 with a feed",
                value=z,
                limit=safe,
                unit="mm",
            )
        )

    def moves(self, batch: MoveBatch) -> None:
        import numpy as np

        fast = np.flatnonzero(batch.kind == 0)
        if self._on and len(fast):
            self._rapids(batch, fast.tolist())
        elif len(fast):
            self._safe = float(batch.end[fast[-1], 2])
        self._at = tuple(batch.end[-1].tolist())

    def _rapids(self, batch: MoveBatch, rows: list[int]) -> None:
        """Rapids of a batch while compensation is on."""
        for row in rows:
            at = self._at if row == 0 else tuple(batch.end[row - 1].tolist())
            end = tuple(batch.end[row].tolist())
            if self._safe is None or at is None:
                self._safe = end[2]
            elif self._is_too_low(at, end):
                self._report(batch.span(row), min(end[2], at[2]))

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        return self._found


class CompensationLeftOn(Watch):
    """GS155: the program ends in G41 or G42."""

    def __init__(self) -> None:
        self._since: tuple[str, Span] | None = None
        self._found: list[Diagnostic] = []

    def block(self, words: Words, control: Control) -> None:
        code = words.g.get(COMPENSATION)
        if code == _OFF:
            self._since = None
        elif code is not None:
            name = g_name(code)
            self._since = (name.upper(), word_span(words, name, control))

    def doubt(self, doubt: Doubt) -> None:
        if doubt.may_say("g40", "g41", "g42", "g41.1", "g42.1"):
            self._since = None

    def event(self, event: canon.Event) -> None:
        if isinstance(event, canon.End | canon.EndOfFile) and self._since is not None:
            name, since = self._since
            self._found.append(
                Diagnostic(
                    code="GS155",
                    message=f"the program ends with cutter compensation on ({name} in line {since.line})",
                    span=event.span,
                    hint="leave the contour, retract, and say G40 before the end",
                    related=since,
                )
            )

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        return self._found
