"""Whether a program mentions tool lengths at all, since its meaning depends on that."""

from __future__ import annotations

import re

from gcodesim.diagnostics import SourceText

# one search per letter: with a literal first byte a search skips everything else quickly
_WORDS = [re.compile(letter + rb"[ \t]*0*4[ \t]*[39]") for letter in (b"G", b"g")]
_NOTE = re.compile(rb"\([^)]*\)?|;.*")
_LINE_END = re.compile(rb"[\r\n]|\Z")
_H0 = re.compile(rb"[Hh][ \t]*0+(?![0-9.])")


def length_blocks(source: SourceText) -> list[str]:
    """Blocks that say as much of tool lengths as the program does, on any control."""
    said = length_words(source, h0_cancels=True)
    blocks = [f"G4{digit.decode()}" for digit in sorted(said)]
    if said <= {b"9"} < length_words(source, h0_cancels=False) | {b"9"}:
        blocks.append("G43 H0")
    return blocks


def length_words(source: SourceText, *, h0_cancels: bool) -> set[bytes]:
    """Last digits of the words about tool length in the program: 3 for G43 and its relatives, 9 for G49.

    `h0_cancels`: on this control G43 H0 says no length, and is as good as G49.
    """
    raw = source.raw
    said: set[bytes] = set()
    for word in _WORDS:
        for found in word.finditer(raw):
            begin = max(raw.rfind(b"\n", 0, found.start()), raw.rfind(b"\r", 0, found.start())) + 1
            if word.search(_NOTE.sub(b"", raw[begin : found.end()])):
                end = next(_LINE_END.finditer(raw, found.end())).start()
                takes_away = h0_cancels and _H0.search(_NOTE.sub(b"", raw[begin:end]))
                said.add(b"9" if takes_away else found.group()[-1:])
                if b"3" in said:
                    return said
    return said
