"""Output for people: findings and tables on stdout, notes about gcodesim itself on stderr."""

from __future__ import annotations

import json
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, TextIO

from gcodesim.cli.colour import paint_for, painted
from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.diagnostics.plain import one_line
from gcodesim.diagnostics.show import Paint, as_json, as_text, role_of, unpainted
from gcodesim.numbers import clean


def print_findings(
    findings: Iterable[Diagnostic], sources: Mapping[str, SourceText], stream: TextIO | None = None
) -> None:
    """All findings in order of their places, as text on stdout, or on `stream`."""
    stream = stream or sys.stdout
    for finding in findings:
        print(as_text(finding, sources, paint_for(stream)), file=painted(stream))


def print_verdict(name: str, findings: Sequence[Diagnostic], sources: Mapping[str, SourceText]) -> None:
    """The findings of one program or cell, and a line that counts them."""
    print_findings(findings, sources)
    print_count(name, findings)


def print_count(name: str, findings: Iterable[Diagnostic], remark: str = "") -> None:
    """`part.nc: 2 errors, no warnings, 1 note`; a `remark` stands before the numbers."""
    paint = paint_for(sys.stdout)
    print(f"{paint('path', one_line(name))}: {remark}{verdict(findings, paint)}", file=painted(sys.stdout))


def verdict(findings: Iterable[Diagnostic], paint: Paint = unpainted) -> str:
    """`2 errors, no warnings, 1 note`; only what there is gets a colour."""
    levels = [finding.level for finding in findings]
    parts = []
    for severity in (Severity.ERROR, Severity.WARNING, Severity.NOTE):
        count = levels.count(severity)
        if count or severity is not Severity.NOTE:
            text = f"{count or 'no'} {severity.word}{'' if count == 1 else 's'}"
            parts.append(paint(role_of(severity), text) if count else text)
    return ", ".join(parts)


def print_json(value: Any) -> None:
    """One JSON value on stdout: no NaN, keys in our order, UTF-8."""
    print(json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(", ", ": ")))


def findings_as_json(findings: Iterable[Diagnostic]) -> list[dict[str, Any]]:
    """Findings as they stand in `results.json`."""
    return [clean(as_json(finding)) for finding in findings]


def print_table(
    rows: Sequence[Sequence[str]], *, indent: str = "  ", names: int = 1, texts: Collection[int] = ()
) -> None:
    """Columns aligned: the first ones, of `names`, and those of `texts` to the left, those of numbers to the right."""
    if not rows:
        return
    rows = [[one_line(cell) for cell in row] for row in rows]
    widths = [max(len(row[i]) for row in rows if i < len(row)) for i in range(max(len(row) for row in rows))]
    for row in rows:
        cells = [
            cell.ljust(widths[i]) if i < names or i in texts else cell.rjust(widths[i]) for i, cell in enumerate(row)
        ]
        print((indent + "  ".join(cells)).rstrip())


def note(text: str) -> None:
    """A line about gcodesim itself, on stderr."""
    print(text, file=sys.stderr)
