"""New N numbers, and the jumps that follow them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.formatting.style import MOST_NUMBER
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import Jump, ProgramFile


@dataclass
class Numbering:
    """What N numbers become: `texts` by line and index of the token; `problems` where that cannot be."""

    texts: dict[int, dict[int, str]] = field(default_factory=lambda: defaultdict(dict))
    problems: list[Diagnostic] = field(default_factory=list)


def renumbered(file: ProgramFile, step: int) -> Numbering:
    """Blocks that have an N get new ones: `step`, twice `step` and so on, from the top in each program of the file."""
    numbering = Numbering()
    new: dict[int, int] = {}  # by line
    for part in file.numbered:
        lines = [(index, at) for index in part if (at := _place(file, index)) is not None]
        if len(lines) * step > MOST_NUMBER:
            message = (
                f"{len(lines)} blocks in steps of {step} end above N{MOST_NUMBER}, the last that all controls take"
            )
            numbering.problems.append(_problem(file, lines[0][0], message, "take a smaller step"))
            return numbering
        for count, (index, at) in enumerate(lines, 1):
            new[index] = count * step
            is_whole = file.tokens(index)[at].kind == "LINE_NUMBER"
            numbering.texts[index][at if is_whole else at + 1] = f"{'N' * is_whole}{new[index]}"
    for index in range(len(file.lines)):
        for jump in _jumps(file, index):
            _follow(file, index, jump, new, numbering)
    return numbering


def _place(file: ProgramFile, index: int) -> int | None:
    """The index of the token that numbers a line."""
    if file.lines[index].lstrip()[:1] not in ("N", "n", "/", "("):
        return None
    try:
        tokens = file.tokens(index)
    except Fault:
        return None
    for at, token in enumerate(tokens):
        if token.kind == "LINE_NUMBER" or (token.kind, token.text) == ("LETTER", "n"):
            return at
        if token.kind not in ("SKIP", "SLASH", "NOTE"):
            return None
    return None


def _jumps(file: ProgramFile, index: int) -> list[Jump]:
    try:
        return file.jumps(index)
    except Fault:
        return []


def _follow(file: ProgramFile, index: int, jump: Jump, new: dict[int, int], numbering: Numbering) -> None:
    """Lead a jump to the new number of its block."""
    if jump.at is None:
        message = "where this leads is computed, so that it cannot follow new N numbers"
        numbering.problems.append(_problem(file, index, message, "leave out --renumber"))
        return
    targets = {new.get(line) for line in jump.lines}
    number = targets.pop() if len(targets) == 1 else None
    if number is None:
        message = f"N{file.tokens(index)[jump.at].text}, to which this leads, is not one block of this file"
        numbering.problems.append(_problem(file, index, message, "leave out --renumber, or number it by hand"))
    else:
        numbering.texts[index][jump.at] = str(number)


def _problem(file: ProgramFile, index: int, message: str, hint: str) -> Diagnostic:
    span = Span.of_line(file.name, index + 1, file.lines[index])
    return Diagnostic(code="GS022", message=message, span=span, hint=hint)
