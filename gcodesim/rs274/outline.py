"""What stands where in a program: its subroutines, what calls them, and what no block leads to."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gcodesim.rs274.program_file import FlowLine, ProgramFile

_NOTE = re.compile(r"\([^)]*\)?|;.*")
RETURNS = re.compile(r"M\s*0*99(?![0-9])", re.IGNORECASE)
_OPENS, _CLOSES = frozenset(("if", "repeat", "do")), frozenset(("endif", "endrepeat", "endwhile"))
_BEGINS, _ENDS = _OPENS | {"while", "sub"}, _CLOSES | {"endsub"}
_CLOSED_BY = {"if": "endif", "while": "endwhile", "repeat": "endrepeat", "do": "while"}


def bare(line: str) -> str:
    """A line without its comments."""
    return _NOTE.sub("", line).strip()


class Outline:
    """The structure that O-words give a file."""

    def __init__(self, file: ProgramFile) -> None:
        self.file = file

    def subroutines(self) -> Iterator[tuple[str, int, str]]:
        """Label, line and name of each subroutine; the one that the file is named after serves other programs."""
        own = self.file.name.rpartition(".")[0].lower()
        for flow in self.file.flows:
            if flow.keyword == "sub" and flow.label not in ("", own):
                yield flow.label, flow.at, f"o{flow.label}" if flow.label.isdigit() else f"o<{flow.label}>"

    def called(self) -> set[str] | None:
        """All labels that a line calls; None when one is computed, so that nobody knows."""
        labels = {flow.label for flow in self.file.flows if flow.keyword == "call"}
        return None if "" in labels else labels

    def unclosed(self) -> Iterator[tuple[FlowLine, str]]:
        """O-words that open something and are never closed, each with the word that is missing."""
        doing: list[str] = []
        for flow in self.file.flows:
            if flow.keyword == "do":
                doing.append(flow.label)
            if flow.keyword == "while" and flow.label in doing:
                doing.remove(flow.label)
                continue
            closes = _CLOSED_BY.get(flow.keyword)
            if closes is None or not flow.label:
                continue
            if self.file.find_flow(flow.at, flow.label, frozenset((closes,))) is None:
                yield flow, closes

    def open_at(self, end: int) -> list[FlowLine]:
        """The subroutine, branches and loops that line `end` is inside of, the outermost first."""
        found: list[FlowLine] = []
        for flow in self.file.flows:
            if flow.at >= end:
                break
            if flow.keyword in _ENDS:
                while found and found.pop().label != flow.label:
                    pass
            elif flow.keyword == "while" and found and (found[-1].keyword, found[-1].label) == ("do", flow.label):
                found.pop()
            elif flow.keyword in _BEGINS:
                found.append(flow)
        return found

    def behind(self, end: int) -> Iterator[int]:
        """Indices of the lines behind line `end` that nothing leads to."""
        if _depth(self.file.flows, end) > 0:
            return
        at: dict[int, FlowLine] = {flow.at: flow for flow in self.file.flows}
        inside = ""  # the subroutine whose lines go by
        for index in range(end + 1, len(self.file.lines)):
            if self.file.lines[index].strip() == "%":
                return
            flow = at.get(index)
            if inside:
                left = flow is not None and flow.keyword == "endsub" and flow.label == inside
                inside = "" if left or (inside == "O" and RETURNS.search(bare(self.file.lines[index]))) else inside
            elif flow is not None and flow.keyword in ("sub", ""):
                inside = flow.label if flow.keyword else "O"
            else:
                yield index


def _depth(flows: list[FlowLine], end: int) -> int:
    """How many branches and loops are open at line `end`."""
    depth = 0
    doing: list[str] = []
    for flow in flows:
        if flow.at > end:
            break
        if flow.keyword == "do":
            doing.append(flow.label)
        if flow.keyword == "while":
            closes = flow.label in doing
            depth += -1 if closes else 1
            if closes:
                doing.remove(flow.label)
        depth += (flow.keyword in _OPENS) - (flow.keyword in _CLOSES)
    return depth
