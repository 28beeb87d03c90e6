"""Lines that differ only in their numbers are parsed once.

A line's shape is the line with each number replaced by its place in the line,
1 for the first. The grammar parses the shape, in which it sees a number
wherever it sees one in the line; what it finds gets the line's own numbers and
columns. Where digits may be something else (comments, names) a line has no
shape, and a line that breaks the grammar is parsed itself, for its columns.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple

from gcodesim.rs274.block import Binary, Exists, Expression, Function, Parameter, Signed, Word

if TYPE_CHECKING:
    from gcodesim.rs274.grammar import Parsed

_NUMBER = re.compile(r"[0-9]+\.?[0-9]*|\.[0-9]+")  # as in all grammars
_HEAD = re.compile(r"n[0-9]+(?![0-9.])")
_MOST_SHAPES = 1000


class _Shape(NamedTuple):
    """The parsed form of a shape, and for the column of each part, how many numbers come before it."""

    parsed: Parsed
    numbers_before: dict[int, int]
    widths: list[int]  # of the numbers in the shape


class Shapes:
    """A parser that remembers shapes."""

    def __init__(self, parse: Callable[[str], Parsed]) -> None:
        self._parse = parse
        self._known: dict[tuple[str, ...], _Shape | None] = {}

    def parsed(self, line: str) -> Parsed:
        """The parts of a prepared line, like the parser's; raises the same exceptions."""
        if "(" in line or ";" in line or "<" in line or line[:1] in "/o:":
            return self._parse(line)
        head = _HEAD.match(line)
        if head is None and line[:1] == "n":
            return self._parse(line)
        begin = head.end() if head else 0
        spans = [match.span() for match in _NUMBER.finditer(line, begin)]
        edges = [begin, *(edge for span in spans for edge in span), len(line)]
        pieces = ("n" if head else "", *(line[a:b] for a, b in zip(edges[::2], edges[1::2], strict=True)))
        if "" in pieces[2:-1] or any("." in piece for piece in pieces):
            return self._parse(line)  # two numbers in a row, or a dot too many
        shape = self._known.get(pieces)
        if shape is None:
            if pieces in self._known or len(self._known) >= _MOST_SHAPES:
                return self._parse(line)
            shape = self._known[pieces] = self._shape_of(pieces)
            if shape is None:
                return self._parse(line)
        return _filled(shape, begin, [line[a:b] for a, b in spans])

    def _shape_of(self, pieces: tuple[str, ...]) -> _Shape | None:
        from gcodesim.rs274.grammar import Unreadable

        head, first, *rest = pieces
        text, ends = first, []
        for place, piece in enumerate(rest, 1):
            text += str(place)
            ends.append(len(text))
            text += piece
        try:
            parsed = self._parse(f"{head}1{text}" if head else text)
        except Unreadable:
            return None
        if parsed.flow is not None or parsed.notes:
            return None
        behind = 2 if head else 0
        starts = [start for start, _ in parsed.words] + [start for start, _, _ in parsed.settings]
        before = {start: sum(end <= start - behind for end in ends) for start in starts}
        return _Shape(parsed, before, [len(str(place)) for place in range(1, len(rest) + 1)])


def _filled(shape: _Shape, begin: int, numbers: list[str]) -> Parsed:
    """The parts with the numbers of a line, whose head ends at `begin`."""
    parsed, before, widths = shape
    values = [float(number) for number in numbers]
    grown = [len(number) - width for number, width in zip(numbers, widths, strict=True)]
    shifts = list(accumulate(grown, initial=begin - (2 if begin else 0)))

    def at(start: int) -> int:
        return start + shifts[before[start]]

    words = [(at(start), Word(word.letter, _with(values, word.value))) for start, word in parsed.words]
    settings = [(at(start), _with(values, index), _with(values, value)) for start, index, value in parsed.settings]
    return parsed._replace(words=words, settings=settings)


def _with(values: list[float], node: Expression) -> Expression:
    """`node` with places replaced by values; a 0 is not a place, but a part that is not written."""
    if isinstance(node, float):
        if node == 0.0:
            return node
        return values[int(node) - 1] if node > 0.0 else -values[int(-node) - 1]
    if isinstance(node, Parameter):
        return Parameter(_with(values, node.index))
    if isinstance(node, Binary):
        return Binary(node.operator, _with(values, node.left), _with(values, node.right), node.closed)
    if isinstance(node, Signed):
        return Signed(node.sign, _with(values, node.operand))
    if isinstance(node, Function):
        return Function(node.name, _with(values, node.argument), _with(values, node.divisor))
    if isinstance(node, Exists):
        return Exists(_with(values, node.index))
    return node
