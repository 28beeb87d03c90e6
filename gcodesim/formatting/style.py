"""How a program is to look."""

from __future__ import annotations

from typing import Final, Literal

from gcodesim.frozen import frozen
from gcodesim.rs274.dialects import Dialect

MOST_NUMBER: Final = 99_999
"""The greatest N that all controls take."""


@frozen
class Style:
    """The house style, and what a shop may want otherwise.

    `spaces` are written between words and around operators, `indent` blanks before what stands in a subroutine, branch
    or loop of O-words. `code_digits` 2 writes G01 and M06. `step` numbers the blocks that have an N anew, in steps of
    so many.
    """

    spaces: bool = True
    case: Literal["upper", "lower"] = "upper"
    indent: int = 2
    code_digits: Literal[1, 2] = 1
    step: int | None = None


def keeps_point(dialect: Dialect) -> bool:
    """Whether X10. may be more than X10 to a control, so that no point may come or go."""
    return "decimal_point" in dialect.options


_NUMBERED: Final = frozenset("gm")
_NAMES: Final = frozenset("tpqol")


def is_code(letter: str) -> bool:
    """Whether what follows a letter is a code, as in G1."""
    return letter in _NUMBERED


def is_name(letter: str, dialect: Dialect) -> bool:
    """Whether the digits behind a letter are a name, in which leading zeros belong to how it is written: T0101."""
    return letter == "o" or (dialect.statements and letter in _NAMES)
