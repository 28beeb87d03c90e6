"""GitLab's code quality report: a list of issues, compared by fingerprint between two branches."""

from __future__ import annotations

import json
from typing import Any, Final

from gcodesim.diagnostics import Severity
from gcodesim.diagnostics.plain import one_line
from gcodesim.formats.items import Item, items_of
from gcodesim.formats.places import FilePlaces
from gcodesim.regress.verdicts import SuiteVerdict

_SEVERITIES: Final = {Severity.ERROR: "critical", Severity.WARNING: "minor", Severity.NOTE: "info"}


def text_of(verdict: SuiteVerdict, places: FilePlaces) -> str:
    """A JSON list; findings that are expected, accepted, suppressed or in the baseline are not issues."""
    issues = [_issue(item) for item in items_of(verdict, places) if item.is_open]
    return json.dumps(issues, ensure_ascii=False, indent=1) + "\n"


def _issue(item: Item) -> dict[str, Any]:
    finding, span = item.finding, item.finding.span
    begin = max(span.line, 1)  # a finding about a whole file is at its first line
    return {
        "description": one_line(f"{finding.message} ({finding.hint})" if finding.hint else finding.message),
        "check_name": finding.code,
        "fingerprint": item.fingerprint,
        "severity": _severity(item),
        "location": {"path": span.file, "lines": {"begin": begin, "end": max(span.end_line, begin)}},
    }


def _severity(item: Item) -> str:
    """What fails the job ranks above what does not."""
    level = item.finding.level
    return "major" if item.state == "counts" and level < Severity.ERROR else _SEVERITIES[level]
