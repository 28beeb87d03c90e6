"""Whether two texts of a program are the same program: each line says the same, and all together do the same."""

from __future__ import annotations

from itertools import zip_longest
from typing import Any

from gcodesim import canon
from gcodesim.diagnostics import SourceText
from gcodesim.formatting.numbering import Numbering
from gcodesim.rs274 import Settings, file_of, interpret
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import ProgramFile


def difference(old: SourceText, new: SourceText, settings: Settings, numbering: Numbering) -> str:
    """What differs between two texts, as one line of text; empty if nothing does.

    Compared are what each line says, also where nothing leads to it, apart from numbers that `numbering` changes, and
    the canonical events, apart from their places in the text.
    """
    return _of_lines(file_of(old, settings), file_of(new, settings), numbering) or _of_events(old, new, settings)


def _of_lines(old: ProgramFile, new: ProgramFile, numbering: Numbering) -> str:
    if len(old.lines) != len(new.lines):
        return f"{len(old.lines)} lines became {len(new.lines)}"
    for index, (before, after) in enumerate(zip(old.lines, new.lines, strict=True)):
        jumps = index in numbering.texts
        if before != after and not jumps and _meaning(old, index) != _meaning(new, index):
            return f"line {index + 1} says something else"
    return ""


def _meaning(file: ProgramFile, index: int) -> object:
    try:
        return file.meaning(index)
    except Fault as fault:
        return fault.code, fault.message


def _of_events(old: SourceText, new: SourceText, settings: Settings) -> str:
    runs = interpret(old, settings), interpret(new, settings)
    for before, after in zip_longest(*runs):
        if before is None or after is None:
            return "one of them ends earlier"
        if not _same(before, after):
            return f"line {before.span.line} does something else"
    return ""


def _same(before: canon.Event, after: canon.Event) -> bool:
    """Whether two events differ in their places at most."""
    return type(before) is type(after) and _values(before) == _values(after)


def _values(event: Any) -> list[Any]:
    return [getattr(event, name) for name in type(event).__dataclass_fields__ if name != "span"]
