"""Exit statuses, the same for every command and output format."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from gcodesim.diagnostics import Diagnostic, Severity

OK: Final = 0
FINDINGS: Final = 1
USAGE: Final = 2
INTERNAL: Final = 70
INTERRUPTED: Final = 130

FAIL_ON: Final = ("error", "warning", "note", "never")


class UsageError(Exception):
    """The command line asks for something that does not exist; ends with status 2."""


def status_of(findings: Iterable[Diagnostic], fail_on: str) -> int:
    """1 if a finding is at or above `fail_on`, else 0."""
    if fail_on == "never":
        return OK
    threshold = Severity[fail_on.upper()]
    return FINDINGS if any(f.level >= threshold for f in findings) else OK
