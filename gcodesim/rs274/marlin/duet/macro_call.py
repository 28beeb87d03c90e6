"""M98 P"file": which file is called, with what."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final, NamedTuple

from gcodesim.rs274.block import ColumnRange
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.duet.syntax import Value

if TYPE_CHECKING:
    from gcodesim.rs274.marlin.duet.commands import Interpreter

_CALL: Final = re.compile(r"[ \t]*(?:[Nn][ \t]*[0-9]+[ \t]*)?([Mm]0*98)(?![0-9.])")
_LETTER: Final = re.compile(r"[ \t]*([A-Za-z])")
_VALUE: Final = re.compile(r'[ \t]*(?:"((?:[^"]|"")*)"|([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?))')
_BARE: Final = re.compile(r"[ \t]*[Pp][ \t]*([^\"{;]*[^\"{; \t])[ \t]*$")
_VOLUME: Final = re.compile(r"[0-9]:")
_SYSTEM: Final = "sys/"


class MacroCall(NamedTuple):
    """`path` as written, `is_fixed` where it is written and not computed; `given` are the other letters."""

    path: str
    place: ColumnRange
    is_fixed: bool
    given: dict[str, Value]


def is_call(code: str) -> bool:
    """Whether a line calls a macro."""
    return _CALL.match(code) is not None


def call_of(code: str, do: Interpreter) -> MacroCall | None:
    """The call in a line up to its comment; None for the M98 without P that says whether a macro may be halted.

    Raises `Fault`.
    """
    found = _CALL.match(code)
    assert found is not None
    if (bare := _BARE.match(code, found.end())) is not None:  # as before version 3
        return MacroCall(bare[1], bare.span(1), True, {})
    given: dict[str, Value] = {}
    path: Value = None
    place, is_fixed = found.span(1), False
    for letter, value, span in _letters(code, found.end(), do):
        if letter == "P":
            path, place, is_fixed = value, span, code[slice(*span)].lstrip()[:1] == '"'
        else:
            given[letter] = value
    if path is None:
        return None
    if type(path) is not str:
        raise Fault("GS106", "P of M98 is no file name", at=place, hint='the name stands in quotes: M98 P"clean.g"')
    return MacroCall(path, place, is_fixed, given)


def given_by(code: str, at: int, do: Interpreter) -> dict[str, Value]:
    """The letters of a call with their values, from the column `at` of a line up to its comment; raises `Fault`."""
    return {letter: value for letter, value, _ in _letters(code, at, do)}


def _letters(code: str, at: int, do: Interpreter) -> Iterator[tuple[str, Value, ColumnRange]]:
    """Letters with their values, and where these stand; P may stand twice, as the last one counts."""
    end, known = len(code.rstrip()), set[str]()
    while at < end:
        letter = _LETTER.match(code, at)
        if letter is None or letter[1].upper() in known:
            raise Fault("GS006", f"`{code[at:].strip()[:20]}` is no letter with a value", at=(at, end))
        at = letter.end()
        value, behind = _value(code, at, do)
        name = letter[1].upper()
        yield name, value, (at, behind)
        known |= {name} - {"P"}
        at = behind


def _value(code: str, at: int, do: Interpreter) -> tuple[Value, int]:
    """The value behind a letter, and where it ends: an expression, a text, a number, numbers with colons, or none."""
    rest = code[at:].lstrip()
    if rest[:1] == "{":
        try:
            return do.expression(code, at)
        except Fault as fault:
            fault.at = fault.at or (len(code) - len(rest), len(code.rstrip()))
            raise
    numbers: list[Value] = []
    while found := _VALUE.match(code, at):
        at = found.end()
        if found[1] is not None:
            return found[1].replace('""', '"'), at
        numbers.append(float(found[2]) if any(sign in found[2] for sign in ".eE") else int(found[2]))
        if code[at : at + 1] != ":":
            break
        at += 1
    return (numbers[0] if len(numbers) == 1 else tuple(numbers) or None), at


def files_of(path: str) -> Iterator[str]:
    """Where the file of a macro may be, as paths inside the folder that stands for the printer's card; none outside.

    A name alone is one of the folder for system files.
    """
    written = _VOLUME.sub("", path, count=1).replace("\\", "/")
    if "\0" in written or ":" in written:
        return
    ways = (written, written.lstrip("/").removeprefix(_SYSTEM)) if written[:1] == "/" else (written, _SYSTEM + written)
    for way in ways:
        inside = posixpath.normpath(way.lstrip("/"))
        if inside != "." and inside.split("/")[0] != "..":
            yield inside
