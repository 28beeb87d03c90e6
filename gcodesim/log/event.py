"""An event of the log."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Final

from gcodesim.diagnostics import is_code
from gcodesim.frozen import frozen

BEGINS: Final = "begins here; what it comes to is told at the end of the run"
"""The end of the message of an event that tells only the beginning of a finding."""


@frozen
class LogEvent:
    """A message of `/event`: a finding, a tool change, a text of the program, the start, the end."""

    t_ns: int
    code: str
    severity: str
    file: str
    line: int
    message: str
    value: float

    @staticmethod
    def of(t_ns: int, message: Any) -> LogEvent:
        """The event of a decoded message of the topic."""
        return LogEvent(
            t_ns=t_ns,
            code=message.code,
            severity=message.severity,
            file=message.file,
            line=message.line,
            message=message.message,
            value=message.value,
        )

    @property
    def is_finding(self) -> bool:
        return is_code(self.code)

    @property
    def is_beginning(self) -> bool:
        """Whether a later event has the final numbers of this finding."""
        return self.is_finding and self.message.endswith(BEGINS)


def settled(events: Iterable[LogEvent]) -> tuple[LogEvent, ...]:
    """`events` with each finding once: at the time when it begins, with its final numbers if they are there."""
    found: list[LogEvent] = []
    begun: dict[tuple[str, str, int], int] = {}
    for event in events:
        place = (event.code, event.file, event.line)
        if event.is_beginning:
            begun[place] = len(found)
        elif place in begun:
            at = begun.pop(place)
            found[at] = replace(event, t_ns=found[at].t_ns)
            continue
        found.append(event)
    return tuple(found)
