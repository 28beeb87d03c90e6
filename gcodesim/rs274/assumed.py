"""Tools that a program is assumed to have where nothing says which ones there are."""

from __future__ import annotations

import re
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.tool_table import ToolEntry, ToolTable

# one search per letter: with a literal first byte a search skips everything else quickly
_TOOL_WORDS: Final = [
    re.compile(letter + rb"[ \t]*0*([0-9]{1,5})(?![0-9.])") for letter in (b"T", b"H", b"D", b"t", b"h", b"d")
]
_USUAL_TOOLS: Final = range(1, 100)


def assumed_tools(program: SourceText) -> ToolTable:
    """A table with every tool that the program may name.

    A program alone says nothing about the tools in the machine, so a missing one is not a fault of the program.
    """
    named = (int(number) for word in _TOOL_WORDS for number in word.findall(program.raw))
    numbers = {*_USUAL_TOOLS, *named}
    return ToolTable({number: ToolEntry(number=number, pocket=number) for number in sorted(numbers)})
