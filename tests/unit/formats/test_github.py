"""Annotations of GitHub workflows, read back by the rules by which a runner reads them."""

from __future__ import annotations

import re

import pytest

from gcodesim.diagnostics import Severity, Span
from gcodesim.formats.github import text_of
from gcodesim.regress.verdicts import JudgedFinding
from tests.unit.formats.verdicts import PROGRAM, Example, everything, finding, suite

_COMMAND = re.compile(r"::(error|warning|notice) ([^:]*)::(.*)")


def _unescaped(text: str, pairs: tuple[tuple[str, str], ...]) -> str:
    for code, char in pairs:
        text = text.replace(code, char)
    return text


def annotations(given: Example) -> list[tuple[str, dict[str, str], str]]:
    """Level, properties and message of each line; every line is a command."""
    read = []
    for line in text_of(given.verdict, given.places).splitlines():
        match = _COMMAND.fullmatch(line)
        assert match, line
        level, properties, message = match.groups()
        data = (("%0D", "\r"), ("%0A", "\n"), ("%25", "%"))
        pairs = dict(item.split("=", 1) for item in properties.split(","))
        named = {k: _unescaped(v, (("%3A", ":"), ("%2C", ","), *data)) for k, v in pairs.items()}
        read.append((level, named, _unescaped(message, data)))
    return read


def test_what_fails_is_an_error_and_comes_first() -> None:
    read = annotations(everything())
    shown = [(level, named["title"][:5]) for level, named, _ in read]
    assert shown == [("error", "GS501"), ("error", "GS501"), ("error", "GS610"), ("error", "GS111")]


def test_place_title_and_message() -> None:
    given = suite(JudgedFinding(finding=finding(hint="start it"), state="counts"), prefix="cnc")
    [(level, named, message)] = annotations(given)
    assert level == "error"
    assert named == {
        "file": "cnc/suite/a b.nc", "line": "2", "endLine": "2", "col": "1", "endColumn": "18",
        "title": "GS501 Feed into stock with the spindle stopped",
    }  # fmt: skip
    assert message == "T1 feeds through 3.5 mm³, 100 %\nhint: start it"


@pytest.mark.parametrize("text", ["a\r\nb", "50 %, 5%0A", "x::error::y", "%25"])
def test_a_message_comes_back_as_it_was(text: str) -> None:
    [(_, _, message)] = annotations(suite(JudgedFinding(finding=finding(message=text), state="counts")))
    assert message == text


def test_odd_file_names() -> None:
    span = Span("a,b:c=%41.nc", 1, 2, 1, 3)
    [(_, named, _)] = annotations(suite(JudgedFinding(finding=finding(span=span), state="counts")))
    assert named["file"] == span.file


@pytest.mark.parametrize(
    ("span", "keys"),
    [
        (Span(PROGRAM), set()),
        (Span(PROGRAM, 2), {"line", "endLine"}),
        (Span(PROGRAM, 2, 3, 4, 1), {"line", "endLine"}),
        (Span(PROGRAM, 2, 3, 2, 5), {"line", "endLine", "col", "endColumn"}),
    ],
)
def test_columns_only_within_a_line(span: Span, keys: set[str]) -> None:
    [(_, named, _)] = annotations(suite(JudgedFinding(finding=finding(span=span), state="counts")))
    assert named.keys() == keys | {"file", "title"}


def test_a_warning_that_does_not_fail_is_a_warning_and_a_note_is_nothing() -> None:
    warning = JudgedFinding(finding=finding(severity=Severity.WARNING), state="told")
    note = JudgedFinding(finding=finding(severity=Severity.NOTE, message="n"), state="told")
    assert [level for level, _, _ in annotations(suite(warning, note))] == ["warning"]
