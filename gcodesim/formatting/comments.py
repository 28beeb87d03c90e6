"""Comments behind the words of lines: where several stand in one column, they go on doing so."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from gcodesim.rs274.tokens import Token


class CommentedLine(NamedTuple):
    """A line in the style: its words, the comment at its end, and where that stood: its column, and the gap before."""

    code: str
    note: str = ""
    column: int = 0
    gap: int = 0


def ends_in_comment(tokens: Sequence[Token]) -> bool:
    """Whether a comment stands behind something else."""
    return len(tokens) > 1 and tokens[-1].kind == "NOTE"


def place_of_comment(text: str, tokens: Sequence[Token]) -> tuple[int, int]:
    """Column of the comment at the end of a line as it is seen, and how many blanks are before it."""
    column = len(text[: tokens[-1].place[0]].expandtabs())
    return column, column - len(text[: tokens[-2].place[1]].expandtabs())


def joined(lines: Sequence[CommentedLine], longest: int) -> list[str]:
    """The lines with their comments: one blank before each, but those of a column in one column.

    A column goes on over lines without a comment, and ends at an empty one and at a comment that stands elsewhere. No
    line gets longer than `longest` by it.
    """
    texts = [f"{line.code} {line.note}" if line.note else line.code for line in lines]
    group: list[int] = []
    for index, line in enumerate(lines):
        if not line.note and line.code:
            continue
        if group and (not line.note or lines[group[0]].column != line.column):
            _align(group, lines, texts, longest)
            group = []
        if line.note:
            group.append(index)
    _align(group, lines, texts, longest)
    return texts


def _align(group: Sequence[int], lines: Sequence[CommentedLine], texts: list[str], longest: int) -> None:
    """Put the comments of a group as far behind the longest of its lines as they were."""
    if len(group) < 2:
        return
    column = max(len(lines[index].code) for index in group) + max(1, min(lines[index].gap for index in group))
    if column + max(len(lines[index].note) for index in group) <= longest:
        for index in group:
            texts[index] = lines[index].code.ljust(column) + lines[index].note
