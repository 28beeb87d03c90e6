"""Corrections that a finding names so exactly that an editor can make them."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from gcodesim.diagnostics import Diagnostic, SourceText
from gcodesim.editor.place import TextRange, range_of

_DID_YOU_MEAN: Final = re.compile(r"did you mean `([^`]+)`")
_LETTER_FOR_DIGIT: Final = re.compile(r"is it the letter [OIl]\? Write the digit [01]: ([A-Z0-9.]+)")
_COMMA: Final = re.compile(r"the decimal sign is a point: write ([0-9.]+)")


class Fix(NamedTuple):
    """`text` in place of `range`; `title` says what that does."""

    title: str
    range: TextRange
    text: str


def fixes_of(finding: Diagnostic, source: SourceText) -> list[Fix]:
    """What an editor may offer for a finding in `source`; empty where people have to think."""
    if not finding.span.line or finding.span.file != source.name:
        return []
    place = range_of(finding.span, source)
    line = source.line(place.line + 1)
    if (found := _DID_YOU_MEAN.search(finding.hint)) is not None and place.line == place.end_line:
        return [Fix(f"Write `{found[1]}`", place, found[1])]
    if finding.code == "GS003" and finding.hint == "add `)`":
        end = len(line.rstrip())
        return [Fix("Close the comment", TextRange(place.line, end, place.line, end), ")")]
    if finding.code == "GS010" and "M2" in finding.hint:
        return [_end(source)]
    for pattern in (_LETTER_FOR_DIGIT, _COMMA):
        if (found := pattern.search(finding.hint)) is not None:
            return _rewritten(found[1], place, line)
    return []


def _end(source: SourceText) -> Fix:
    """M2 behind the last line that says something; a percent sign stays last."""
    lines = source.lines
    last = max((n for n, text in enumerate(lines) if text.strip() not in ("", "%")), default=0)
    end = len(lines[last])
    return Fix("End the program with M2", TextRange(last, end, last, end), "\nM2")


def _rewritten(right: str, place: TextRange, line: str) -> list[Fix]:
    """`right` in place of what looks like it around the place."""
    twins = {"0": "[0Oo]", "1": "[1lIi]", ".": "[.,]"}
    looks = re.compile("".join(twins.get(char, re.escape(char)) for char in right), re.IGNORECASE)
    for found in looks.finditer(line):
        if found.start() <= place.column <= found.end() and found[0] != right:
            return [Fix(f"Write `{right}`", TextRange(place.line, found.start(), place.line, found.end()), right)]
    return []
