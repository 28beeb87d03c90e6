"""Findings as they are kept between two runs: everything that they say, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gcodesim.diagnostics.finding import Caller, Diagnostic, Severity, Span
from gcodesim.diagnostics.show import as_json


def as_stored(finding: Diagnostic) -> dict[str, Any]:
    """A finding as in `results.json`, with what that leaves out."""
    span = finding.related
    related = None if span is None else [span.file, span.line, span.column, span.end_line, span.end_column]
    return {**as_json(finding), "related": related, "bodies": list(finding.bodies)}


def from_stored(value: Mapping[str, Any]) -> Diagnostic:
    """The finding that `as_stored` gave; KeyError, TypeError or ValueError for anything else."""
    callers = tuple(Caller(c["file"], c["line"], c["name"]) for c in value["callers"])
    place = (value["file"], value["line"], value["column"], value["end_line"], value["end_column"])
    return Diagnostic(
        code=value["code"],
        message=value["message"],
        span=Span(*place, callers),
        severity=Severity[value["severity"].upper()],
        hint=value["hint"],
        related=None if value["related"] is None else Span(*value["related"]),
        count=value["count"],
        time=value["time_s"],
        value=value["value"],
        limit=value["limit"],
        unit=value["unit"],
        bodies=tuple(value["bodies"]),
    )
