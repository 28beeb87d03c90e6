"""JUnit XML against the rules by which Jenkins, GitLab and others read it.

The schema (junit-4.xsd of the Jenkins plugin) is in no package of our index, so its rules stand here by name.
"""

from __future__ import annotations

from collections.abc import Callable
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import pytest

from gcodesim.formats.junit import text_of
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding
from tests.unit.formats.verdicts import Example, everything, example, finding, suite

ATTRIBUTES = {
    "testsuites": ({"name"}, {"time", "tests", "failures", "errors", "disabled"}),
    "testsuite": ({"name", "tests"}, {"failures", "errors", "time", "skipped"}),
    "testcase": ({"name", "classname"}, {"time", "assertions", "status"}),
    "failure": (set(), {"type", "message"}),
    "error": (set(), {"type", "message"}),
    "skipped": (set(), set()),
    "system-out": (set(), set()),
}
CHILDREN = {
    "testsuites": ["testsuite"],
    "testsuite": ["testcase"],
    "testcase": ["skipped", "error", "failure", "system-out"],
}


def known_elements_and_attributes(root: Element) -> bool:
    return all(
        ATTRIBUTES[e.tag][0] <= set(e.keys()) and set(e.keys()) <= ATTRIBUTES[e.tag][0] | ATTRIBUTES[e.tag][1]
        for e in root.iter()
    )


def children_in_the_order_of_the_schema(root: Element) -> bool:
    ranks = [(e, [CHILDREN.get(e.tag, []).index(c.tag) for c in e]) for e in root.iter()]
    return all(rank == sorted(rank) for _, rank in ranks)


def counts_add_up(root: Element) -> bool:
    def count(element: Element, tag: str) -> int:
        return sum(1 for _ in element.iter(tag))

    tags = {"tests": "testcase", "failures": "failure", "errors": "error", "skipped": "skipped"}
    return all(
        int(e.attrib[name]) == count(e, tag)
        for e in [root, *root.iter("testsuite")]
        for name, tag in tags.items()
        if name in e.attrib or e.tag == "testsuite"
    )


def times_are_seconds(root: Element) -> bool:
    return all(float(e.attrib["time"]) >= 0.0 for e in root.iter() if "time" in e.attrib)


def one_outcome_a_case(root: Element) -> bool:
    return all(sum(c.tag in ("failure", "error", "skipped") for c in case) <= 1 for case in root.iter("testcase"))


def names_are_unique(root: Element) -> bool:
    names = [(case.attrib["classname"], case.attrib["name"]) for case in root.iter("testcase")]
    return len(set(names)) == len(names)


RULES: list[Callable[[Element], bool]] = [
    known_elements_and_attributes,
    children_in_the_order_of_the_schema,
    counts_add_up,
    times_are_seconds,
    one_outcome_a_case,
    names_are_unique,
]


def document(given: Example) -> Element:
    text = text_of(given.verdict, given.places)
    assert text.startswith('<?xml version="1.0" encoding="utf-8"?>\n')
    return ElementTree.fromstring(text.encode())


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_rules(rule: Callable[[Element], bool]) -> None:
    assert rule(document(everything()))


@pytest.mark.parametrize(
    ("rule", "old", "new"),
    [
        (known_elements_and_attributes, ' classname="suite"', ""),
        (children_in_the_order_of_the_schema, "<failure", "<system-out/><failure"),
        (counts_add_up, 'failures="1"', 'failures="2"'),
        (times_are_seconds, 'time="12.346"', 'time="-1"'),
        (one_outcome_a_case, "<failure", "<error/><failure"),
        (names_are_unique, 'classname="suite.deep" name="b"', 'classname="suite" name="a"'),
    ],
)
def test_rules_see_a_fault(rule: Callable[[Element], bool], old: str, new: str) -> None:
    text = text_of(everything().verdict, everything().places)
    assert old in text
    assert not rule(ElementTree.fromstring(text.replace(old, new).encode()))


def test_a_case_a_program_in_suites_by_folder() -> None:
    root = document(everything())
    assert [e.attrib["name"] for e in root] == ["gcodesim", "suite", "suite/deep"]
    assert [(e.attrib["classname"], e.attrib["name"]) for e in root.iter("testcase")] == [
        ("gcodesim", "c"), ("suite", "a"), ("suite", "x.test.yaml"), ("suite.deep", "b"),
    ]  # fmt: skip
    assert root.attrib["time"] == "12.346"


def test_one_failure_tells_all_that_counts() -> None:
    failure = next(document(everything()).iter("failure"))
    assert failure.attrib["type"] == "GS501"
    assert failure.attrib["message"] == "suite/a b.nc:2:1: GS501: T1 feeds through 3.5 mm³, 100 % (and 1 more)"
    assert "new since the results were accepted" in (failure.text or "")
    assert "GS302" not in (failure.text or "")


def test_characters_that_xml_has_not() -> None:
    given = suite(JudgedFinding(finding=finding(message="bell \x07, \ud800, ]]> & <x>"), state="counts"))
    failure = next(document(given).iter("failure"))
    assert "bell \ufffd, \ufffd, ]]> & <x>" in failure.attrib["message"]


def test_a_suite_without_cases() -> None:
    root = document(example())
    assert root.attrib["tests"] == "0" and all(rule(root) for rule in RULES)


def test_a_fault_of_ours_is_an_error() -> None:
    root = document(suite(JudgedFinding(finding=finding("GS613"), state="counts")))
    assert (root.attrib["failures"], root.attrib["errors"]) == ("0", "1")
    assert next(root.iter("error")).attrib["type"] == "GS613" and all(rule(root) for rule in RULES)


def test_cases_that_were_not_run() -> None:
    case = CaseVerdict(name="c", file="c.nc", program="c.nc", cell=None, status="not_run")
    skipped = next(document(example(case)).iter("skipped"))
    assert skipped.text and not skipped.attrib
