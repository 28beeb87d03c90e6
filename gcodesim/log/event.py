"""An event as the log tells of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
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
        return self.code.startswith("GS")
