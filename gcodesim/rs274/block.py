"""What one line of a program says, before anything is computed or executed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from gcodesim.frozen import frozen

ColumnRange = tuple[int, int]  # first column and the one after the last, from 0


@frozen(kw_only=False)
class Signed:
    """A sign before a value that is not a plain number."""

    sign: float
    operand: Expression


@frozen(kw_only=False)
class Binary:
    """An operation; `closed` when brackets of its own stand around it."""

    operator: str
    left: Expression
    right: Expression
    closed: bool = False


@frozen(kw_only=False)
class Function:
    """A function of one value; `atan` has two."""

    name: str
    argument: Expression
    divisor: Expression = 0.0


@frozen(kw_only=False)
class Name:
    """A named parameter, without the angle brackets."""

    name: str


@frozen(kw_only=False)
class Parameter:
    """`#index`: a numbered parameter, or a named one."""

    index: Expression


@frozen(kw_only=False)
class Exists:
    index: Expression


Expression = float | Signed | Binary | Function | Name | Parameter | Exists


class Word(NamedTuple):
    """A letter and its value: a number, or an expression that yields one."""

    letter: str
    value: Expression


class Setting(NamedTuple):
    """`#index=value`; takes effect after its block has been read."""

    parameter: Expression
    value: Expression
    place: ColumnRange


class Note(NamedTuple):
    """A comment: its text without parentheses or semicolon."""

    text: str
    place: ColumnRange


KEYWORDS = (
    *("sub", "endsub", "call", "return", "do", "while", "endwhile", "if", "elseif", "else", "endif"),
    *("break", "continue", "repeat", "endrepeat"),
)
"""The commands of O-words."""


class Flow(NamedTuple):
    """An O-word. `keyword` is empty for a bare O1000, which opens a program for M98."""

    label: Expression
    keyword: str
    operands: tuple[Expression, ...]
    place: ColumnRange


@dataclass(slots=True)
class Block:
    """A line that has been read. `places` gives the columns of each word; plain lines find them on demand."""

    line: int
    text: str
    words: list[Word] | list[tuple[str, float]]
    settings: tuple[Setting, ...] = ()
    notes: tuple[Note, ...] = ()
    flow: Flow | None = None
    deleted: bool = False
    plain: bool = False
    slash: int | None = None
    """Column of a slash inside the line, on controls that skip what follows it."""
    odd: tuple[tuple[str, str, ColumnRange], ...] | None = None
    """What `odd_numbers` finds in it, once it has been asked."""
    _places: list[ColumnRange] | None = None
    _find: Callable[[str], list[ColumnRange]] | None = field(default=None, repr=False)

    @property
    def places(self) -> list[ColumnRange]:
        """Columns of each word, in the order of `words`."""
        if self._places is None:
            self._places = self._find(self.text) if self._find else []
        return self._places

    @property
    def comments(self) -> tuple[Note, ...]:
        """The comments in parentheses; text after a semicolon never acts."""
        return self.notes and tuple(note for note in self.notes if self.text[note.place[0]] == "(")

    def place_of(self, letter: str, nth: int = 0) -> ColumnRange | None:
        """Columns of the nth word with `letter`."""
        for word, place in zip(self.words, self.places, strict=False):
            if word[0] == letter:
                if nth == 0:
                    return place
                nth -= 1
        return None
