"""How a program is to look."""

from __future__ import annotations

from typing import Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Range
from gcodesim.declarations.plain_kinds import Choice, Switch, Whole
from gcodesim.frozen import frozen
from gcodesim.rs274.dialects import Dialect

MOST_NUMBER: Final = 99_999
"""The greatest N that all controls take."""


@frozen
class Style:
    """The house style, and what a shop may want otherwise."""

    spaces: bool = key(Switch(), "blanks between words and around operators", default=True)
    case: str = key(Choice(("upper", "lower")), "of letters", default="upper")
    indent: int = key(Whole(Range(least=0.0, most=16.0)), "blanks before bodies of O-words", default=2)
    code_digits: int = key(Whole(Range(least=1.0, most=2.0)), "2 writes G01 and M06, 1 writes G1 and M6", default=1)
    decimals: int | None = key(
        Whole(Range(least=0.0, most=6.0)),
        "least digits behind the point of positions, which then all have a point: 3 writes X10.500, 0 writes X10. "
        "(default: as many as say something)",
        default=None,
    )
    step: int | None = key(
        Whole(Range(least=1.0, most=1000.0)),
        "number the blocks that have an N anew, in steps of so many",
        name="renumber",
        default=None,
    )


def keeps_point(dialect: Dialect) -> bool:
    """Whether X10. may be more than X10 to a control, so that no point may come or go."""
    return "decimal_point" in dialect.options


_NUMBERED: Final = frozenset("gm")
_NAMES: Final = frozenset("tpqol")
_POSITIONS: Final = frozenset("xyzabcuvwijkr")


def is_code(letter: str) -> bool:
    """Whether what follows a letter is a code, as in G1."""
    return letter in _NUMBERED


def is_position(letter: str) -> bool:
    """Whether what follows a letter says where: an end, a centre, a radius."""
    return letter in _POSITIONS


def is_name(letter: str, dialect: Dialect) -> bool:
    """Whether the digits behind a letter are a name, in which leading zeros belong to how it is written: T0101."""
    return letter == "o" or (dialect.statements and letter in _NAMES)
