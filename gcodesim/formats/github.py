"""Annotations of GitHub workflows: commands on stdout that put a finding beside the line of a pull request."""

from __future__ import annotations

from typing import Final

from gcodesim.diagnostics import Severity, code_of
from gcodesim.diagnostics.plain import lines
from gcodesim.formats.items import Item, items_of
from gcodesim.formats.places import FilePlaces
from gcodesim.regress.verdicts import SuiteVerdict

_NAMES: Final = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def text_of(verdict: SuiteVerdict, places: FilePlaces) -> str:
    """One line for each finding. What makes the job fail is an error; of the rest only warnings are shown.

    GitHub shows ten of a kind per step, so errors come first.
    """
    shown = [item for item in items_of(verdict, places) if item.state == "counts" or _is_warning(item)]
    shown.sort(key=lambda item: item.state != "counts")
    return "".join(f"{_line(item)}\n" for item in shown)


def _is_warning(item: Item) -> bool:
    return item.state == "told" and item.finding.level >= Severity.WARNING


def _line(item: Item) -> str:
    finding, span = item.finding, item.finding.span
    level = Severity.ERROR if item.state == "counts" else finding.level
    place: dict[str, object] = {"file": span.file}
    if span.line:
        place |= {"line": span.line, "endLine": max(span.end_line, span.line)}
        if span.column and place["endLine"] == span.line:
            place |= {"col": span.column, "endColumn": max(span.end_column, span.column + 1)}
    place["title"] = f"{finding.code} {code_of(finding.code).title}"
    parts = (finding.message, item.reason, finding.hint and f"hint: {finding.hint}")
    text = "\n".join(part for part in parts if part)
    properties = ",".join(f"{name}={_property(str(value))}" for name, value in place.items())
    return f"::{_NAMES[level]} {properties}::{_data(text)}"


def _data(text: str) -> str:
    """A message in the form of workflow commands: one line, with `%` escaped first."""
    fit = "\r".join(map(lines, text.split("\r")))
    return fit.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """A property: neither `:` nor `,` may end it early."""
    return _data(text).replace(":", "%3A").replace(",", "%2C")
