"""Filament of a printer that goes backwards where a bead should be laid."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.watch.watch import Watch
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.canon.batch import MoveBatch

LONGEST_WIPE: Final = 25.0 * MM
"""Filament that is drawn back on the way: a wipe retracts as much as a Bowden tube needs, and no more."""

LONGEST_UNLOADING: Final = 1500.0 * MM
"""Filament that is drawn back while the head stands: the longest tubes of changers are a metre long."""

SHARE: Final = 0.25
"""Of the moves with filament: slicers wipe now and then, never on every fourth move."""

FEWEST: Final = 20
"""Moves from which on a share says something."""


class FallingFilament(Watch):
    """GS178: E falls while the head moves, farther than a wipe, or on too many moves.

    Either E begins anew and no G92 says so, or its words are steps and no M83 says so. Retraction alone, and unloading
    of filament, are moves of E by itself; none is longer than tubes are.
    """

    def __init__(self) -> None:
        self._pushed = self._fallen = 0
        self._run = 0.0  # drawn back on the way since material was laid last [m]
        self._deepest = 0.0
        self._unloaded = 0.0  # the most at once [m]
        self._unloads: Span | None = None
        self._first: Span | None = None
        self._place: Span | None = None  # of the deepest

    def event(self, event: canon.Event) -> None:
        if isinstance(event, canon.LinearFeed | canon.ArcFeed):
            self._take(event.extrude, event.span)
        elif isinstance(event, canon.Extrude) and -event.length > max(self._unloaded, LONGEST_UNLOADING):
            self._unloaded, self._unloads = -event.length, event.span

    def moves(self, batch: MoveBatch) -> None:
        if batch.extrude is None:
            return
        pushed = int((batch.extrude > 0.0).sum())
        falls = (batch.extrude < 0.0).nonzero()[0].tolist()
        if not falls:
            self._pushed += pushed
            self._run = 0.0 if pushed else self._run
            return
        for row in ((batch.extrude != 0.0).nonzero()[0]).tolist():
            step = float(batch.extrude[row])
            self._take(step, batch.span(row) if step < 0.0 else None)

    def _take(self, step: float, span: Span | None) -> None:
        if step > 0.0:
            self._pushed += 1
            self._run = 0.0
        elif step < 0.0:
            self._fallen += 1
            self._run -= step
            self._first = self._first or span
            if self._run > max(self._deepest, LONGEST_WIPE):
                self._deepest, self._place = self._run, span

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        moves = self._pushed + self._fallen
        if self._first is not None and self._fallen > SHARE * moves and moves >= FEWEST:
            yield Diagnostic(
                code="GS178",
                message=f"E falls on {self._fallen} of {moves} moves with filament, which is drawn back there",
                span=self._first,
                hint="say M83 if E words are steps, or `startup: M83` in the cell if a start macro of the printer "
                "does; M82 and G92 E0 if they count from a place",
                value=float(self._fallen),
                limit=SHARE * moves,
            )
        elif self._place is not None:
            words = f"by {self._deepest / MM:.1f} mm on the way: so much is drawn back out of the nozzle"
            hint = "say G92 E0 where E begins anew, or M83 if its words are steps"
            yield _drawn_back(words, hint, self._place, self._deepest, LONGEST_WIPE)
        elif self._unloads is not None:
            words = f"by {self._unloaded / MM:.0f} mm at once: so much is drawn back out of the machine"
            hint = "say G92 E0 where E begins anew, or M83 if E words are steps; G91 is not about E in all firmware"
            yield _drawn_back(words, hint, self._unloads, self._unloaded, LONGEST_UNLOADING)


def _drawn_back(words: str, hint: str, span: Span, length: float, limit: float) -> Diagnostic:
    """GS178 of filament that is drawn back by a length [m], more than a limit [m]."""
    return Diagnostic(
        code="GS178",
        message=f"E falls {words}",
        span=span,
        hint=hint,
        value=length / MM,
        limit=limit / MM,
        unit="mm",
    )
