"""`run --from-line`: what goes before the run of the rest, and what is said when there is none."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from gcodesim.cli.exits import UsageError
from gcodesim.cli.formats import write_formats
from gcodesim.cli.judging import Met, settle
from gcodesim.cli.language import files_of, said_of_reading
from gcodesim.cli.output import findings_as_json, note, print_count, print_findings, print_json
from gcodesim.diagnostics import SourceText
from gcodesim.jobs.job import Options
from gcodesim.restart.before import TakenUp, take_up

if TYPE_CHECKING:
    from gcodesim.cell import LoadedCell
    from gcodesim.executor import Progress


def taken_up(
    arguments: argparse.Namespace,
    program: SourceText,
    loaded: LoadedCell,
    options: Options,
    progress: Callable[[Progress], None],
) -> TakenUp:
    """The rest of the program with the stock that is there then; UsageError where the program has no such line."""
    line = arguments.from_line
    if line > len(program.lines):
        raise UsageError(f"--from-line {line}: {arguments.program} has {len(program.lines)} lines")
    taken = take_up(program, loaded, line, options, arguments.out, said=said_of_reading(arguments), progress=progress)
    if taken.program is not None:
        how = "are known from an earlier run" if taken.was_known else "were run for the shape of the stock"
        note(f"lines 1 to {line - 1} {how}; {arguments.out / taken.program.name} takes the program up")
    return taken


def tell_refusal(arguments: argparse.Namespace, taken: TakenUp) -> int:
    """Print why nothing was run from that line; the exit status."""
    met = Met(
        program=arguments.program,
        findings=taken.findings,
        sources=taken.sources,
        files=lambda: files_of(arguments, arguments.program, taken.sources, (), None),
    )
    settled = settle([met], arguments)
    if arguments.format == "json":
        print_json({"findings": findings_as_json(taken.findings)})
    elif arguments.format == "text":
        print_findings(settled.shown[0].findings, met.sources)
        print_count(settled.shown[0].name, settled.shown[0].findings)
    write_formats(settled.verdict, arguments)
    return settled.status
