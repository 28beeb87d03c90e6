"""Which findings a user sees, and how severe they are in this cell, by `checks` and `suppress`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from datetime import date
from typing import Final

from gcodesim.cell import Cell
from gcodesim.cell.settings import Suppression, matches
from gcodesim.diagnostics import Diagnostic, SourceText

REFUSALS: Final = ("GS750", "GS751")
"""A run with these is refused before it begins: nobody may overlook that."""


def final_findings(
    findings: Iterable[Diagnostic], cell: Cell | None, program: SourceText, today: date | None = None
) -> list[Diagnostic]:
    """All findings in order, with the severities of the cell, without those that it suppresses.

    A suppression whose day is past (`until` before `today`) no longer counts, and the finding's hint says so;
    without `today` it is the system's date. No date enters the result.
    """
    if cell is None:
        return list(findings)
    shown = []
    for finding in findings:
        if any(_suppresses(entry, finding, program, today) for entry in cell.suppress):
            continue
        severity = None if finding.code in REFUSALS else cell.severity(finding.code)
        finding = finding if severity is None else replace(finding, severity=severity)
        ended = [i for i, entry in enumerate(cell.suppress) if _fits(entry, finding, program)]
        shown.append(replace(finding, hint=_ended(cell, ended[0], finding.hint)) if ended else finding)
    return shown


def _ended(cell: Cell, index: int, hint: str) -> str:
    """The hint of a finding whose suppression has ended; it names no day, so that none enters a file."""
    span = cell.span("suppress", index)
    told = f"its suppression in {span.file}:{span.line} has ended ({cell.suppress[index].reason})"
    return f"{hint}; {told}" if hint else told


def suppressed_findings(
    findings: Iterable[Diagnostic], cell: Cell | None, program: SourceText, today: date | None = None
) -> list[tuple[Diagnostic, Suppression]]:
    """The findings that `final_findings` leaves out, each with the entry that says why."""
    if cell is None:
        return []
    pairs = ((finding, entry) for finding in findings for entry in cell.suppress)
    found: dict[int, tuple[Diagnostic, Suppression]] = {}
    for finding, entry in pairs:
        if _suppresses(entry, finding, program, today):
            found.setdefault(id(finding), (finding, entry))
    return list(found.values())


def idle_suppressions(
    findings: Iterable[Diagnostic], cell: Cell, program: SourceText, *, ran: bool
) -> Iterator[Diagnostic]:
    """GS733: entries of `suppress` for this program to which no finding belongs.

    Entries past their day are looked at like others, so that no date decides; without a run (`ran` False) those for
    codes that only a run can give are passed over.
    """
    everything = list(findings)
    for index, entry in enumerate(cell.suppress):
        if entry.program not in (None, program.name) or (not ran and _needs_run(entry.code)):
            continue
        if not any(_fits(entry, finding, program) for finding in everything):
            yield Diagnostic(
                code="GS733",
                span=cell.span("suppress", index),
                message=f"nothing is suppressed here: {program.name} gives no such finding {entry.code}",
                hint="remove the entry, or correct its code and place",
            )


def _needs_run(pattern: str) -> bool:
    return any(pattern.startswith(head) for head in ("GS23", "GS4", "GS5"))


def _suppresses(entry: Suppression, finding: Diagnostic, program: SourceText, today: date | None) -> bool:
    if entry.until is not None and (today or date.today()) > entry.until:
        return False
    return _fits(entry, finding, program)


def _fits(entry: Suppression, finding: Diagnostic, program: SourceText) -> bool:
    """Whether the entry is about this finding, on whatever day."""
    if finding.code in REFUSALS:
        return False
    if not matches(entry.code, finding.code) or (entry.program is not None and entry.program != finding.span.file):
        return False
    if entry.line is not None and entry.line != finding.span.line:
        return False
    text = program.line(finding.span.line) if finding.span.file == program.name else ""
    if entry.block is not None and _words(entry.block) != _words(text):
        return False
    if entry.n is None:
        return True
    number = f"N{entry.n}"
    return _words(text).startswith(number) and not _words(text)[len(number) :][:1].isdigit()


def _words(text: str) -> str:
    return "".join(text.split()).upper()
