"""JUnit XML: a test case for each program, in suites by folder; at most one failure per case, with all its findings.

Written for the schema of Jenkins (`junit-4.xsd`, also `junit-10.xsd`), which other readers accept as well. Times
are those of the simulated machine; there is no time stamp and no host.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from gcodesim.diagnostics.plain import one_line
from gcodesim.diagnostics.show import as_text, place
from gcodesim.formats.places import FilePlaces
from gcodesim.formats.text import counting, found_text
from gcodesim.regress.suite import INTERNAL
from gcodesim.regress.verdicts import CaseVerdict, JudgedFinding, SuiteVerdict

_NAME: Final = "gcodesim"
_NO_XML: Final = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def text_of(verdict: SuiteVerdict, places: FilePlaces) -> str:
    """The document. Faults in test files are errors of test cases with the name of the file."""
    folders: dict[str, list[CaseVerdict | JudgedFinding]] = {}
    for case in verdict.cases:
        folders.setdefault(_folder(case.name), []).append(case)
    for one in verdict.found:
        folders.setdefault(_folder(one.finding.span.file), []).append(one)
    root = Element("testsuites", {"name": _NAME})
    suites = [_suite(folder, folders[folder], places) for folder in sorted(folders)]
    root.extend(suites)
    for name in ("tests", "failures", "errors"):
        root.set(name, str(sum(int(suite.attrib[name]) for suite in suites)))
    root.set("time", _seconds(sum(case.simulated_s for case in verdict.cases)))
    ElementTree.indent(root, " ")
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{body}\n'


def _folder(name: str) -> str:
    return name.rpartition("/")[0]


def _suite(folder: str, members: Sequence[CaseVerdict | JudgedFinding], places: FilePlaces) -> Element:
    cases = [member for member in members if isinstance(member, CaseVerdict)]
    faults = [member for member in members if isinstance(member, JudgedFinding)]
    suite = Element(
        "testsuite",
        {
            "name": _xml(one_line(folder or _NAME)),
            "tests": str(len(members)),
            "failures": str(sum(_outcome(case) == "failure" for case in cases)),
            "errors": str(sum(_outcome(case) == "error" for case in cases) + sum(f.state == "counts" for f in faults)),
            "skipped": str(sum(case.status == "not_run" for case in cases)),
            "time": _seconds(sum(case.simulated_s for case in cases)),
        },
    )
    for case in cases:
        _add_case(suite, folder, case, places)
    for fault in faults:
        _add_fault(suite, folder, fault, places)
    return suite


def _outcome(case: CaseVerdict) -> str:
    """The element that says how a case ended; an error is our fault, not the program's."""
    if case.status != "failed":
        return ""
    return "error" if any(one.code == INTERNAL for one in case.counting) else "failure"


def _add_case(suite: Element, folder: str, case: CaseVerdict, places: FilePlaces) -> None:
    element = _test(suite, folder, case.name, case.simulated_s)
    if case.status == "not_run":
        SubElement(element, "skipped").text = "not run, because an earlier case failed"
        return
    failing = counting(case)
    if failing:
        codes = dict.fromkeys(one.finding.code for one in failing)
        first = failing[0].finding
        more = f" (and {len(failing) - 1} more)" if len(failing) > 1 else ""
        message = f"{place(first.span)}: {first.code}: {one_line(_xml(first.message))}{more}"
        failure = SubElement(element, _outcome(case), {"type": " ".join(codes), "message": _xml(message)})
        failure.text = _xml("\n".join(found_text(one, places.sources) for one in failing))
    others = [found_text(one, places.sources) for one in case.found if one.state != "counts"]
    if others:
        SubElement(element, "system-out").text = _xml("\n".join(others))


def _add_fault(suite: Element, folder: str, fault: JudgedFinding, places: FilePlaces) -> None:
    finding = fault.finding
    element = _test(suite, folder, finding.span.file, 0.0)
    text = _xml(as_text(finding, places.sources))
    if fault.state == "counts":
        SubElement(element, "error", {"type": finding.code, "message": one_line(_xml(finding.message))}).text = text
    else:
        SubElement(element, "system-out").text = text


def _test(suite: Element, folder: str, name: str, seconds: float) -> Element:
    own = name.rpartition("/")[2]
    names = {"classname": folder.replace("/", ".") or _NAME, "name": own}
    attributes = {**{what: _xml(one_line(name)) for what, name in names.items()}, "time": _seconds(seconds)}
    return SubElement(suite, "testcase", attributes)


def _seconds(time: float) -> str:
    return f"{time:.3f}"


def _xml(text: str) -> str:
    """`text` without the characters that XML 1.0 cannot express."""
    return _NO_XML.sub("\N{REPLACEMENT CHARACTER}", text)
