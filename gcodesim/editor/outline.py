"""The structure of a program: subroutines, tools, and the comments that stand alone, which name operations."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING, Literal, NamedTuple

from gcodesim.diagnostics.plain import one_line
from gcodesim.editor.place import TextRange, whole_line

if TYPE_CHECKING:
    from gcodesim.editor.program_document import ProgramDocument
    from gcodesim.rs274.tokens import Token

_TEXT = re.compile(r"[^\W_]")


class ProgramPart(NamedTuple):
    """A part of a program: its `name`, the line that says so, and all lines that belong to it."""

    kind: Literal["subroutine", "tool", "comment"]
    name: str
    line: int
    last: int


def parts_of(document: ProgramDocument) -> list[ProgramPart]:
    """Subroutines, tool changes and comments on lines of their own, in the order of the program."""
    file = document.file
    if file is None:
        return []
    found = [
        ProgramPart("subroutine", name, at, _end_of(document, label, at))
        for label, at, name in file.outline.subroutines()
    ]
    for index, text in enumerate(file.lines):
        head = text.lstrip()[:1]
        if head and head in "(;":
            found += _comment(text, index)
        elif "t" in text or "T" in text:
            found += _tool(document.tokens(index), index)
    found.sort(key=lambda one: one.line)
    starts = [one.line for one in found if one.kind != "subroutine"]
    return [_until_next(one, starts, len(file.lines)) for one in found]


def range_of_part(document: ProgramDocument, part: ProgramPart) -> TextRange:
    """All lines of a part."""
    end = whole_line(part.last, document.source)
    return TextRange(part.line, 0, end.end_line, end.end_column)


def _comment(text: str, index: int) -> list[ProgramPart]:
    said = text.strip().strip("();").strip()
    return [ProgramPart("comment", one_line(said), index, index)] if _TEXT.search(said) else []


def _tool(tokens: list[Token], index: int) -> list[ProgramPart]:
    pairs = {
        token.text: value.text.lstrip("0") or "0"
        for token, value in pairwise(tokens)
        if token.kind == "LETTER" and value.kind == "NUMBER"
    }
    if "t" not in pairs:
        return []
    note = next((token.text.strip("();").strip() for token in tokens if token.kind == "NOTE"), "")
    return [ProgramPart("tool", f"T{pairs['t']}" + (f" {one_line(note)}" if note else ""), index, index)]


def _end_of(document: ProgramDocument, label: str, at: int) -> int:
    """The last line of a subroutine."""
    file = document.file
    assert file is not None
    found = file.find_flow(at, label, frozenset(("endsub",)))
    if found is not None:
        return found.at
    part = next((part for part in file.numbered if part.start <= at < part.stop), None)
    return at if part is None else part.stop - 1


def _until_next(one: ProgramPart, starts: list[int], lines: int) -> ProgramPart:
    if one.kind == "subroutine":
        return one
    later = next((start for start in starts if start > one.line), lines)
    return one._replace(last=max(later - 1, one.line))
