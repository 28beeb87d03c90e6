"""A spindle that the program starts without a speed, or never starts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.rs274.watch.watch import FEEDS, TINY, Watch
from gcodesim.rs274.words import Words

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.watch.doubt import Doubt

_SWITCHES = (canon.Output, canon.Action)  # by which other things than a spindle work


class SpindleWithoutSpeed(Watch):
    """GS176: the tool is fed after M3 or M4 without any S, or below part zero in a program that never says either.

    The second is a note, and told only where no cell says what the tool is, not of programs that switch something.
    Of a tool that no spindle turns, such as a torch or a gun, M3 may be the switch.
    """

    def __init__(self) -> None:
        self._has_cell = False
        self._unturned: frozenset[int] = frozenset()
        self._tool: int | None = None
        self._has_speed = False  # an S was written, were it S0
        self._started: canon.Spindle | None = None  # M3 or M4 without a speed
        self._ever = False
        self._switches = False
        self._zero = 0.0
        self._at: tuple[float, float, float] | None = None
        self._fell = False  # the tool was fed down below part zero
        self._stands: Span | None = None
        self._never: Span | None = None

    def block(self, words: Words, control: Control) -> None:
        self._has_cell = control.settings.has_cell
        self._unturned = control.settings.unturned
        if self._tool is None:
            self._tool = control.settings.loaded_tool
        self._has_speed = self._has_speed or "s" in words.values

    def event(self, event: canon.Event) -> None:
        if isinstance(event, canon.Move):
            self._move(event.end[:3], event.span, feeds=isinstance(event, FEEDS))
        elif isinstance(event, canon.Spindle):
            starts = event.direction != "off"
            self._ever = self._ever or starts
            self._started = event if starts and event.speed == 0.0 else None
        elif isinstance(event, canon.ToolChange | canon.ToolNumber):
            self._tool = event.tool
        elif isinstance(event, canon.WorkSystem):
            self._zero = event.offset[2] + event.g92[2]
        elif isinstance(event, _SWITCHES):
            self._switches = True

    def doubt(self, doubt: Doubt) -> None:
        self._at, self._fell = None, False
        self._has_speed = self._has_speed or "s" in doubt.letters
        self._ever = self._ever or doubt.spindle
        if doubt.spindle:
            self._started = None

    def somewhere(self, event: canon.Move) -> None:
        if isinstance(event, FEEDS):
            self._fed()

    def _move(self, end: tuple[float, float, float], span: Span, *, feeds: bool) -> None:
        at, self._at = self._at, end
        if not feeds or at is None:
            self._fell = self._fell and feeds
            return
        self._fed()
        if self._ever or self._never is not None:
            return
        sideways = abs(end[0] - at[0]) > TINY or abs(end[1] - at[1]) > TINY
        if self._fell and sideways:
            self._never = span
        self._fell = end[2] < self._zero - TINY and (self._fell or end[2] < at[2] - TINY)

    def _fed(self) -> None:
        if self._may_stand():
            assert self._started is not None
            self._stands = self._started.span

    def _may_stand(self) -> bool:
        """Whether a feed move of this tool would be the first with a spindle that has no speed."""
        waits = self._started is not None and not self._has_speed and self._stands is None
        return waits and self._tool not in self._unturned

    def moves(self, batch: MoveBatch) -> None:
        looks = self._may_stand()
        batch = self.singly_until(batch, lambda: not looks and (self._ever or self._never is not None))
        if len(batch):
            x, y, z = batch.end[-1, :3].tolist()
            self._at = (x, y, z)

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        if self._stands is not None:
            hint = "write S with M3 or M4, as in S8000 M3"
            yield Diagnostic(
                code="GS176", message="the spindle is started without S: it stands still", span=self._stands, hint=hint
            )
        if finished and self._never is not None and not self._ever and not self._switches and not self._has_cell:
            yield Diagnostic(
                code="GS176",
                severity=Severity.NOTE,
                message="the tool is fed below part zero, and the program never starts a spindle",
                span=self._never,
                hint="write S and M3 or M4 before",
            )
