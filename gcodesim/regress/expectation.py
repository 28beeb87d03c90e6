"""Expectations in comments of a program, as in compiler test suites.

G1 X30 Y                    (expect: GS012)
G0 X50 ; expect: error GS401 "rapid move"
(expect@+1: GS501, GS402)   the finding is one line below; @-2 two above, @14 in line 14, @* anywhere
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from gcodesim.cell.settings import code_pattern
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.regress.case_file import ExpectedFinding

_COMMENT = re.compile(r"(?:\(\s*(?P<round>[^()]*)\)?|;\s*(?P<rest>.*))")
_EXPECT = re.compile(r"expect\s*(?P<place>@\s*(?:[+-]?[0-9]+|\*)?)?\s*:(?P<body>.*)", re.IGNORECASE)
_ALMOST = re.compile(r"expect\b[^:]*\b(?:GS|[A-Z][A-Z0-9]{2,15}-)[0-9]", re.IGNORECASE)
_ITEM = re.compile(
    r'\s*(?:(?P<severity>error|warning|note)\s+)?(?P<code>(?:GS|[A-Z][A-Z0-9]{2,15}-)[0-9][0-9x]{2})(?:\s+"(?P<message>[^"]*)")?'
    r"(?:\s+x(?P<count>[0-9]+))?\s*(?:,|$)",
    re.IGNORECASE,
)


@frozen
class Wanted:
    """An expectation and its place; `home` is the file whose lines it counts if it names none."""

    finding: ExpectedFinding
    span: Span
    home: str


def expectations(source: SourceText) -> tuple[list[Wanted], list[Diagnostic]]:
    """What the comments of a program expect, and those that cannot be read."""
    wanted: list[Wanted] = []
    faults: list[Diagnostic] = []
    for number, text in enumerate(source.lines, 1):
        if "expect" in text.lower():
            for match in _comments(text):
                span = Span(source.name, number, match.start() + 1, number, match.end() + 1)
                found = _read(match, span)
                if isinstance(found, Diagnostic):
                    faults.append(found)
                else:
                    wanted += [Wanted(finding=finding, span=span, home=source.name) for finding in found]
    return wanted, faults


def _comments(text: str) -> Iterator[re.Match[str]]:
    """Comments of a line that begin with `expect`; one in brackets inside another does not count."""
    at = 0
    while match := _COMMENT.search(text, at):
        yield match
        at = match.end()


def _read(match: re.Match[str], span: Span) -> list[ExpectedFinding] | Diagnostic:
    text = (match["round"] if match["round"] is not None else match["rest"]).strip()
    head = _EXPECT.fullmatch(text)
    if head is None:
        if _ALMOST.match(text):
            return _fault(span, "there is no `:` after `expect`", "write `(expect: GS501)`")
        return []
    body, place = head["body"].strip(), (head["place"] or "")[1:].strip()
    if head["place"] is not None and not place:
        return _fault(span, "`@` without a place", "write `@+1`, `@-2`, `@14` or `@*`")
    line = span.line if not place else None if place == "*" else int(place) + (span.line if place[0] in "+-" else 0)
    found: list[ExpectedFinding] = []
    at = 0
    while at < len(body):
        item = _ITEM.match(body, at)
        code = None if item is None else code_pattern(item["code"])
        if item is None or code is None:
            return _fault(span, f"`{body[at:].strip()[:40]}` is no finding", "write a code such as `GS501`")
        found.append(
            ExpectedFinding(
                code=code,
                line=line,
                severity=item["severity"] and item["severity"].lower(),
                message=item["message"],
                count=None if item["count"] is None else int(item["count"]),
            )
        )
        at = item.end()
    return found or _fault(span, "nothing is expected", "write a code such as `GS501` after `expect:`")


def _fault(span: Span, message: str, hint: str) -> Diagnostic:
    return Diagnostic(code="GS608", span=span, message=f"an expectation that cannot be read: {message}", hint=hint)
