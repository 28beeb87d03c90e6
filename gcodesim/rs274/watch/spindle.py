"""The spindle: off in a cut, on after the end."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from gcodesim import canon
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.rs274.watch.watch import FEEDS, TINY, Watch
from gcodesim.units import MM, RPM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gcodesim.canon.batch import MoveBatch
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.watch.doubt import Doubt
    from gcodesim.rs274.words import Words


class _Low(NamedTuple):
    """A feed move that goes sideways or turns back at height `z` of the machine frame, `zero` above part zero."""

    z: float
    zero: float
    span: Span
    tool: int

    def is_below(self, level: float) -> bool:
        """Whether this is a cut where the highest other one is at `level`."""
        return self.z <= level + TINY or (level < self.zero - TINY and self.z < self.zero - TINY)


class FeedWithoutSpindle(Watch):
    """GS176: a cut with the spindle off, in a program that cuts with it on.

    A program alone does not say what is a cut. A move that feeds sideways, or
    down and up again, certainly is one if it is no higher than where the same program does
    so with the spindle on after having fed down from a rapid; and below part
    zero, when all those cuts lie below it. A program that never turns a
    spindle (extruder, plotter) has no such height, nor has one that only
    switches a laser. Tools of the cell that no spindle turns
    may be fed as low as they like.
    """

    def __init__(self) -> None:
        self._turning = False
        self._unturned: frozenset[int] = frozenset()
        self._turret = False
        self._sure = True  # whether it turns is known
        self._tool = 0
        self._zero = 0.0  # height of part zero in the machine frame
        self._at: tuple[float, float, float] | None = None
        self._rapid_z: float | None = None  # height at which the last rapid ended
        self._fall: Span | None = None  # the feed move that went straight down last
        self._level: float | None = None  # highest cut with the spindle on
        self._lows: list[list[_Low]] = [[]]  # for each stretch with the spindle off: ever lower moves

    def block(self, words: Words, control: Control) -> None:
        self._unturned = control.settings.unturned
        self._turret = control.dialect.turret

    def event(self, event: canon.Event) -> None:
        kind = type(event)
        if isinstance(event, canon.Move):
            end = event.end[:3]
            if kind is canon.Rapid:
                self._turn_up(end[2])
                self._rapid_z = end[2]
            elif isinstance(event, FEEDS) and getattr(event, "pitch", None) is None:
                self._feed(end, event.span, circle=kind is not canon.LinearFeed)
            self._at = end
        elif isinstance(event, canon.Spindle):
            turning = event.direction != "off" and event.speed > 0.0
            self._sure = True
            if turning != self._turning:
                self._fall = None
                if not turning:
                    self._lows.append([])
            self._turning = turning
        elif isinstance(event, canon.ToolChange | canon.ToolNumber):
            self._tool = event.tool
            self._fall = None
        elif isinstance(event, canon.WorkSystem):
            self._zero = event.offset[2] + event.g92[2]

    def doubt(self, doubt: Doubt) -> None:
        self._at = self._rapid_z = self._fall = None
        if doubt.spindle or doubt.may_say("m6"):
            self._sure = False
            self._lows.append([])

    def _feed(self, end: tuple[float, float, float], span: Span, *, circle: bool) -> None:
        at = self._at
        if at is None:
            return
        fall = self._fall
        self._turn_up(end[2])
        falls, rises = end[2] < at[2] - TINY, end[2] > at[2] + TINY
        sideways = circle or abs(end[0] - at[0]) > TINY or abs(end[1] - at[1]) > TINY
        if sideways and not rises:
            self._cut(end[2], fall or span)  # the tool has gone down with the spindle off, if it has
        self._fall = span if falls and not sideways else None

    def _turn_up(self, z: float) -> None:
        """A straight fall that is followed by a rise was a hole."""
        if self._fall is not None and self._at is not None and z > self._at[2] + TINY:
            self._cut(self._at[2], self._fall)
        self._fall = None

    def _cut(self, z: float, span: Span) -> None:
        if not self._sure:
            return
        if self._turning:
            fed_down = self._rapid_z is not None and z < self._rapid_z - TINY
            if fed_down and (self._level is None or z > self._level):
                self._level = z
            return
        if self._tool in self._unturned:
            return
        lows = self._lows[-1]
        if not lows or z < lows[-1].z - TINY:
            lows.append(_Low(z, self._zero, span, self._tool))

    def moves(self, batch: MoveBatch) -> None:
        batch = self.singly_until(batch, lambda: self._at is not None and self._fall is None)
        if len(batch):
            self._columns(batch)

    def _columns(self, batch: MoveBatch) -> None:
        """Handle `event` while no fall waits for the next move."""
        import numpy as np

        rapid = batch.kind == 0
        if not (self._turning and self._is_nothing_new(batch, rapid)):
            xyz = batch.end[:, :3]
            from_ = np.concatenate([np.array([self._at]), xyz[:-1]])
            away = np.abs(xyz[:, :2] - from_[:, :2]) > TINY
            sideways = away[:, 0] | away[:, 1] | (batch.kind > 1)
            rises = xyz[:, 2] > from_[:, 2] + TINY
            falls = ~rapid & ~sideways & (xyz[:, 2] < from_[:, 2] - TINY)
            bottoms = np.zeros(len(batch), dtype=bool)
            bottoms[:-1] = falls[:-1] & rises[1:]
            cuts = np.flatnonzero((~rapid & sideways & ~rises) | bottoms)
            if not self._sure:
                pass
            elif self._turning:
                self._raise_level(xyz[:, 2], cuts, np.flatnonzero(rapid))
            else:
                self._lower(batch, cuts, falls)
        before = self._at if len(batch) == 1 else batch.end[-2, :3].tolist()
        assert before is not None
        x, y, z = batch.end[-1, :3].tolist()
        straight_down = abs(x - before[0]) <= TINY and abs(y - before[1]) <= TINY and z < before[2] - TINY
        self._fall = batch.span(len(batch) - 1) if straight_down and batch.kind[-1] == 1 else None
        self._at = (x, y, z)
        if rapid.any():
            self._rapid_z = float(batch.end[len(rapid) - 1 - int(rapid[::-1].argmax()), 2])

    def _is_nothing_new(self, batch: MoveBatch, rapid: NDArray[np.bool_]) -> bool:
        """Whether no feed move ends above the level, so that none can raise it."""
        if self._level is None:
            return False
        z = batch.end[:, 2] if not rapid.any() else batch.end[~rapid, 2]
        return len(z) == 0 or float(z.max()) <= self._level

    def _raise_level(self, z: NDArray[np.float64], cuts: NDArray[np.int64], fast: NDArray[np.int64]) -> None:
        """The highest of the cuts that lie below the rapid before them."""
        import numpy as np

        heights = np.concatenate([[-np.inf if self._rapid_z is None else self._rapid_z], z[fast]])
        deep = z[cuts][z[cuts] < heights[np.searchsorted(fast, cuts)] - TINY]
        if len(deep):
            highest = float(deep.max())
            self._level = highest if self._level is None else max(highest, self._level)

    def _lower(self, batch: MoveBatch, cuts: NDArray[np.int64], falls: NDArray[np.bool_]) -> None:
        """The cuts that go lower than any before."""
        import numpy as np

        lows = self._lows[-1]
        z = batch.end[cuts, 2]
        before = np.minimum.accumulate(np.concatenate([[lows[-1].z if lows else np.inf], z]))[:-1]
        for row in cuts[z < before].tolist():
            fallen = row > 0 and falls[row - 1] and not falls[row]
            self._cut(float(batch.end[row, 2]), batch.span(row - 1 if fallen else row))

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        if self._level is None:
            return
        for lows in self._lows:
            low = next((low for low in lows if low.is_below(self._level)), None)
            if low is None:
                continue
            z, level = (low.z - low.zero) / MM, (self._level - low.zero) / MM
            who = f"T{low.tool}" if low.tool else "the tool"
            yield Diagnostic(
                code="GS176",
                message=f"{who} is fed at Z{z:.3f} mm with the spindle off; "
                f"elsewhere the program cuts at Z{level:.3f} mm with it turning",
                span=low.span,
                hint="say S and M3 or M4 before" + ("" if self._turret else "; M6 stops the spindle"),
                value=z,
                limit=level,
                unit="mm",
            )


class SpindleLeftOn(Watch):
    """GS177: the closing %, or with some controls the end of the file, ends the program, but stops nothing."""

    def __init__(self) -> None:
        self._speed = 0.0
        self._word = ""
        self._started: Span | None = None
        self._found: list[Diagnostic] = []

    def event(self, event: canon.Event) -> None:
        if isinstance(event, canon.Spindle):
            self._speed = 0.0 if event.direction == "off" else event.speed
            self._word = "M3" if event.direction == "cw" else "M4"
            self._started = event.span
        elif isinstance(event, canon.EndOfFile) and self._speed > 0.0:
            self._found.append(
                Diagnostic(
                    code="GS177",
                    message=f"the program ends while the spindle turns ({self._word}, "
                    f"{self._speed / RPM:.0f} rpm): only M2 and M30 stop it",
                    span=event.span,
                    hint="say M5 or M2 at the end",
                    related=self._started,
                    value=self._speed / RPM,
                    limit=0.0,
                    unit="rpm",
                )
            )

    def doubt(self, doubt: Doubt) -> None:
        if doubt.spindle:
            self._speed = 0.0

    def findings(self, *, finished: bool) -> Iterable[Diagnostic]:
        return self._found
