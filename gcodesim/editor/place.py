"""Places in a text as editors count them: lines from 0, columns in UTF-16 units; ours count code points from 1."""

from __future__ import annotations

from typing import NamedTuple

from gcodesim.diagnostics import SourceText, Span


class TextRange(NamedTuple):
    """Part of a text: line and column of its begin and of what follows its end, from 0, columns in code points."""

    line: int
    column: int
    end_line: int
    end_column: int


def range_of(span: Span, source: SourceText) -> TextRange:
    """The range of a finding's place; of one without a line, the first line."""
    if not span.line:
        return TextRange(0, 0, 0, len(source.line(1)))
    line = span.line - 1
    end_line = (span.end_line or span.line) - 1
    column = max(span.column - 1, 0)
    end_column = span.end_column - 1 if span.end_column else len(source.line(end_line + 1))
    return TextRange(line, column, end_line, max(end_column, column) if end_line == line else end_column)


def whole_line(line: int, source: SourceText) -> TextRange:
    """The line with index `line`."""
    return TextRange(line, 0, line, len(source.line(line + 1)))


def units_before(text: str, column: int) -> int:
    """The column in UTF-16 units of a column in code points."""
    before = text[:column]
    return len(before) if before.isascii() else len(before.encode("utf-16-le", "surrogatepass")) // 2


def column_of(text: str, units: int) -> int:
    """The column in code points of one in UTF-16 units; in the middle of a character, that of the character."""
    if text.isascii():
        return min(units, len(text))
    passed = 0
    for column, character in enumerate(text):
        if passed >= units:
            return column
        passed += 2 if ord(character) > 0xFFFF else 1
    return len(text)
