"""The findings of a verdict, each once: if many cases meet the same fault in one file, it is one fault."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from gcodesim.diagnostics import Caller, Diagnostic, Span
from gcodesim.files.digest import digest_of_texts
from gcodesim.formats.places import FilePlaces
from gcodesim.frozen import frozen
from gcodesim.regress.baseline import entry_of
from gcodesim.regress.verdicts import FindingState, JudgedFinding, SuiteVerdict

_WEIGHTS: Final[tuple[FindingState, ...]] = ("suppressed", "baseline", "accepted", "expected", "told", "counts")


@frozen
class Item:
    """A finding, its files named from the top of the repository; `cases` are those that have it.

    `state` and `reason` are those of the case in which it weighs most. `fingerprint` stays the same when lines move
    and numbers change: it is made from the file, the code, the words of the line and the message without numbers.
    """

    finding: Diagnostic
    state: FindingState
    reason: str
    cases: tuple[str, ...]
    fingerprint: str

    @property
    def is_open(self) -> bool:
        """Whether somebody has to look at it, because nobody has expected, accepted or suppressed it."""
        return self.state in ("counts", "told")


def items_of(verdict: SuiteVerdict, places: FilePlaces) -> list[Item]:
    """All findings of `verdict` in the order of their places."""
    met: dict[tuple[object, ...], tuple[JudgedFinding, list[str]]] = {}
    for case, found in [("", one) for one in verdict.found] + [(c.name, one) for c in verdict.cases for one in c.found]:
        finding = found.finding
        key = (finding.code, finding.level, finding.message, replace(finding.span, callers=()))
        known, cases = met.setdefault(key, (found, []))
        if case and case not in cases:
            cases.append(case)
        if _WEIGHTS.index(found.state) > _WEIGHTS.index(known.state):
            met[key] = (found, cases)
    entries: dict[tuple[str, ...], int] = {}
    items = []
    for found, cases in sorted(met.values(), key=lambda pair: pair[0].finding.order):
        file, *rest = entry_of(found.finding, places.line)
        entry = (places.shown(file), *rest)
        entries[entry] = entries.get(entry, 0) + 1
        items.append(
            Item(
                finding=_from_top(found.finding, places),
                state=found.state,
                reason=found.reason,
                cases=tuple(cases),
                fingerprint=digest_of_texts(*entry, str(entries[entry])),
            )
        )
    return items


def _from_top(finding: Diagnostic, places: FilePlaces) -> Diagnostic:
    def moved(span: Span) -> Span:
        callers = tuple(Caller(places.shown(c.file), c.line, c.name) for c in span.callers)
        return replace(span, file=places.shown(span.file), callers=callers)

    related = None if finding.related is None else moved(finding.related)
    return replace(finding, span=moved(finding.span), related=related)
