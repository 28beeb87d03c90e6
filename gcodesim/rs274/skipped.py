"""What a control still reads of the lines that it skips on the way to an O-word.

A branch not taken is not executed, but every line goes through the reader of
lines, the line number and the label of an O-word are read, and the words of an
M98 in front of a line even computed; what is broken there is an error.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Final, NamedTuple

from gcodesim.rs274.block import KEYWORDS
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.reader import prepare

_HEAD = re.compile(r"/?(?:n(?P<number>[0-9]*(?:\.[0-9]*)?))?(?P<rest>.*)", re.DOTALL)
_LABEL = re.compile(
    r"o(?:<[^>]*>|\[.*?\](?=[a-z(;]|\Z)|#[0-9<].*?(?=[a-z(;]|\Z)|[+-]?[0-9]+(?:\.0*)?(?![0-9.]))(?P<word>[a-z]*)"
)
_INTERESTING = re.compile(r"[(%]|^[ \t]*/?[ \t]*[nNoO]|^[ \t]*/?[ \t]*(?:[nN][0-9. \t]*)?[mM][ \t]*0*9[ \t]*8")


MOST_LINES_KNOWN: Final = 1 << 16
"""Texts of lines whose meaning is remembered: while one types, the file is gone through at each stroke."""


class Defect(NamedTuple):
    """Why a line cannot be skipped; `fault` says what is wrong, None for a call whose words are computed."""

    fault: Fault | None
    while_defining: bool = True  # also on the way from a `sub` to its `endsub`
    only_opened: bool = False  # only behind the `%` that opened the program


class Skipped:
    """The defects of the lines of one file.

    `longest` is how many characters a line may have, `opened` the first line after the `%` that opened the program.
    """

    def __init__(self, lines: Sequence[str], longest: int, opened: int | None) -> None:
        self._found = _defects(lines, longest, opened)
        self._at = [at for at, _ in self._found]

    def is_clear(self, after: int, before: int) -> bool:
        """Whether nothing between the indices `after` and `before` may ever be broken."""
        return bisect_right(self._at, after) == bisect_left(self._at, before)

    def first(
        self, after: int, before: int, *, defining: bool, call: Callable[[int], Fault | None]
    ) -> tuple[int, Fault] | None:
        """Index and fault of the first broken line between the indices `after` and `before`.

        `call` says what is wrong at the moment with the line with M98 that has an index.
        """
        for at, defect in self._found[bisect_right(self._at, after) : bisect_left(self._at, before)]:
            fault = call(at) if defect.fault is None else defect.fault
            if fault is not None and (defect.while_defining or not defining):
                return at, fault
        return None


def _defects(lines: Sequence[str], longest: int, opened: int | None) -> list[tuple[int, Defect]]:
    found = []
    for index, text in enumerate(lines):
        if len(text) > longest:
            found.append((index, Defect(Fault("GS002", f"the line has {len(text)} characters; {longest} are allowed"))))
            continue
        defect = None if _INTERESTING.search(text) is None else _defect_of(text)
        if defect is not None and (not defect.only_opened or (opened is not None and index >= opened)):
            found.append((index, defect))
    return found


@lru_cache(MOST_LINES_KNOWN)
def _defect_of(text: str) -> Defect | None:
    try:
        squeezed, _ = prepare(text)
    except Fault as fault:
        return Defect(fault)
    if squeezed == "%":
        return Defect(Fault("GS130", "the program ends before the O-word that is looked for"), only_opened=True)
    head = _HEAD.fullmatch(squeezed)
    assert head is not None
    number, rest = head["number"], head["rest"]
    if number is not None and re.fullmatch(r"[0-9]+(?:\.[0-9]+)?", number) is None:
        return Defect(Fault("GS005", "a line number is N and digits, without a sign"))
    if rest.startswith("m") and re.match(r"m0*98(?![0-9])", rest):
        return Defect(None)
    return _defect_of_o_word(rest) if rest.startswith("o") else None


def _defect_of_o_word(text: str) -> Defect | None:
    label = _LABEL.match(text)
    if label is None:
        broken = re.match(r"o[+-]?[0-9]", text) is not None
        return Defect(Fault("GS008", "the label of an O-word must be whole" if broken else "an O-word without a label"))
    after = text[label.end("word") :]
    word = label["word"]
    known = any(word.startswith(keyword) for keyword in KEYWORDS) if word else after[:1] in ("", "(", ";")
    if known:
        return None
    return Defect(Fault("GS008", f"`{word or after[:8]}` is no command of an O-word"), while_defining=False)


__all__ = ["MOST_LINES_KNOWN", "Skipped"]
