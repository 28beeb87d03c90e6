"""What differs between two texts of a program, and how far back that may have been looked at."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274.program_file import ProgramFile

# what leads to other lines, so that a change of it may have been met before it is reached
_STRUCTURE: Final = re.compile(r"[oO%<:]|GOTO|WHILE|DO|END|IF|THEN|M\s*0*9[89]", re.IGNORECASE)
_NUMBER: Final = re.compile(r"\s*+(?:\([^)]*\)\s*+)*+(?:/[1-9]?\s*+)?N\s*+([0-9]+)", re.IGNORECASE)
_JUMPS: Final = re.compile(rb"GOTO|M\s*0*99\s*P|G\s*7[0-3]", re.IGNORECASE)
_NOTE: Final = re.compile(r"\([^)]*\)?|;.*")
_NOT_PASSED_OVER: Final = frozenset(("call", ""))


@frozen
class TextChange:
    """Lines from index `first` on were replaced: up to and with `last` in the new text (before `first` if lines went).

    `shift`: how many lines there are more. `depends_on`: the first line that may have looked at one of them.
    """

    first: int
    last: int
    shift: int
    depends_on: int
    is_one: bool = True

    def __bool__(self) -> bool:
        return self.is_one


def change_between(old: ProgramFile, new: SourceText) -> TextChange | None:
    """The change; None for one after which the whole program has to be read again."""
    if old.source.raw == new.raw:
        return TextChange(first=0, last=0, shift=0, depends_on=0, is_one=False)
    if old.decides:  # a line may open or close a block around any other
        return None
    before, after = old.lines, new.lines
    first, tail = _alike(old.source, new)
    removed, added = before[first : len(before) - tail], after[first : len(after) - tail]
    shift = len(added) - len(removed)
    if _is_structural(removed, added, new.raw):
        return None
    depends_on = first
    if old.flows:
        if shift or any(line.count("(") != line.count(")") for line in (*removed, *added)):
            return None
        depends_on = _passed_over_from(old, first)
    return TextChange(first=first, last=first + len(added) - 1, shift=shift, depends_on=depends_on)


def _alike(old: SourceText, new: SourceText) -> tuple[int, int]:
    """How many lines from the top, and from the end, are certainly the same; found in the bytes."""
    before, after = old.table.starts, new.table.starts
    most = min(len(old.raw), len(new.raw))
    head = _longest(most, lambda count: old.raw[:count] == new.raw[:count])
    first = max(min(int(starts[:-1].searchsorted(head, "right")) for starts in (before, after)) - 1, 0)
    tail = _longest(most - head, lambda count: old.raw[len(old.raw) - count :] == new.raw[len(new.raw) - count :])
    return first, int((before[:-1] > len(old.raw) - tail).sum())


def _longest(most: int, holds: Callable[[int], bool]) -> int:
    """The greatest number up to `most` for which something holds that holds for all smaller ones."""
    low = 0
    while low < most:
        middle = (low + most + 1) // 2
        low, most = (middle, most) if holds(middle) else (low, middle - 1)
    return low


def _is_structural(removed: Sequence[str], added: Sequence[str], raw: bytes) -> bool:
    """Whether lines were changed by which others are found."""
    if any(_STRUCTURE.search(_NOTE.sub("", line)) for line in (*removed, *added)):
        return True
    return _numbers(removed) != _numbers(added) and _JUMPS.search(raw) is not None


def _numbers(lines: Sequence[str]) -> list[str]:
    return [match[1] for line in lines if (match := _NUMBER.match(line)) is not None]


def _passed_over_from(file: ProgramFile, line: int) -> int:
    """The first line from which a branch, loop or subroutine may lead past `line`."""
    ranges: dict[str, tuple[int, int]] = {}
    for flow in file.flows:
        if flow.keyword not in _NOT_PASSED_OVER:
            first, _ = ranges.get(flow.label, (flow.at, flow.at))
            ranges[flow.label] = (first, flow.at)
    return min((first for first, last in ranges.values() if first <= line <= last), default=line)
