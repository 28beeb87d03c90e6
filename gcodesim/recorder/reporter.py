"""Writes findings as events of the log, each at its time and each once."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from gcodesim.declarations.units import UNITS
from gcodesim.diagnostics import Diagnostic
from gcodesim.diagnostics.catalogue import code_of
from gcodesim.log.event import BEGINS

if TYPE_CHECKING:
    from gcodesim.log import LogWriter

_UNITS: Final = {unit.name: unit for unit in reversed(UNITS)}


def _si(value: float, name: str) -> float:
    """The value in SI; unchanged if the unit is in no table."""
    unit = _UNITS.get(name)
    return value if unit is None else value * unit.factor + unit.offset


class Reporter:
    """Findings on their way into a log.

    What planning finds is known before the run, with the time at which it
    will happen. It waits for that time, so that a run that ends early does not
    report what never happened. What comes up in the run is written twice: when it
    begins, and at the end of the run with its final numbers, as in the results.
    """

    def __init__(self, writer: LogWriter, known: Sequence[Diagnostic]) -> None:
        self._writer = writer
        self._waiting = deque(sorted(known, key=_time_ns))
        self._said: dict[tuple[str, str, int], list[str]] = {}

    def expect(self, found: Sequence[Diagnostic], now_ns: int) -> None:
        """Findings of a further leg's plan wait as well; those whose time has passed are written now."""
        later = (replace(finding, time=max(_time_ns(finding), now_ns) * 1e-9) for finding in found)
        self._waiting = deque(sorted([*self._waiting, *later], key=_time_ns))

    def until(self, end_ns: int, fresh: Sequence[Diagnostic] = (), *, begin_ns: int = 0) -> None:
        """Write findings that wait for a time up to `end_ns`, and those that came up between `begin_ns` and then."""
        while self._waiting and _time_ns(self._waiting[0]) <= end_ns:
            finding = self._waiting.popleft()
            self._say(_time_ns(finding), finding)
        for finding in fresh:
            # a finding has the time at which its block begins, which may be long ago
            t_ns = min(max(_time_ns(finding), begin_ns), end_ns)
            title = code_of(finding.code).title
            self._say(t_ns, replace(finding, message=f"{title}: {BEGINS}", value=None))

    def rest(self, end_ns: int, findings: Sequence[Diagnostic]) -> None:
        """At the end, write the findings that have changed or were not written; those of later blocks are left out."""
        for finding in findings:
            said = self._said.get(_place(finding), ())
            if _time_ns(finding) <= end_ns and _words(finding) not in said:
                self._say(end_ns, finding)

    def _say(self, t_ns: int, finding: Diagnostic) -> None:
        span = finding.span
        self._said.setdefault(_place(finding), []).append(_words(finding))
        self._writer.event(
            t_ns,
            finding.code,
            finding.message,
            severity=finding.level.word,
            file=span.file,
            line=span.line,
            bodies=finding.bodies,
            value=_si(finding.value or 0.0, finding.unit or ""),
        )


def _place(finding: Diagnostic) -> tuple[str, str, int]:
    return finding.code, finding.span.file, finding.span.line


def _words(finding: Diagnostic) -> str:
    return f"{finding.level.word} {finding.message}"


def _time_ns(finding: Diagnostic) -> int:
    return max(0, round((finding.time or 0.0) * 1e9))
