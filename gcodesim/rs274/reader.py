"""Lines to blocks: a scan for plain words and numbers, the grammar for everything else.

Both ways give the same block; the scan only spares the grammar on the lines
that CAM systems write.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable
from typing import TYPE_CHECKING

from gcodesim.rs274.block import Block, ColumnRange, Flow, Note, Setting, Word
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.shapes import Shapes

if TYPE_CHECKING:
    from gcodesim.rs274.dialects import Dialect
    from gcodesim.rs274.grammar import Parsed

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_LETTERS = "A-MP-Za-mp-z@^"
# possessive quantifiers, so that a line that does not match is given up after one pass
_PLAIN = re.compile(rf"[ \t]*+(?:[Nn][0-9]++[ \t]*+)?+(?:[{_LETTERS}]{_NUMBER}[ \t]*+)*+")
_WORD = re.compile(rf"([{_LETTERS}])({_NUMBER})")
_BLANK = re.compile(r"[ \t]*\Z")
_NO_BLANKS = str.maketrans("", "", " \t")
_MOST_BRACKETS = 200


def _plain_places(text: str) -> list[ColumnRange]:
    line_number = re.match(r"[ \t]*[Nn][0-9]+", text)
    return [m.span() for m in _WORD.finditer(text, line_number.end() if line_number else 0)]


def read_plain(line: int, text: str) -> Block | None:
    """The block of a line made of words with plain numbers; None when the line holds anything else."""
    scanned = _PLAIN.match(text)
    if scanned is None or scanned.end() != len(text):
        return None
    start = 0
    head = text.lstrip()[:1]
    if head in ("N", "n"):
        start = text.index(head) + 1  # the N word itself is dropped
    words = [(letter.lower(), float(number)) for letter, number in _WORD.findall(text, start)]
    return Block(line, text, words, plain=True, _find=_plain_places)


def prepare(text: str) -> tuple[str, list[int]]:
    """The line without blanks and in lower case outside comments, and the column each character came from.

    Raises `Fault` on comments that nest or do not close.
    """
    if text.isascii() and "(" not in text and ";" not in text:
        columns = [at for at, char in enumerate(text) if char not in " \t"]
        columns.append(len(text))
        return text.translate(_NO_BLANKS).lower(), columns
    out: list[str] = []
    columns = []
    at = 0
    while at < len(text):
        char = text[at]
        if char == "(":
            end = text.find(")", at)
            nested = text.find("(", at + 1, end if end >= 0 else len(text))
            if nested >= 0:
                raise Fault("GS003", "a comment inside a comment", at=(nested, nested + 1), hint="close the first one")
            if end < 0:
                raise Fault("GS003", "the comment is never closed", at=(at, len(text)), hint="add `)`")
            out.append(text[at : end + 1])
            columns.extend(range(at, end + 1))
            at = end + 1
        elif char == ";":
            out.append(text[at:])
            columns.extend(range(at, len(text)))
            break
        else:
            if char not in " \t":
                # lower() may give two characters (as of a dotted capital I); columns must stay in step
                out.append(char.lower() if char.isascii() else char)
                columns.append(at)
            at += 1
    columns.append(len(text))
    return "".join(out), columns


class Reader:
    """Reads lines of one dialect; `read` gives the block or raises `Fault`."""

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect
        self._longest_line = dialect.longest_line
        self._parse: Callable[[str], Parsed] | None = None

    def read(self, line: int, text: str) -> Block:
        """The block of `text`, which stands in line number `line`."""
        if len(text) > self._longest_line:
            raise Fault(
                "GS002",
                f"the line has {len(text)} characters; {self._longest_line} are allowed",
                at=(self._longest_line, len(text)),
                hint="split the line, or shorten its comment",
                value=len(text),
                limit=self._longest_line,
            )
        return read_plain(line, text) or self._read_by_grammar(line, text)

    def _read_by_grammar(self, line: int, text: str) -> Block:
        squeezed, columns = prepare(text)
        if not squeezed:
            return Block(line, text, [])
        if squeezed[0] in "(;":
            only = _whole_comment(squeezed)
            if only is not None:
                return Block(line, text, [], notes=(Note(only, (columns[0], len(text.rstrip()))),))
        if squeezed.count("[") > _MOST_BRACKETS:
            raise Fault("GS006", f"more than {_MOST_BRACKETS} brackets in one line", hint="compute it in several steps")
        if self._parse is None:
            from gcodesim.rs274.grammar import parser_of  # Lark costs 50 ms, so only when a line needs it

            self._parse = Shapes(parser_of(self.dialect.grammar, self.dialect.grammar_parts)).parsed
        from gcodesim.rs274.grammar import Unreadable

        try:
            parsed = self._parse(squeezed)
        except Unreadable as problem:
            from gcodesim.rs274.unreadable import explain

            raise explain(problem, squeezed, columns, self.dialect) from None
        block = _to_block(line, text, squeezed, columns, parsed)
        self._check_extensions(block, squeezed, columns)
        return block

    def _check_extensions(self, block: Block, squeezed: str, columns: list[int]) -> None:
        """Raise `Fault` for parts of the language that this dialect does not have."""
        dialect = self.dialect
        if block.flow is not None and not dialect.flow_words:
            hint = "linuxcnc has them (--dialect linuxcnc)"
            raise Fault("GS008", f"{dialect.name} has no O-words", at=block.flow.place, hint=hint)
        if not dialect.named_parameters and "#<" in squeezed:
            at = squeezed.index("#<")
            if not any(first <= columns[at] < last for _, (first, last) in block.notes):
                place, hint = (columns[at], columns[at] + 2), "linuxcnc has them (--dialect linuxcnc)"
                raise Fault("GS007", f"{dialect.name} has no named parameters", at=place, hint=hint)


def _whole_comment(squeezed: str) -> str | None:
    """The comment of a line that is one comment and nothing else."""
    if squeezed[0] == ";":
        return ""  # after a semicolon nothing is active
    return squeezed[1:-1] if squeezed.find(")") == len(squeezed) - 1 else None


def _to_block(line: int, text: str, squeezed: str, columns: list[int], parsed: Parsed) -> Block:
    starts = sorted(
        [start for start, _ in parsed.words]
        + [start for start, _, _ in parsed.settings]
        + [start for start, _ in parsed.notes]
        + [len(squeezed)]
    )

    def place(start: int) -> ColumnRange:
        return columns[start], columns[starts[bisect_right(starts, start)] - 1] + 1

    def places(_: str) -> list[ColumnRange]:
        return [place(start) for start, _ in parsed.words]

    flow = None
    if parsed.flow is not None:
        start, label, keyword, operands = parsed.flow
        flow = Flow(label, keyword, operands, place(start))
    words: list[Word] = [word for _, word in parsed.words]
    return Block(
        line,
        text,
        words,
        settings=tuple(Setting(index, value, place(start)) for start, index, value in parsed.settings),
        notes=tuple(Note(note, place(start)) for start, note in parsed.notes),
        flow=flow,
        deleted=parsed.deleted,
        _find=places,
    )


__all__ = ["Reader", "prepare", "read_plain"]
