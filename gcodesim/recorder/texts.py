"""Messages of a program (MSG, DEBUG, PRINT, LOG) and contacts of its probes, as events of the log at their times."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from gcodesim.canon import Log, Message, Print, Trip
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.log import LogWriter
    from gcodesim.motion.trajectory import TimedEvent

_CODES: Final = {Message: "message", Print: "print", Log: "log", Trip: "probe"}


class Texts:
    """Texts on their way into a log."""

    def __init__(self, writer: LogWriter, events: Iterable[TimedEvent]) -> None:
        self._writer = writer
        self._waiting: deque[TimedEvent] = deque()
        self.expect(events)

    def expect(self, events: Iterable[TimedEvent]) -> None:
        """Texts of a further leg wait as well."""
        self._waiting.extend(timed for timed in events if type(timed.event) in _CODES)

    def until(self, end_ns: int) -> None:
        """Write the texts that wait for a time up to `end_ns`."""
        while self._waiting and (t_ns := round(self._waiting[0].time * 1e9)) <= end_ns:
            event = self._waiting.popleft().event
            assert isinstance(event, Message | Print | Log | Trip)
            text = _told(event) if isinstance(event, Trip) else event.text
            bodies = (event.body,) if isinstance(event, Trip) and event.body else ()
            code, span = _CODES[type(event)], event.span
            self._writer.event(t_ns, code, text, file=span.file, line=span.line, bodies=bodies)


def _told(trip: Trip) -> str:
    where = " ".join(f"{letter}{value / MM + 0.0:.3f}" for letter, value in zip("XYZ", trip.tip, strict=True))
    what = f"tripped on {trip.body}" if trip.body else "tripped" if trip.tripped else "did not trip"
    return f"{trip.word} {what}, tip at {where} of the world"
