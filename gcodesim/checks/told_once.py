"""One fault, one finding: where an arm cannot but hit something, the hit itself says so."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Final

from gcodesim.diagnostics import Diagnostic

_NO_WAY: Final = "GS216"
_HITS: Final = ("GS301", "GS302", "GS303", "GS304", "GS305", "GS306", "GS307")


def told_once(planned: Iterable[Diagnostic], checked: Iterable[Diagnostic]) -> Iterator[Diagnostic]:
    """The findings of a plan and of its checks.

    That every way ends in a collision becomes the hint of the first collision, which is as severe then; it stands by
    itself where no check finds one.
    """
    blocked = None
    for finding in planned:
        if finding.code == _NO_WAY and finding.bodies and blocked is None:
            blocked = finding
        else:
            yield finding
    for finding in checked:
        if blocked is not None and finding.code in _HITS:
            hint = f"{blocked.message}; {blocked.hint}"
            elsewhere = None if blocked.span == finding.span else blocked.span
            yield replace(finding, hint=hint, related=elsewhere, severity=blocked.level)
            blocked = None
        else:
            yield finding
    if blocked is not None:
        yield blocked
