"""Findings as people and as programs read them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final, Literal

from gcodesim.diagnostics.finding import Diagnostic, Severity, Span
from gcodesim.diagnostics.plain import excerpt_of, one_line
from gcodesim.diagnostics.text import SourceText

_LONGEST_EXCERPT = 120

Role = Literal["path", "place", "error", "warning", "note", "frame", "label"]
"""What a piece of a finding's text is; the words of severities also stand for its code and caret."""

Paint = Callable[[Role, str], str]


def unpainted(role: Role, text: str) -> str:
    """Text without colour."""
    return text


def role_of(severity: Severity) -> Role:
    """The role of a severity's word, and of what has its colour."""
    return _SEVERITIES[severity]


_SEVERITIES: Final[Mapping[Severity, Role]] = {
    Severity.ERROR: "error",
    Severity.WARNING: "warning",
    Severity.NOTE: "note",
}


def place(span: Span, paint: Paint = unpainted) -> str:
    """`file:line:column`, or the file alone when the finding is about all of it."""
    file = paint("path", one_line(span.file))
    return f"{file}{paint('place', f':{span.line}:{span.column}')}" if span.line else file


def excerpt(span: Span, text: str, paint: Paint = unpainted, level: Role = "error") -> list[str]:
    """The faulty line and a caret line below it; long lines are cut around the place."""
    if not text.strip():
        return []
    first = max(span.column - 1, 0)
    last = span.end_column - 1 if span.end_line == span.line and span.end_column > span.column else first + 1
    shown = excerpt_of(text)
    cut = max(0, first - _LONGEST_EXCERPT // 2) if len(shown) > _LONGEST_EXCERPT else 0
    window = shown[cut : cut + _LONGEST_EXCERPT]
    lead = "".join("\t" if c == "\t" else " " for c in window[: first - cut])
    width = max(1, min(last, cut + _LONGEST_EXCERPT, len(text)) - first)
    number = str(span.line)
    before, after = ("…" if cut else ""), ("…" if cut + _LONGEST_EXCERPT < len(shown) else "")
    return [
        f"  {paint('frame', number + ' |')} {before}{window}{after}",
        f"  {paint('frame', ' ' * len(number) + ' |')} {' ' * len(before)}{lead}{paint(level, '^' * width)}",
    ]


def as_text(finding: Diagnostic, sources: Mapping[str, SourceText], paint: Paint = unpainted) -> str:
    """A finding for people: headline, excerpt with caret, callers, hint. `paint` colours its pieces."""
    level = role_of(finding.level)
    remarks = [f"{finding.count} times"] if finding.count > 1 else []
    if finding.time is not None:
        remarks.append(f"{'first ' if finding.count > 1 else ''}at {finding.time:.3f} s")
    remark = f" ({', '.join(remarks)})" if remarks else ""
    kind = paint(level, f"{finding.level.word} {finding.code}")
    lines = [f"{place(finding.span, paint)}: {kind}: {one_line(finding.message)}{remark}"]
    source = sources.get(finding.span.file)
    if source is not None and finding.span.line:
        lines += excerpt(finding.span, source.line(finding.span.line), paint, level)
    for caller in reversed(finding.span.callers):
        at = f"{one_line(caller.file)}:{caller.line} ({one_line(caller.name)})"
        lines.append(f"  {paint('label', 'called from')} {at}")
    if finding.related is not None:
        lines.append(f"  {paint('label', 'see')} {place(finding.related, paint)}")
    if finding.hint:
        lines.append(f"  {paint('label', 'hint:')} {one_line(finding.hint)}")
    return "\n".join(lines)


def as_json(finding: Diagnostic) -> dict[str, Any]:
    """A finding in the form of `results.json`."""
    span = finding.span
    return {
        "code": finding.code,
        "severity": finding.level.word,
        "message": finding.message,
        "hint": finding.hint,
        "file": span.file,
        "line": span.line,
        "column": span.column,
        "end_line": span.end_line or span.line,
        "end_column": span.end_column,
        "callers": [{"file": c.file, "line": c.line, "name": c.name} for c in span.callers],
        "count": finding.count,
        "time_s": finding.time,
        "value": finding.value,
        "limit": finding.limit,
        "unit": finding.unit,
    }
