"""XML with line numbers: what the standard element tree forgets and a finding needs."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final
from xml.parsers import expat

from gcodesim.diagnostics import Diagnostic, Severity, Span

_REMEDIES: Final = {
    "not at start of entity": "nothing may stand before `<?xml … ?>`: take that line out",
    "no element found": "the file is cut off, or an element is not closed",
    "mismatched tag": "an element that begins before this line is not closed",
}
_LARGEST: Final = 20_000_000
"""Bytes of a description; those of real robots have a hundredth of it."""
_OTHERWISE: Final = "`--` may not stand in a comment, nor `<` or `&` by themselves in a text"


class XmlError(Exception):
    """Text that is not XML; `line` and `column` count from 1, `hint` says what to do."""

    def __init__(self, message: str, line: int, column: int, hint: str = "") -> None:
        super().__init__(message)
        self.line = line
        self.column = column
        self.hint = hint


class LinedElement(ET.Element):
    """An element that knows where its tag begins."""

    line: int
    column: int

    def child(self, tag: str) -> LinedElement | None:
        """The first child `tag`."""
        return next((e for e in self.children(tag)), None)

    def children(self, tag: str) -> list[LinedElement]:
        """All children `tag`."""
        return [e for e in self if isinstance(e, LinedElement) and e.tag == tag]


@dataclass(slots=True)
class Faults:
    """What is wrong with one file of XML: findings at its elements."""

    file: str
    findings: list[Diagnostic] = field(default_factory=list)

    @property
    def failed(self) -> bool:
        return any(f.level >= Severity.ERROR for f in self.findings)

    def find(self, code: str, message: str, at: LinedElement | None, hint: str = "", count: int = 1) -> None:
        """A finding at the tag of `at`; without one, at the file."""
        span = Span(self.file)
        if at is not None:
            span = Span(self.file, at.line, at.column, at.line, at.column + len(at.tag) + 1)
        self.findings.append(Diagnostic(code=code, message=message, span=span, hint=hint, count=count))

    def find_at(self, line: int | None, column: int, code: str, message: str, hint: str = "") -> None:
        """A finding at a place in the file; None: at the file."""
        span = Span(self.file) if line is None else Span(self.file, line, column, line, column + 1)
        self.findings.append(Diagnostic(code=code, message=message, span=span, hint=hint))


def read_description(path: Path, what: str, faults: Faults) -> LinedElement | None:
    """The root of a description of format `what`, such as URDF; None, with a finding GS760, where it has none."""
    try:
        if path.stat().st_size > _LARGEST:
            faults.find("GS760", f"`{faults.file}` is larger than {_LARGEST // 1_000_000} MB, no {what} is", None)
            return None
        return parse_xml(path.read_bytes())
    except OSError as error:
        faults.find("GS760", f"`{faults.file}` cannot be read: {error.strerror}", None)
    except XmlError as error:
        faults.find_at(error.line, error.column, "GS760", f"the {what} is not well-formed XML: {error}", error.hint)
    return None


def parse_xml(raw: bytes) -> LinedElement:
    """The root element; XmlError on anything that is not well-formed, and on a document type (it can hide bombs).

    Blank lines before the declaration are passed over, as the readers of ROS and Bullet do.
    """
    text = raw.lstrip(b" \t\r\n")
    skipped = raw[: len(raw) - len(text)].count(b"\n")
    parser = expat.ParserCreate()
    root: list[LinedElement] = []
    stack: list[LinedElement] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = LinedElement(tag, attributes)
        element.line, element.column = parser.CurrentLineNumber + skipped, parser.CurrentColumnNumber + 1
        if stack:
            stack[-1].append(element)
        else:
            root.append(element)
        stack.append(element)

    def refuse(*_: Any) -> None:
        message = "a document type declaration is not read here"
        raise XmlError(message, parser.CurrentLineNumber + skipped, 1, "take out `<!DOCTYPE …>`")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        message = expat.ErrorString(error.code)
        hint = next((remedy for what, remedy in _REMEDIES.items() if what in message), _OTHERWISE)
        raise XmlError(message, error.lineno + skipped, error.offset + 1, hint) from None
    except ValueError as error:  # an encoding that expat does not know
        raise XmlError(str(error), 1, 1, "save the file as UTF-8") from None
    return root[0]
