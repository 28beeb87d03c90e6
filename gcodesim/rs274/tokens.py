"""The pieces of a line as the reader cuts it: letters, numbers, signs, comments, each with its place."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from gcodesim.rs274.block import ColumnRange
from gcodesim.rs274.reader import prepare, read_plain

if TYPE_CHECKING:
    from gcodesim.rs274.dialects import Dialect

VERBATIM: Final = "VERBATIM"
"""The kind of a piece whose characters are the user's own: nothing in it may change."""

_SHOWN_AS_WRITTEN: Final = frozenset(("NOTE", "NAME"))


class Token(NamedTuple):
    """One piece. `kind` is the name of a terminal of the grammar (`LETTER`, `NUMBER`, `NOTE` …), or `VERBATIM`.

    `text` has no blanks and is in lower case, except in comments and names, which stand as they are written.
    """

    kind: str
    text: str
    place: ColumnRange


def tokens_of(text: str, dialect: Dialect) -> list[Token]:
    """The pieces of a line that the reader of `dialect` can read; raises `Fault` where it cannot."""
    plain = read_plain(0, text)
    return _of_words(text, plain.places) if plain is not None else _of_grammar(text, dialect)


def _of_words(text: str, places: list[ColumnRange]) -> list[Token]:
    """The pieces of a line of plain words, before which only a line number may stand."""
    tokens = []
    begin = places[0][0] if places else len(text)
    if number := text[:begin].strip():
        first = text.index(number[0])
        tokens.append(Token("LINE_NUMBER", "".join(number.split()).lower(), (first, first + len(number))))
    for first, last in places:
        tokens.append(Token("LETTER", text[first].lower(), (first, first + 1)))
        at = first + 1
        if text[at] in "+-":
            tokens.append(Token("ADDING", text[at], (at, at + 1)))
            at += 1
        tokens.append(Token("NUMBER", text[at:last], (at, last)))
    return tokens


def _of_grammar(text: str, dialect: Dialect) -> list[Token]:
    from gcodesim.rs274.grammar import Unreadable, lexer_of

    squeezed, columns = prepare(text)
    try:
        found = lexer_of(dialect.grammar, dialect.grammar_parts)(squeezed)
    except Unreadable as problem:
        from gcodesim.rs274.unreadable import explain

        raise explain(problem, squeezed, columns, dialect) from None
    tokens = []
    for kind, value, first in found:
        place = columns[first], columns[first + len(value) - 1] + 1
        tokens.append(Token(kind, text[slice(*place)] if kind in _SHOWN_AS_WRITTEN else value, place))
    return tokens
