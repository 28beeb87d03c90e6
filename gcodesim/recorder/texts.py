"""What a program says by MSG, DEBUG, PRINT and LOG, as events of the log, each at its time."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from gcodesim.canon import Log, Message, Print

if TYPE_CHECKING:
    from gcodesim.log import LogWriter
    from gcodesim.motion.trajectory import TimedEvent

_CODES: Final = {Message: "message", Print: "print", Log: "log"}


class Texts:
    """Texts on their way into a log."""

    def __init__(self, writer: LogWriter, events: Iterable[TimedEvent]) -> None:
        self._writer = writer
        self._waiting = deque(timed for timed in events if type(timed.event) in _CODES)

    def until(self, end_ns: int) -> None:
        """Say what waits for a time up to `end_ns`."""
        while self._waiting and (t_ns := round(self._waiting[0].time * 1e9)) <= end_ns:
            event = self._waiting.popleft().event
            assert isinstance(event, Message | Print | Log)
            self._writer.event(t_ns, _CODES[type(event)], event.text, file=event.span.file, line=event.span.line)
