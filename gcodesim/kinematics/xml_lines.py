"""XML with line numbers: what the standard element tree forgets and a finding needs."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any
from xml.parsers import expat


class XmlError(Exception):
    """Text that is not XML; `line` and `column` count from 1."""

    def __init__(self, message: str, line: int, column: int) -> None:
        super().__init__(message)
        self.line = line
        self.column = column


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


def parse_xml(raw: bytes) -> LinedElement:
    """The root element; XmlError on anything that is not well-formed, and on a document type (it can hide bombs)."""
    parser = expat.ParserCreate()
    root: list[LinedElement] = []
    stack: list[LinedElement] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = LinedElement(tag, attributes)
        element.line, element.column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        if stack:
            stack[-1].append(element)
        else:
            root.append(element)
        stack.append(element)

    def refuse(*_: Any) -> None:
        raise XmlError("a document type declaration is not read here", parser.CurrentLineNumber, 1)

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as error:
        raise XmlError(expat.ErrorString(error.code), error.lineno, error.offset + 1) from None
    except ValueError as error:  # an encoding that expat does not know
        raise XmlError(str(error), 1, 1) from None
    return root[0]
