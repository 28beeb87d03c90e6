"""SARIF 2.1.0 for code scanning: rules with their help, results with spans, fingerprints and suppressions."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any, Final
from urllib.parse import quote

from gcodesim.diagnostics import Span
from gcodesim.diagnostics.plain import one_line
from gcodesim.formats.items import Item, items_of
from gcodesim.formats.places import FilePlaces
from gcodesim.formats.sarif_rules import LEVELS, rules
from gcodesim.numbers import clean
from gcodesim.regress.verdicts import SuiteVerdict
from gcodesim.version import __version__

SCHEMA: Final = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_BASE: Final = "%SRCROOT%"
_FINGERPRINT: Final = "gcodesim/v1"
_BASE_TEXT: Final = "the top of the repository, or the folder in which gcodesim ran when there is none"

Json = dict[str, Any]


def text_of(verdict: SuiteVerdict, places: FilePlaces) -> str:
    """One run with all rules of the catalogue declared, so that alerts close when their findings go."""
    items = items_of(verdict, places)
    declared = rules()
    index = {rule["id"]: i for i, rule in enumerate(declared)}
    named = [name for case in verdict.cases for name in (case.program, case.cell) if name is not None]
    artifacts = _artifacts(named, items, places)
    at = {artifact["location"]["uri"]: i for i, artifact in enumerate(artifacts)}
    run = {
        "tool": {
            "driver": {
                "name": "gcodesim",
                "version": __version__,
                "semanticVersion": __version__,
                "shortDescription": {"text": "Simulator of G-code-driven manufacturing cells"},
                "rules": declared,
            }
        },
        # the tool itself ran successfully whatever the program; faults of a program are results
        "invocations": [{"executionSuccessful": True}],
        "originalUriBaseIds": {_BASE: {"description": {"text": _BASE_TEXT}}},
        "columnKind": "unicodeCodePoints",
        "artifacts": artifacts,
        "results": [_result(item, index[item.finding.code], at) for item in items],
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(clean(log), ensure_ascii=False, allow_nan=False, indent=1) + "\n"


def _uri(name: str) -> str:
    """A relative reference, in whose first part a colon would be read as a scheme."""
    return quote(name, safe="/~!$&'()*+,;=@", errors="surrogateescape")


def _text(text: str) -> str:
    """A piece of a message, with anything escaped that readers would take for a link (SARIF 2.1.0, 3.11.6)."""
    return one_line(text).replace("](", "\\](")


def _artifacts(named: Iterable[str], items: Iterable[Item], places: FilePlaces) -> list[Json]:
    """Programs and cells of the cases, and all other files that results name, in the order of their names."""
    analysed = {places.shown(name): name for name in named}
    files = sorted({*analysed, *(span.file for item in items for span in _spans(item))})
    artifacts = []
    for file in files:
        artifact: Json = {"location": {"uri": _uri(file), "uriBaseId": _BASE}}
        source = places.sources.get(analysed[file]) if file in analysed else None
        if file in analysed:
            artifact["roles"] = ["analysisTarget"]
        if source is not None:
            encoding = {"utf-8": "UTF-8", "latin-1": "ISO-8859-1"}[source.encoding]
            artifact |= {"encoding": encoding, "length": len(source.raw), "hashes": {"sha-256": source.sha256}}
        artifacts.append(artifact)
    return artifacts


def _spans(item: Item) -> list[Span]:
    span, related = item.finding.span, item.finding.related
    callers = [Span(caller.file, caller.line) for caller in span.callers]
    return [span, *callers, *([] if related is None else [related])]


def _result(item: Item, rule_index: int, at: dict[str, int]) -> Json:
    finding = item.finding
    lines = [_text(finding.message), *([f"hint: {_text(finding.hint)}"] if finding.hint else [])]
    result: Json = {
        "ruleId": finding.code,
        "ruleIndex": rule_index,
        "level": LEVELS[finding.level],
        "message": {"text": "\n".join(lines)},
        "locations": [_location(finding.span, at)],
        "partialFingerprints": {_FINGERPRINT: item.fingerprint},
        "occurrenceCount": max(finding.count, 1),
    }
    related = _related(item, at)
    if related:
        result["relatedLocations"] = related
    suppression = _suppression(item)
    if suppression is not None:
        result["suppressions"] = [suppression]
    figures = {"time_s": finding.time, "value": finding.value, "limit": finding.limit, "unit": finding.unit}
    result["properties"] = {
        "state": item.state,
        **({"cases": list(item.cases)} if item.cases else {}),
        **{name: value for name, value in figures.items() if value is not None},
    }
    return result


def _location(span: Span, at: dict[str, int]) -> Json:
    uri = _uri(span.file)
    physical: Json = {"artifactLocation": {"uri": uri, "uriBaseId": _BASE, "index": at[uri]}}
    if span.line:  # a finding about a whole file has no region
        physical["region"] = _region(span)
    return {"physicalLocation": physical}


def _region(span: Span) -> Json:
    """A span as a region; both count columns from 1, and the end is the column after the last."""
    if not span.column:
        return {"startLine": span.line}
    end_line = max(span.end_line, span.line)
    end_column = span.end_column if end_line > span.line else max(span.end_column, span.column + 1)
    return {
        "startLine": span.line,
        "startColumn": span.column,
        "endLine": end_line,
        "endColumn": max(end_column, 1),
    }


def _related(item: Item, at: dict[str, int]) -> list[Json]:
    """The calls that led to the place, innermost first, and other places that the finding points at."""
    span, related = item.finding.span, item.finding.related
    places = [
        (Span(caller.file, caller.line), f"called from here ({caller.name})") for caller in reversed(span.callers)
    ]
    if related is not None:
        places.append((related, "see here"))
    return [
        {"id": number, **_location(place, at), "message": {"text": _text(text)}}
        for number, (place, text) in enumerate(places, start=1)
    ]


def _suppression(item: Item) -> Json | None:
    """Why nobody has to look at a result; it stays in the file, marked as suppressed."""
    reasons = {
        "suppressed": item.reason or "suppressed by the cell",
        "expected": "the test expects it",
        "accepted": "it stands in the accepted results",
        "baseline": "it stands in the baseline",
    }
    if item.state not in reasons:
        return None
    return {"kind": "external", "status": "accepted", "justification": reasons[item.state]}
