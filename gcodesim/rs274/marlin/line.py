"""One line of a printer's program as words: a command, its letters with their numbers, and its comment."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

from gcodesim.rs274.block import ColumnRange
from gcodesim.rs274.fault import Fault

_NUMBER: Final = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)"
_WORD: Final = re.compile(rf"[ \t]*(?:([A-Za-z])[ \t]*({_NUMBER})?|(\()|(\S|[\v\f]))", re.ASCII)
_FURTHER: Final = re.compile(rf"(?:[ \t]*:[ \t]*{_NUMBER})+")
_LINE_NUMBER: Final = re.compile(r"[ \t]*[Nn][ \t]*-?[0-9]+[ \t]*")
_CHECKSUM: Final = re.compile(r"[ \t]*\*[ \t]*([0-9]+)[ \t]*$")
_COMMAND: Final = re.compile(r"[ \t]*([GMTDgmtd])[ \t]*([0-9]+)(?:\.([0-9]+))?", re.ASCII)
_NO_TOOL: Final = re.compile(r"[ \t]*([Tt])[ \t]*-[ \t]*0*1(?![0-9.])")
_MACRO: Final = re.compile(r"[ \t]*([A-Za-z_][A-Za-z_][A-Za-z0-9_]*)", re.ASCII)
_SETTING: Final = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)[ \t]*=[ \t]*(\"[^\"]*\"|\S*)", re.ASCII)

# what stands behind these is text, not words
_TEXTS: Final = frozenset(
    ("M16", "M23", "M28", "M29", "M30", "M32", "M36", "M98", "M117", "M118", "M486", "M928", "M1002")
)


@dataclass(slots=True)
class MarlinLine:
    """What a line says. `name` is the command, as G1, M104, T0 or START_PRINT; empty where it has none.

    `values` has the number of each letter (None for the X of `G28 X`), `places` where it stands, `text` what
    stands behind a command that takes text, or where words end in an M code: at a file name, an address, a bare number,
    a letter for the second time; that begins at `stray`. `settings` has the `NAME=value` of a macro in capitals.
    `code` is all before the comment.
    """

    name: str = ""
    place: ColumnRange = (0, 0)
    values: dict[str, float | None] = field(default_factory=dict)
    places: dict[str, ColumnRange] = field(default_factory=dict)
    text: str = ""
    stray: ColumnRange | None = None
    lists: dict[str, tuple[float, ...]] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)
    is_macro: bool = False
    code: str = ""
    note: str = ""
    number: bool = False
    checksum: tuple[int, int] | None = None

    def get(self, letter: str) -> float | None:
        """The number of a letter; None where it is not there."""
        return self.values.get(letter)

    def has(self, letters: str) -> bool:
        return any(letter in self.values for letter in letters)


def line_of(text: str, *, has_lists: bool = False) -> MarlinLine:
    """Read one line; a Fault where it is no line of such a program. `has_lists`: a letter may have several numbers."""
    line = MarlinLine()
    code, _, line.note = text.partition(";")
    line.code = code
    if found := _CHECKSUM.search(code):
        sent = code[: found.start() + found.group().index("*")]
        line.checksum = (int(found[1]), _checksum(sent))
        code = code[: found.start()]
    at = 0
    if found := _LINE_NUMBER.match(code):
        line.number, at = True, found.end()
    if not code[at:].strip():
        return line
    if found := _COMMAND.match(code, at):
        line.place = (found.start(1), found.end())
        line.name = f"{found[1].upper()}{int(found[2])}" + (f".{int(found[3])}" if found[3] and int(found[3]) else "")
        if line.name in _TEXTS:
            line.text = code[found.end() :].strip()
        else:
            _read_words(code, found.end(), line, has_lists)
        return line
    if found := _NO_TOOL.match(code, at):
        line.place, line.name = (found.start(1), found.end()), "T-1"
        _read_words(code, found.end(), line, has_lists)
        return line
    if found := _MACRO.match(code, at):
        line.name, line.place, line.is_macro = found[1].upper(), found.span(1), True
        rest = code[found.end() :]
        line.settings = {name.upper(): value.strip('"') for name, value in _SETTING.findall(rest)}
        line.text = rest.strip()
        return line
    _read_words(code, at, line, has_lists)
    return line


def _checksum(sent: str) -> int:
    """Exclusive or of all bytes before the asterisk, as senders count it."""
    total = 0
    for byte in sent.encode("utf-8", "replace"):
        total ^= byte
    return total


def _no_word(text: str, letter: str, place: ColumnRange) -> Fault:
    """What ends the words of a line: a letter that was there already, or something that is none."""
    if letter:
        return Fault("GS004", f"the letter {letter.upper()} stands twice in this line", at=place)
    return Fault(
        "GS001", f"`{text}` is no word of a printer's program", at=place, hint="a word is a letter and a number"
    )


def _read_words(code: str, at: int, line: MarlinLine, has_lists: bool) -> None:
    stop = len(code.rstrip())
    while at < stop:
        found = _WORD.match(code, at)
        assert found is not None
        if found[3]:  # a comment in brackets
            closed = code.find(")", at)
            at = stop if closed < 0 else closed + 1
            continue
        letter = (found[1] or "").lower()
        place = (found.start(1), found.end()) if letter else found.span(4)
        if not letter or letter in line.values:
            if line.name[:1] != "M":
                raise _no_word(found[0].strip(), letter, place)
            line.stray, line.text = (place[0], stop), code[place[0] : stop]
            return
        line.values[letter] = None if found[2] is None else float(found[2])
        at = found.end()
        if has_lists and found[2] and (further := _FURTHER.match(code, at)) is not None:
            at = further.end()
            line.lists[letter] = (float(found[2]), *map(float, further[0].split(":")[1:]))
        line.places[letter] = (place[0], at)
