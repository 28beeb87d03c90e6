"""One line in the style, from the pieces into which the reader cuts it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from gcodesim.formatting.number import is_zero, number_text
from gcodesim.formatting.style import Style, is_code, is_name, is_position, keeps_point
from gcodesim.rs274.dialects import Dialect
from gcodesim.rs274.tokens import VERBATIM, Token

_SIGNS: Final = frozenset(("ADDING", "SIGN"))
_BINARY: Final = frozenset(("MULTIPLYING", "POWER", "RELATIONAL", "LOGICAL", "JOINING", "EQUAL"))
_FUNCTIONS: Final = frozenset(("FUNCTION", "ATAN", "POW", "EXISTS"))
_ENDS_VALUE: Final = frozenset(("NUMBER", "NAME", "RSQB"))
# behind these a value may follow at once
_ATTACHED: Final = frozenset(("LETTER", "CORNER", "HASH", "O", "LSQB", "SLASH", *_SIGNS, *_FUNCTIONS))
_STATEMENTS: Final = frozenset(("GOTO", "IF", "THEN", "WHILE", "DO", "END"))
_PARTS: Final = frozenset(("SKIP", "LETTER", "NOTE", "KEYWORD", "O", "COLON", *_STATEMENTS))
_WRITTEN_LOW: Final = frozenset(("O", "KEYWORD"))  # of O-words, as in LinuxCNC's manual
_AS_WRITTEN: Final = frozenset(("NOTE", "NAME", VERBATIM))


def line_text(tokens: Sequence[Token], style: Style, dialect: Dialect, numbers: Mapping[int, str]) -> str:
    """The line without its indentation; `numbers` are those that change, by the index of their token."""
    spaces = style.spaces or dialect.prints  # to a printer's control G0X1 may be a number in base 16
    shown: list[str] = []
    for at, apart in enumerate(_apart(tokens)):
        if apart and at and (spaces or tokens[at].kind == VERBATIM):
            shown.append(" ")
        shown.append(numbers[at] if at in numbers else _shown(tokens, at, style, dialect))
    return "".join(shown)


def _apart(tokens: Sequence[Token]) -> Iterator[bool]:
    """For each piece, whether a blank stands before it."""
    behind_operator = False
    functions: list[str] = []  # for each open bracket, what stands before it
    closed = ""
    for before, token in zip((None, *tokens), tokens, strict=False):
        kind, last = token.kind, "" if before is None else before.kind
        operator = _is_operator(kind, last, closed)
        if last == "SKIP" or (last == "SLASH" and before is tokens[0]):
            yield len(tokens[0].text) > 1
        elif last == "COMMA" and functions:
            yield True
        else:
            yield operator or behind_operator or _is_part(kind, last, inside=bool(functions))
        behind_operator = operator
        closed = ""
        if kind == "LSQB":
            functions.append(last)
        elif kind == "RSQB" and functions:
            closed = functions.pop()


def _is_operator(kind: str, last: str, closed: str) -> bool:
    """Whether a piece joins two values, with blanks around it; `closed` is the function of a bracket just closed."""
    if kind in _SIGNS:
        return last in _ENDS_VALUE
    return kind in _BINARY or (kind == "SLASH" and last in _ENDS_VALUE and closed != "ATAN")


def _is_part(kind: str, last: str, *, inside: bool) -> bool:
    """Whether a piece begins another part of the line."""
    if kind in _PARTS or kind == VERBATIM or last == "GOTO":
        return True
    if kind in _FUNCTIONS:
        return last in ("LETTER", "CORNER")
    if inside:
        return False
    return kind == "COMMA" or (kind in ("HASH", "LSQB") and last not in _ATTACHED)


def _shown(tokens: Sequence[Token], at: int, style: Style, dialect: Dialect) -> str:
    kind, text, _ = tokens[at]
    if kind in _AS_WRITTEN:
        return text.rstrip() if kind == "NOTE" else text
    if kind == "NUMBER":
        return _number(tokens, at, style, dialect)
    if kind in _SIGNS and _says_nothing(tokens, at):
        return ""
    low = (style.case == "lower" and not dialect.prints) or (kind in _WRITTEN_LOW and not dialect.statements)
    return text if low else text.upper()


def _number(tokens: Sequence[Token], at: int, style: Style, dialect: Dialect) -> str:
    text, before = tokens[at].text, tokens[at - 1]
    if before.kind in ("O", "COLON") or (before.kind == "LETTER" and is_name(before.text, dialect)):
        return text
    digits = style.code_digits if before.kind == "LETTER" and is_code(before.text) else 1
    letter = tokens[at - 2] if before.kind in _SIGNS and at > 1 else before
    decimals = style.decimals if letter.kind == "LETTER" and is_position(letter.text) else None
    return number_text(text, keep_point=keeps_point(dialect), digits=digits, decimals=decimals)


def _says_nothing(tokens: Sequence[Token], at: int) -> bool:
    """Whether a sign is the plus of a word, or the minus of a zero."""
    if at + 1 >= len(tokens) or tokens[at + 1].kind != "NUMBER" or tokens[at - 1].kind not in ("LETTER", "CORNER"):
        return False
    return tokens[at].text == "+" or is_zero(tokens[at + 1].text)
