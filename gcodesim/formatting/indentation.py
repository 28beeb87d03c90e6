"""How deep the lines of a program stand in subroutines, branches and loops of O-words."""

from __future__ import annotations

from typing import Final

from gcodesim.rs274.program_file import FlowLine, ProgramFile

_OPENS: Final = frozenset(("sub", "if", "repeat", "do"))
_CLOSES: Final = {"endsub": "sub", "endif": "if", "endrepeat": "repeat", "endwhile": "while"}
_BETWEEN: Final = frozenset(("else", "elseif"))


def depths_of(file: ProgramFile) -> list[int]:
    """For each line, in how many of them it stands; 0 everywhere where they do not nest."""
    flows = {flow.at: flow for flow in file.flows}
    open_ones: list[tuple[str, str]] = []  # keyword and label
    depths = []
    for index in range(len(file.lines)):
        depth = len(open_ones)
        flow = flows.get(index)
        if flow is not None:
            steps_out = flow.keyword in _BETWEEN or _closed_by(flow, open_ones) is not None
            if not _take(flow, open_ones):
                return [0] * len(file.lines)
            depth -= steps_out
        depths.append(depth)
    return depths if not open_ones else [0] * len(file.lines)


def _closed_by(flow: FlowLine, open_ones: list[tuple[str, str]]) -> tuple[str, str] | None:
    """What a line closes: a `while` closes a `do`."""
    if flow.keyword == "while":
        return ("do", flow.label) if open_ones[-1:] == [("do", flow.label)] else None
    opened = _CLOSES.get(flow.keyword)
    return None if opened is None else (opened, flow.label)


def _take(flow: FlowLine, open_ones: list[tuple[str, str]]) -> bool:
    """Open or close what the line does; false where it closes something else than was opened last."""
    closed = _closed_by(flow, open_ones)
    if closed is not None:
        return bool(open_ones) and open_ones.pop() == closed
    if flow.keyword in _OPENS or flow.keyword == "while":
        open_ones.append((flow.keyword, flow.label))
    return True
