"""GitLab code quality reports: the keys that GitLab requires, fingerprints that stay."""

from __future__ import annotations

import json
from typing import Any

import jsonschema

from gcodesim.diagnostics import Severity, Span
from gcodesim.formats.gitlab import text_of
from gcodesim.regress.verdicts import JudgedFinding
from tests.unit.formats.verdicts import LINES, PROGRAM, Example, everything, finding, suite

# as GitLab's documentation of the format lists the keys
RULES = {
    "type": "array",
    "items": {
        "type": "object",
        "required": ["description", "check_name", "fingerprint", "severity", "location"],
        "properties": {
            "fingerprint": {"type": "string", "minLength": 1},
            "severity": {"enum": ["info", "minor", "major", "critical", "blocker"]},
            "location": {
                "type": "object",
                "required": ["path", "lines"],
                "properties": {
                    "path": {"type": "string", "pattern": r"^(?!\./|/)"},
                    "lines": {"type": "object", "required": ["begin"], "properties": {"begin": {"minimum": 1}}},
                },
            },
        },
    },
}


def issues(given: Example) -> list[dict[str, Any]]:
    value: list[dict[str, Any]] = json.loads(text_of(given.verdict, given.places))
    jsonschema.validate(value, RULES)
    assert len({issue["fingerprint"] for issue in value}) == len(value)
    return value


def test_open_findings_only() -> None:
    assert [issue["check_name"] for issue in issues(everything())] == ["GS733", "GS111", "GS501", "GS501", "GS610"]


def test_severities() -> None:
    by_level = {
        level: issues(suite(JudgedFinding(finding=finding(severity=level), state=state)))[0]["severity"]
        for level, state in ((Severity.ERROR, "counts"), (Severity.WARNING, "told"), (Severity.NOTE, "told"))
    }
    assert list(by_level.values()) == ["critical", "minor", "info"]
    counting = JudgedFinding(finding=finding(severity=Severity.WARNING), state="counts")
    assert issues(suite(counting))[0]["severity"] == "major"


def test_places() -> None:
    located = issues(suite(JudgedFinding(finding=finding(), state="counts"), prefix="cnc"))[0]["location"]
    assert located == {"path": "cnc/suite/a b.nc", "lines": {"begin": 2, "end": 2}}
    whole = issues(suite(JudgedFinding(finding=finding(span=Span(PROGRAM)), state="counts")))[0]["location"]
    assert whole["lines"] == {"begin": 1, "end": 1}


def test_a_fingerprint_does_not_know_the_line() -> None:
    old = issues(suite(JudgedFinding(finding=finding(), state="counts")))
    lower = finding(span=Span(PROGRAM, 3, 1, 3, 2))
    moved = suite(JudgedFinding(finding=lower, state="counts"), lines=["(new)", *LINES])
    assert issues(moved)[0]["fingerprint"] == old[0]["fingerprint"]
    assert issues(moved)[0]["location"]["lines"]["begin"] == 3
