"""Output for people: findings and tables on stdout, notes about gcodesim itself on stderr."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, TextIO

from gcodesim.diagnostics import Diagnostic, Severity, SourceText
from gcodesim.diagnostics.plain import one_line, raw
from gcodesim.diagnostics.show import as_json, as_text
from gcodesim.numbers import clean

_COLOUR = {Severity.ERROR: "31;1", Severity.WARNING: "33;1", Severity.NOTE: "36"}


def wants_colour(stream: TextIO) -> bool:
    """Colour only on a terminal, and never when NO_COLOR is set."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def print_findings(findings: Iterable[Diagnostic], sources: Mapping[str, SourceText]) -> None:
    """All findings in order of their places, as text on stdout."""
    colour = wants_colour(sys.stdout)
    for finding in findings:
        text = as_text(finding, sources)
        if colour:
            word = finding.level.word
            text = text.replace(f" {word} ", f" \033[{_COLOUR[finding.level]}m{word}\033[0m ", 1)
        print(text, file=raw(sys.stdout) if colour else sys.stdout)


def print_verdict(name: str, findings: Sequence[Diagnostic], sources: Mapping[str, SourceText]) -> None:
    """The findings of one program or cell, and a line that counts them."""
    print_findings(findings, sources)
    print(f"{one_line(name)}: {verdict(findings)}")


def verdict(findings: Iterable[Diagnostic]) -> str:
    """`2 errors, no warnings, 1 note`."""
    levels = [finding.level for finding in findings]
    parts = []
    for severity in (Severity.ERROR, Severity.WARNING, Severity.NOTE):
        count = levels.count(severity)
        if count or severity is not Severity.NOTE:
            parts.append(f"{count or 'no'} {severity.word}{'' if count == 1 else 's'}")
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
