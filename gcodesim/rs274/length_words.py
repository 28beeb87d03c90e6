"""Whether a program mentions tool lengths at all, since its meaning depends on that."""

from __future__ import annotations

import re

from gcodesim.diagnostics import SourceText

# one search per letter: with a literal first byte a search skips everything else quickly
_WORDS = [re.compile(letter + rb"[ \t]*0*4[ \t]*[39]") for letter in (b"G", b"g")]
_NOTE = re.compile(rb"\([^)]*\)?|;.*")


def length_words(source: SourceText) -> set[bytes]:
    """Last digits of the words about tool length in the program: 3 for G43 and its relatives, 9 for G49."""
    raw = source.raw
    said: set[bytes] = set()
    for word in _WORDS:
        for found in word.finditer(raw):
            begin = max(raw.rfind(b"\n", 0, found.start()), raw.rfind(b"\r", 0, found.start())) + 1
            if word.search(_NOTE.sub(b"", raw[begin : found.end()])):
                said.add(found.group()[-1:])
                if b"3" in said:
                    return said
    return said
