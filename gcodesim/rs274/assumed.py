"""Tools that a program may be taken to have where nothing says which ones there are."""

from __future__ import annotations

import re
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.tool_table import ToolEntry, ToolTable

_TOOL_WORD: Final = re.compile(r"[THD][ \t]*0*([0-9]{1,5})(?![0-9.])", re.IGNORECASE | re.ASCII)
_USUAL_TOOLS: Final = range(1, 100)


def assumed_tools(program: SourceText) -> ToolTable:
    """A table with every tool that the program may name.

    A program alone says nothing of the tools in the machine, so a missing one is no fault of the program.
    """
    numbers = {*_USUAL_TOOLS, *(int(number) for number in _TOOL_WORD.findall(program.text))}
    return ToolTable({number: ToolEntry(number=number, pocket=number) for number in sorted(numbers)})
