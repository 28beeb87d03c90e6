"""What of a program never runs: subroutines that nothing calls, lines behind the end."""

from __future__ import annotations

import re
from collections.abc import Iterator

from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.rs274.fanuc.names import called_name, number_of_name
from gcodesim.rs274.fanuc.program import FanucFile
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.program_file import FlowLine, ProgramFile

_NOTE = re.compile(r"\([^)]*\)?|;.*")
_OPENS, _CLOSES = frozenset(("if", "repeat", "do")), frozenset(("endif", "endrepeat", "endwhile"))
_CALLS = re.compile(r"(?:M\s*0*98|G\s*0*6[56](?:\s*\.\s*1)?)(?![0-9.])", re.IGNORECASE)
_NUMBER = re.compile(r"P\s*(?:([0-9]{1,15})|[#\[<])", re.IGNORECASE)
_RETURNS = re.compile(r"M\s*0*99(?![0-9])", re.IGNORECASE)
_TARGET = re.compile(r"(?:GOTO|M\s*0*99\s*P)\s*(?:([0-9]{1,15})|[#\[])", re.IGNORECASE)
_SEQUENCE = re.compile(r"\s*+(?:/\s*+)?N\s*0*([0-9]{1,15})(?![0-9])", re.IGNORECASE)
_CLOSED_BY = {"if": "endif", "while": "endwhile", "repeat": "endrepeat", "do": "while"}
_MOST_READ = 100  # lines behind the end that are looked at
_LOOP = re.compile(r"(DO|END)\s*[0-9]", re.IGNORECASE)


def structure_findings(file: ProgramFile, end: Span) -> Iterator[Diagnostic]:
    """GS136 and GS137 of a program that ran to its end, which stands at `end`."""
    yield from _unused(file)
    if end.file == file.name and end.line and not end.callers:
        first, count = _unreachable(file, end.line - 1)
        if first is not None:
            text = _bare(file.lines[end.line - 1])
            yield Diagnostic(
                code="GS137",
                message=f"{count} line{'s' if count > 1 else ''} from here never run{'' if count > 1 else 's'}: "
                f"the program ends in line {end.line} (`{text[:20]}`)",
                span=Span.of_line(file.name, first + 1, file.lines[first]),
                hint="move the end behind them, or remove them",
                related=end,
                count=1,
            )


def unclosed_findings(file: ProgramFile) -> Iterator[Diagnostic]:
    """GS130 as a warning: an O-word that opens and is never closed, in a program that ends before a control looks."""
    if isinstance(file, FanucFile):
        return  # a DO without END is a fault where it stands
    doing: list[str] = []
    for flow in file.flows:
        if flow.keyword == "do":
            doing.append(flow.label)
        if flow.keyword == "while" and flow.label in doing:
            doing.remove(flow.label)
            continue
        closes = _CLOSED_BY.get(flow.keyword)
        if closes is None or not flow.label or file.find_flow(flow.at, flow.label, frozenset((closes,))) is not None:
            continue
        name = f"o{flow.label}" if flow.label.isdigit() else f"o<{flow.label}>"
        yield Diagnostic(
            code="GS130",
            severity=Severity.WARNING,
            message=f"`{flow.keyword}` {name} is never closed: no `{closes}` follows",
            span=Span.of_line(file.name, flow.at + 1, file.lines[flow.at]),
            hint="this run did not come to it; with another condition the control stops here",
        )


def _bare(line: str) -> str:
    return _NOTE.sub("", line).strip()


# -- subroutines


def _unused(file: ProgramFile) -> Iterator[Diagnostic]:
    defined = list(_defined(file))
    called = _called(file) if defined else set()
    for label, line, name in defined:
        if called is not None and label not in called:
            yield Diagnostic(
                code="GS136",
                message=f"nothing calls the subroutine {name}",
                span=Span.of_line(file.name, line + 1, file.lines[line]),
                hint="call it, or remove it; is the name of a call misspelt?",
            )


def _defined(file: ProgramFile) -> Iterator[tuple[str, int, str]]:
    """Label, line and name of each subroutine; the one that the file is named after serves other programs."""
    if isinstance(file, FanucFile):
        for part in file.parts[1:]:
            lines = file.lines[part.first : part.end]
            if part.number is not None and any(_RETURNS.search(_bare(line)) for line in lines):
                name = file.names.get(part.number)
                yield str(part.number), part.first, f"O{part.number}" if name is None else f"<{name}>"
        return
    own = file.name.rpartition(".")[0].lower()
    for flow in file.flows:
        if flow.keyword == "sub" and flow.label not in ("", own):
            yield flow.label, flow.at, f"o{flow.label}" if flow.label.isdigit() else f"o<{flow.label}>"


def _called(file: ProgramFile) -> set[str] | None:
    """All labels that a line calls; None when one is computed, so that nobody knows."""
    if not isinstance(file, FanucFile):
        labels = {flow.label for flow in file.flows if flow.keyword == "call"}
        return None if "" in labels else labels
    numbers: set[str] = set()
    for line in file.lines:
        text = _bare(line)
        if not _CALLS.search(text):
            continue
        if (named := called_name(text)) is not None:
            numbers.add(str(number_of_name(named[0])))
            continue
        for match in _NUMBER.finditer(text):
            if match[1] is None:
                return None
            # in the old form P holds the repeats before the last four digits
            numbers |= {str(int(match[1])), str(int(match[1][-4:]))}
    return numbers


# -- lines behind the end


def _unreachable(file: ProgramFile, end: int) -> tuple[int | None, int]:
    """Index of the first line behind the end that holds a block and that nothing leads to, and how many there are."""
    if not file.lines:
        return None, 0
    if _bare(file.lines[end]).startswith(("/", "%")):
        return None, 0  # a switch decides, or the mark behind which there is no program
    behind = _behind_fanuc(file, end) if isinstance(file, FanucFile) else _behind(file, end)
    lines = [index for index in behind if _bare(file.lines[index])]
    for at, index in enumerate(lines[:_MOST_READ]):
        if _is_block(file, index):
            return index, len(lines) - at
    return None, 0


def _is_block(file: ProgramFile, index: int) -> bool:
    """Whether the line can be read; some keep prose behind the end, where no control looks."""
    try:
        block = file.block(index)
    except Fault:
        return False
    return bool(block.words or block.settings)


def _behind(file: ProgramFile, end: int) -> Iterator[int]:
    if _depth(file.flows, end) > 0:
        return
    at: dict[int, FlowLine] = {flow.at: flow for flow in file.flows}
    inside = ""  # the subroutine whose lines go by
    for index in range(end + 1, len(file.lines)):
        if file.lines[index].strip() == "%":
            return
        flow = at.get(index)
        if inside:
            left = flow is not None and flow.keyword == "endsub" and flow.label == inside
            inside = "" if left or (inside == "O" and _RETURNS.search(_bare(file.lines[index]))) else inside
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


def _behind_fanuc(file: FanucFile, end: int) -> Iterator[int]:
    part = file.part_at(end)
    targets = set()
    loops = 0
    for index in range(part.first, part.end):
        text = _bare(file.lines[index])
        for match in _TARGET.finditer(text):
            if match[1] is None:
                return
            targets.add(int(match[1]))
        if index <= end:
            loops += sum(1 if word.upper() == "DO" else -1 for word in _LOOP.findall(text))
    if loops > 0:
        return
    for index in range(end + 1, part.end):
        sequence = _SEQUENCE.match(file.lines[index])
        if sequence is not None and int(sequence[1]) in targets:
            return
        yield index
