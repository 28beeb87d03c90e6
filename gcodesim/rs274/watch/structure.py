"""Parts of a program that never run: subroutines that nothing calls, lines after the end."""

from __future__ import annotations

from collections.abc import Iterator

from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.outline import bare
from gcodesim.rs274.program_file import ProgramFile

_MOST_READ = 100  # lines after the end that are searched


def structure_findings(file: ProgramFile, end: Span) -> Iterator[Diagnostic]:
    """GS136 and GS137 of a program that ran to its end, which stands at `end`."""
    yield from _unused(file)
    if end.file == file.name and end.line and not end.callers:
        first, count = _unreachable(file, end.line - 1)
        if first is not None:
            text = bare(file.lines[end.line - 1])
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
    for flow, closes in file.outline.unclosed():
        name = f"o{flow.label}" if flow.label.isdigit() else f"o<{flow.label}>"
        yield Diagnostic(
            code="GS130",
            severity=Severity.WARNING,
            message=f"`{flow.keyword}` {name} is never closed: no `{closes}` follows",
            span=Span.of_line(file.name, flow.at + 1, file.lines[flow.at]),
            hint="this run did not come to it; with another condition the control stops here",
        )


# -- subroutines


def _unused(file: ProgramFile) -> Iterator[Diagnostic]:
    defined = list(file.outline.subroutines())
    called = file.outline.called() if defined else set()
    for label, line, name in defined:
        if called is not None and label not in called:
            yield Diagnostic(
                code="GS136",
                message=f"nothing calls the subroutine {name}",
                span=Span.of_line(file.name, line + 1, file.lines[line]),
                hint="call it, or remove it; is the name of a call misspelt?",
            )


# -- lines behind the end


def _unreachable(file: ProgramFile, end: int) -> tuple[int | None, int]:
    """Index of the first line after the end that holds a block and to which nothing leads, and how many there are."""
    if not file.lines:
        return None, 0
    if bare(file.lines[end]).startswith(("/", "%")):
        return None, 0  # a switch decides, or it is the mark after which there is no program
    behind = file.outline.behind(end)
    lines = [index for index in behind if bare(file.lines[index])]
    for at, index in enumerate(lines[:_MOST_READ]):
        if _is_block(file, index):
            return index, len(lines) - at
    return None, 0


def _is_block(file: ProgramFile, index: int) -> bool:
    """Whether the line can be read; some people keep prose after the end, where no control looks."""
    try:
        block = file.block(index)
    except Fault:
        return False
    return bool(block.words or block.settings)
