"""Programs that were written for another kind of machine or control, recognised by words that no mill uses."""

from __future__ import annotations

import re
from typing import Final, Literal

from gcodesim.diagnostics import SourceText
from gcodesim.frozen import frozen
from gcodesim.rs274.dialects import Lathe

ForeignKind = Literal["printer", "Klartext", "Okuma", "Sinumerik", "script", "lathe"]

_HEAD: Final = 120_000  # bytes that are searched: posts and people say at the beginning what a program is for
_NOTES = re.compile(rb"\([^)\r\n]*\)?|;[^\r\n]*")
_LINE_END = re.compile(rb"\r\n|\n|\r")

# a code G50 or M104: no letter or digit before it, no digit behind it; `[ \t]` since a word does not go over lines
_KLARTEXT = re.compile(
    rb"^[ \t]*[0-9]{1,6}[ \t]+((?:BEGIN|END) PGM\b|BLK FORM\b|TOOL CALL\b|L[ \t]+[XYZ][+-])", re.MULTILINE
)
_SINUMERIK = re.compile(
    rb"(?:^|(?<=[ \t]))(CYCLE[0-9]+[ \t]*\(|POCKET[0-9][ \t]*\(|WORKPIECE[ \t]*\(|[TD][ \t]?=|[XYZ][ \t]?=[ \t]?[A-Z(]"
    rb"|R[0-9]+[ \t]?=)",
    re.MULTILINE,
)
_NO_BLOCK = re.compile(rb"[:<>|,\[\]{}]|[A-Z]{4}")
# returns and calls, work systems by G15 H1, common and system variables, jumps to names, home positions of OSP
_OKUMA = re.compile(
    rb"(?:^|(?<=[ \t]))(RTS(?![A-Z0-9])|(?:CALL|MODIN)[ \t]+O[A-Z0-9]+|MODOUT(?![A-Z0-9])"
    rb"|G1[56][ \t]*H[ \t]*=?[ \t]*[0-9]+|V(?:C[0-9]+|[A-Z]{3,5})(?:[ \t]*\[[A-Z0-9]+\])?[ \t]*="
    rb"|HP[ \t]*=|IF[ \t]*\[[^\[\]\r\n]*\][ \t]*N[A-Z0-9]+)",
    re.MULTILINE,
)
_SCRIPT = re.compile(
    rb"^[ \t]*((?:VAR|LET|CONST)[ \t]+[A-Z_$][A-Z0-9_$]*[ \t]*=|FUNCTION[ \t]+[A-Z_$][A-Z0-9_$]*[ \t]*\("
    rb"|(?:TOOL|FEED|SPEED|I?RAPID|I?CUT|ARC|UNITS|REQUIRE|WORKPIECE)[ \t]*\([^\r\n]*\)[ \t]*;)",
    re.MULTILINE,
)
_HEATER = re.compile(rb"(?<![A-Z0-9])M0?(82|83|104|106|107|109|140|190)(?![0-9])")
_CUTTER = re.compile(rb"(?<![A-Z0-9])M0?[346](?![0-9])")
_FILAMENT = re.compile(rb"(?<![A-Z0-9])G0?[01](?![0-9.])[^\r\n]{0,80}?(?<![A-Z])E[ \t]?-?[0-9.]")
_Y_WORD = re.compile(rb"[yY][ \t]*[-+]?[ \t]*[0-9.#\[]")
_TOOL_CHANGE = re.compile(rb"[mM][ \t]*0*6(?![0-9])")


@frozen
class Foreign:
    """What gave the kind away: `word`, in `line` (from 1) at `column` (from 1)."""

    kind: ForeignKind
    word: str
    line: int
    column: int


def foreign_of(source: SourceText) -> Foreign | None:
    """The kind of control that there is no dialect for: a 3D printer's, Heidenhain's, Okuma's, Siemens', a script's."""
    head = source.raw[:_HEAD].upper()
    if match := _KLARTEXT.search(head):
        return _found("Klartext", match, head)
    if match := _SCRIPT.search(head):
        return _found("script", match, head)
    words = _without_notes(head)
    if match := _OKUMA.search(words):  # it has `T=` and `Z=` as well
        return _found("Okuma", match, words)
    for match in _SINUMERIK.finditer(words):
        if not _is_in_a_log(match, words):
            return _found("Sinumerik", match, words)
    heaters = {match[1] for match in _HEATER.finditer(words)}
    if not heaters:
        return None
    if _FILAMENT.search(words) is None and (len(heaters) == 1 or _CUTTER.search(words)):
        return None
    first = _HEATER.search(words)
    assert first is not None
    return _found("printer", first, words, group=0)


def lathe_of(source: SourceText, lathe: Lathe | None) -> Foreign | None:
    """What shows that a program is one for `lathe`: its codes, in a program that never names Y."""
    if lathe is None:
        return None
    words = _without_notes(source.raw[:_HEAD].upper())
    match = lathe.words.search(words)
    if match is None:
        return None
    everything = words if len(source.raw) <= _HEAD else _NOTES.sub(b"", source.raw)
    if _Y_WORD.search(everything) or (not lathe.changes_by_m6 and _TOOL_CHANGE.search(everything)):
        return None
    return _found("lathe", match, words)


def _without_notes(text: bytes) -> bytes:
    """The text with blanks in place of comments, so that places stay."""
    return _NOTES.sub(lambda note: b" " * len(note.group()), text)


def _is_in_a_log(match: re.Match[bytes], text: bytes) -> bool:
    """Whether `T=` or `D=` stands in a line that is no block: what a sender keeps of what it sent and heard."""
    if match[1][:1] not in (b"T", b"D"):
        return False
    begin = max(text.rfind(b"\n", 0, match.start()), text.rfind(b"\r", 0, match.start())) + 1
    return _NO_BLOCK.search(text[begin : match.start()]) is not None


def _found(kind: ForeignKind, match: re.Match[bytes], text: bytes, group: int = 1) -> Foreign:
    at = match.start(group)
    ends = [end.end() for end in _LINE_END.finditer(text, 0, at)]
    line = text[ends[-1] if ends else 0 : at].decode("utf-8", "replace")
    word = match.group(group).decode("ascii")
    return Foreign(kind=kind, word=word, line=len(ends) + 1, column=len(line) + 1)
