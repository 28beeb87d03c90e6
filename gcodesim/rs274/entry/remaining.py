"""The program from a line on, as a file of its own: a preamble, then the lines as they are."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from gcodesim.diagnostics import SourceText
from gcodesim.rs274.length_words import length_blocks
from gcodesim.rs274.program_file import ProgramFile

_END: Final = "M2"
_CONTOUR: Final = re.compile(r"G7[0-3]\s*P", re.IGNORECASE)
"""A cycle of a lathe that reads lines behind it before it comes to them."""
_LED_TO: Final = re.compile(r"GOTO|^[\s/]*(?:N[\s\d]+)?[O:]\s*[0-9<\[#]", re.IGNORECASE)


def up_to(source: SourceText, line: int) -> SourceText:
    """The program with an end in place of `line`. What is behind it stays only where lines before may lead there.

    Whether a program says lengths at all decides what it means, so those words stay, where nothing executes them; so
    do lines that are comments, in which slicers write settings of the printer.
    """
    before, behind = list(source.lines[: line - 1]), list(source.lines[line:])
    if any(_CONTOUR.search(text) for text in before):
        return _text(source, source.lines, source.name)
    if not any(_LED_TO.search(text) for text in (*before, *behind)):
        notes = [text for text in behind if text.lstrip().startswith(";")]
        behind = [*notes, *length_blocks(source)]
    return _text(source, [*before, _END, *behind], source.name)


def remaining(file: ProgramFile, line: int, blocks: Sequence[str], name: str) -> SourceText:
    """The program of `file` from `line` on, behind the `blocks` of its preamble, called `name`.

    Lines keep their numbers: the preamble takes the place of lines that are left out, and the others are empty. Only
    where there are fewer of them than blocks, what follows moves down. The opening `%`, the number of the program and
    its subroutines stay.
    """
    kept = file.heads_before(line - 1)
    lines = ["" if index < line - 1 and index not in kept else text for index, text in enumerate(file.lines)]
    free = [index for index in range(line - 1) if index not in kept]
    for index, block in zip(free[-len(blocks) :], blocks[-len(free) :] if free else (), strict=False):
        lines[index] = block
    ahead = list(blocks[: max(len(blocks) - len(free), 0)])
    at = free[0] if free else line - 1
    return _text(file.source, [*lines[:at], *ahead, *lines[at:]], name)


def _text(source: SourceText, lines: Sequence[str], name: str) -> SourceText:
    end = "\r\n" if b"\r\n" in source.raw else "\n"
    return SourceText(name, "".join(f"{text}{end}" for text in lines).encode(source.encoding), source.folder)
