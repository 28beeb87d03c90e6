"""The program that takes up another at one of its lines, and what is in the way of it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Final

from gcodesim import canon
from gcodesim.canon import Event
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import ToolPath
from gcodesim.restart.approach import approach_of, print_approach
from gcodesim.rs274 import Run, Settings, interpret
from gcodesim.rs274.entry.halted import Halted
from gcodesim.rs274.entry.preamble import preamble
from gcodesim.rs274.entry.remaining import remaining, up_to
from gcodesim.rs274.marlin.halted_print import HaltedPrint
from gcodesim.rs274.marlin.preamble import print_preamble
from gcodesim.rs274.marlin.said import is_said_again

NAME: Final = "restart"
MARK: Final = "(restart at line "
"""How a preamble begins."""

_RAPID: Final = re.compile(r"[Gg]\s*0*0(?![0-9.]).*[XYZxyz]")
_TRIED: Final = 5
_NEAR: Final = 6e-7  # [m]: controls round to micrometres


@frozen(eq=False)
class Restart:
    """The `program` from a line on; None where that cannot be, which is an error among the `findings`."""

    program: SourceText | None
    findings: Sequence[Diagnostic]


def reading_up_to(program: SourceText, line: int, settings: Settings) -> Run:
    """The program, about to be read up to `line`."""
    return interpret(up_to(program, line), replace(settings, until=line))


def restart_of(program: SourceText, line: int, run: Run, path: ToolPath, events: Iterable[Event]) -> Restart:
    """`program` from `line` on, when `run` has read what is before it: moves as `path`, the others as `events`.

    GS148 where nobody can begin there, GS149 for what the lines before have done and no preamble repeats.
    """
    span = Span.of_line(program.name, line, program.line(line))
    halted = run.halted
    if halted is None or run.failed is not None:
        why = "the program never comes to it" if run.failed is None else "the lines before it do not run to their end"
        return Restart(program=None, findings=[_refused(span, line, [why], "")])
    halted = halted.inside(program)
    obstacles = list(halted.obstacles(line))
    if obstacles:
        return Restart(program=None, findings=[_refused(span, line, obstacles, _other_line(program, line, run))])
    events = list(events)
    blocks = _preamble(halted, line, path, events)
    made = remaining(halted.file, line, blocks, f"{NAME}{PurePath(program.name).suffix}")
    wrong = _wrong(made, program, halted, line, run.settings)
    if wrong:
        return Restart(program=None, findings=[_refused(span, line, [wrong], _other_line(program, line, run))])
    return Restart(program=made, findings=[*_left_out(span, events), *_of_print(span, halted, path)])


def _preamble(halted: Halted, line: int, path: ToolPath, events: Sequence[Event]) -> list[str]:
    control = halted.control
    if not isinstance(halted, HaltedPrint):
        return [f"{MARK}{line})", *preamble(control, approach_of(control, path, events))]
    return [f";{MARK}{line})", *print_preamble(control, halted.printer, print_approach(path))]


def _refused(span: Span, line: int, reasons: Sequence[str], hint: str) -> Diagnostic:
    return Diagnostic(
        code="GS148",
        span=span,
        message=f"the program cannot be taken up at line {line}: {'; '.join(reasons)}",
        hint=hint,
    )


def _other_line(program: SourceText, line: int, run: Run) -> str:
    """The hint with the nearest line before, beginning with a rapid, at which it can be."""
    tried = 0
    for other in range(line - 1, 1, -1):
        if not _RAPID.search(program.line(other)):
            continue
        reading = _read(reading_up_to(program, other, run.settings))
        if reading.halted is not None and not any(reading.halted.inside(program).obstacles(other)):
            return f"begin at line {other}: `{program.line(other).strip()[:40]}`"
        tried += 1
        if tried == _TRIED:
            break
    return ""


def _left_out(span: Span, events: Sequence[Event]) -> Iterable[Diagnostic]:
    """GS149 for each word of the cell in the lines before."""
    counts: dict[str, tuple[int, Event]] = {}
    for event in events:
        if isinstance(event, canon.Action):
            word = f"M{event.m}" if event.p is None else f"M{event.m} P{event.p:g}"
            count, first = counts.get(word, (0, event))
            counts[word] = (count + 1, first)
    for word, (count, first) in counts.items():
        yield Diagnostic(
            code="GS149",
            span=first.span,
            message=f"{word} stands before line {span.line} and is not repeated by the preamble",
            hint="bring what it switches into the state that the program expects",
            count=count,
        )


def _of_print(span: Span, halted: Halted, path: ToolPath) -> Iterable[Diagnostic]:
    """GS149 for what was done to the printer before and is not done again."""
    if not isinstance(halted, HaltedPrint):
        return
    if len(path):
        yield Diagnostic(
            code="GS149",
            span=span,
            message="Z is not homed again, since the part is in the way",
            hint="leave the printer switched on, or say `G92 Z` with the nozzle at a height that is known",
        )
    for word, (count, first) in halted.control.not_simulated.items():
        if (word.startswith("macro ") or word[0] == "G") and not is_said_again(word):
            yield Diagnostic(
                code="GS149",
                span=first,
                message=f"{word.removeprefix('macro ')} stands before line {span.line} and is not repeated by the "
                "preamble",
                hint="do by hand what the print needs of it, as heating or a mesh of the bed",
                count=count,
            )


def _wrong(made: SourceText, program: SourceText, halted: Halted, line: int, settings: Settings) -> str:
    """Why the program that was made does not do what the rest of `program` does; empty if it does."""
    alone = replace(settings, until=None, answered=False)
    failed = _read(interpret(made, alone)).failed
    if failed is not None and _read(interpret(program, alone)).failed is None:
        return f"what follows needs what stands before it: {failed.message}"
    again = _read(reading_up_to(made, len(made.lines) - len(program.lines) + line, settings))
    if again.halted is None:
        return "the preamble does not lead to it"
    old, new = halted.control, again.halted.control
    there = zip(old.si_axes(old.tip(old.state.current)), new.si_axes(new.tip(new.state.current)), strict=True)
    if any(abs(a - b) > _NEAR for a, b in there):
        return "the preamble does not lead to the place where the tool is then"
    if old.state.tool != new.state.tool or old.state.spindle != new.state.spindle:
        return "the preamble does not bring tool and spindle into their state"
    if _of_extruder(halted) != _of_extruder(again.halted):
        return "the preamble does not bring the extruder into its state"
    return ""


def _of_extruder(halted: Halted) -> tuple[object, ...]:
    """What moves of filament depend on."""
    if not isinstance(halted, HaltedPrint):
        return ()
    printer = halted.printer
    flow, area = printer.flow.get(printer.tool), printer.areas.get(printer.tool)
    modes = (printer.e_relative, printer.is_retracted, printer.tool, flow, area, printer.limits, printer.section)
    return (round(printer.e, 4), round(printer.speed, 3), *modes)


def _read(run: Run) -> Run:
    for _ in run.stream():
        pass
    return run
