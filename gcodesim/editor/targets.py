"""Where a word leads: to a subroutine, a block, a tool in the cell, the first setting of a parameter."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from gcodesim.editor.parameters import parameter_at, uses_of
from gcodesim.editor.place import TextRange, range_of, whole_line
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import plain_label

if TYPE_CHECKING:
    from gcodesim.editor.program_document import ProgramDocument
    from gcodesim.rs274.tokens import Token


class PlaceInFile(NamedTuple):
    """A place in a file."""

    path: Path
    range: TextRange


def target_of(document: ProgramDocument, line: int, column: int) -> PlaceInFile | None:
    """Where what stands at a place leads; None where it leads nowhere."""
    tokens = document.tokens(line)
    if document.file is None or not tokens:
        return None
    if (name := parameter_at(tokens, column)) is not None:
        uses = [use for use in uses_of(document, name, line) if use.sets] or uses_of(document, name, line)
        return PlaceInFile(document.path, uses[0].range) if uses else None
    return _block(document, tokens, line, column) or _tool(document, tokens, column) or _subroutine(document, tokens)


def _block(document: ProgramDocument, tokens: list[Token], line: int, column: int) -> PlaceInFile | None:
    """The block to which a GOTO or M99 P leads."""
    assert document.file is not None
    try:
        jumps = document.file.jumps(line)
    except Fault:
        return None
    for jump in jumps:
        if jump.at is None or not jump.lines or jump.lines[0] < 0:
            continue
        begin, end = tokens[jump.at - 1].place[0], tokens[jump.at].place[1]
        if begin <= column <= end:
            return PlaceInFile(document.path, whole_line(jump.lines[0], document.source))
    return None


def _tool(document: ProgramDocument, tokens: list[Token], column: int) -> PlaceInFile | None:
    """The tool of a T, H or D word in the cell."""
    cell, path = document.cell, document.cell_path
    for letter, value in pairwise(tokens):
        here = letter.place[0] <= column <= value.place[1]
        if not here or letter.kind != "LETTER" or letter.text not in "thd" or not value.text.isdigit():
            continue
        span = None if cell is None else cell.spans.get(("tools", int(value.text)))
        if cell is not None and path is not None and span is not None and span.file in (cell.name, path.name):
            from gcodesim.diagnostics import SourceText

            return PlaceInFile(path, range_of(span, SourceText.read(path)))
    return None


def _subroutine(document: ProgramDocument, tokens: list[Token]) -> PlaceInFile | None:
    """The subroutine that a line calls."""
    label = _called(tokens)
    if not label:
        return None
    for file in document.files:
        at = next((flow.at for flow in file.flows if flow.keyword == "sub" and flow.label == label), None)
        if at is None:
            at = next((index for one, index, _ in file.outline.subroutines() if one == label), None)
        if at is not None:
            path = document.path if file is document.file else (file.source.folder or document.path.parent) / file.name
            return PlaceInFile(path, whole_line(at, file.source))
    return None


def _called(tokens: list[Token]) -> str:
    """The label of an O-word, or the number of M98 P or G65 P."""
    for token, value in pairwise(tokens):
        if token.kind == "O":
            return plain_label(value.text)
        if (token.kind, token.text, value.kind) == ("LETTER", "p", "NUMBER"):
            return value.text.lstrip("0") or "0"
    return ""
