"""What a control still reads of the lines that it skips on the way to an O-word.

A branch not taken is not executed, but every line goes through the reader of
lines, the line number and the label of an O-word are read, and the words of an
M98 in front of a line even computed; what is broken there is an error.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from typing import NamedTuple

from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import KEYWORDS, ProgramFile
from gcodesim.rs274.reader import Reader, prepare

_HEAD = re.compile(r"/?(?:n(?P<number>[0-9]*(?:\.[0-9]*)?))?(?P<rest>.*)", re.DOTALL)
_LABEL = re.compile(
    r"o(?:<[^>]*>|\[.*?\](?=[a-z(;]|\Z)|#[0-9<].*?(?=[a-z(;]|\Z)|[+-]?[0-9]+(?:\.0*)?(?![0-9.]))(?P<word>[a-z]*)"
)
_INTERESTING = re.compile(r"[(%]|^[ \t]*/?[ \t]*[nNoO]|^[ \t]*/?[ \t]*(?:[nN][0-9. \t]*)?[mM][ \t]*0*9[ \t]*8")


class Defect(NamedTuple):
    """A line that cannot be skipped; `fault` gives what is wrong, None if nothing is at the moment."""

    at: int
    while_defining: bool  # also on the way from a `sub` to its `endsub`
    fault: Callable[[], Fault | None]


class Skipped:
    """The defects of one file, found when first asked."""

    def __init__(self, file: ProgramFile, reader: Reader, longest: int, call: Callable[[int], Fault | None]) -> None:
        self._found = list(_defects(file, reader, longest, call))
        self._at = [defect.at for defect in self._found]

    def is_clear(self, after: int, before: int) -> bool:
        """Whether nothing between the indices `after` and `before` may ever be broken."""
        return bisect_right(self._at, after) == bisect_left(self._at, before)

    def first(self, after: int, before: int, *, defining: bool) -> tuple[int, Fault] | None:
        """Index and fault of the first broken line between the indices `after` and `before`."""
        for defect in self._found[bisect_right(self._at, after) :]:
            if defect.at >= before:
                break
            if (defect.while_defining or not defining) and (fault := defect.fault()) is not None:
                return defect.at, fault
        return None


def _defects(file: ProgramFile, reader: Reader, longest: int, call: Callable[[int], Fault | None]) -> list[Defect]:
    found: list[Defect] = []
    for index, text in enumerate(file.lines):
        if len(text) <= longest and _INTERESTING.search(text) is None:
            continue
        defect = _defect_of(index, text, file, reader, longest, call)
        if defect is not None:
            found.append(defect)
    return found


def _defect_of(
    index: int, text: str, file: ProgramFile, reader: Reader, longest: int, call: Callable[[int], Fault | None]
) -> Defect | None:
    def always(fault: Fault, *, while_defining: bool = True) -> Defect:
        return Defect(index, while_defining, lambda: fault)

    if len(text) > longest:
        return always(Fault("GS002", f"the line has {len(text)} characters; {longest} are allowed"))
    try:
        squeezed, _ = prepare(text)
    except Fault as fault:
        return always(fault)
    if squeezed == "%" and file.has_percent and index >= file.first:
        return always(Fault("GS130", "the program ends before the O-word that is looked for"))
    head = _HEAD.fullmatch(squeezed)
    assert head is not None
    number, rest = head["number"], head["rest"]
    if number is not None and re.fullmatch(r"[0-9]+(?:\.[0-9]+)?", number) is None:
        return always(Fault("GS005", "a line number is N and digits, without a sign"))
    if rest.startswith("m") and re.match(r"m0*98(?![0-9])", rest):
        return Defect(index, True, lambda: call(index))
    if not rest.startswith("o"):
        return None
    label = _LABEL.match(rest)
    if label is None:
        broken = re.match(r"o[+-]?[0-9]", rest) is not None
        return always(Fault("GS008", "the label of an O-word must be whole" if broken else "an O-word without a label"))
    after = rest[label.end("word") :]
    word = label["word"]
    if word:
        known = any(word.startswith(keyword) for keyword in KEYWORDS)
    else:
        known = after[:1] in ("", "(", ";")
    if not known:
        return always(Fault("GS008", f"`{word or after[:8]}` is no command of an O-word"), while_defining=False)
    return None


__all__ = ["Skipped"]
