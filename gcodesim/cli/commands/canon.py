"""`gcodesim canon PROGRAM`: the canonical events of a program, as text or JSON; no physics."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK
from gcodesim.cli.options import add_cell, add_format, add_language, add_parameter_output, add_program
from gcodesim.diagnostics import Severity
from gcodesim.diagnostics.plain import one_line


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "canon",
        help="print the canonical events of a program",
        description="Print what the program tells the machine, event by event: moves in machine coordinates, spindle, "
        "tool changes. No physics. A cell gives its tools, work offsets and M-codes.",
    )
    add_program(parser)
    add_cell(parser, required=False)
    add_language(parser)
    add_parameter_output(parser)
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    import gcodesim.canon.listing as listing
    from gcodesim.cli.language import reading_of, write_parameters
    from gcodesim.cli.output import findings_as_json, note, print_findings, print_json

    reading = reading_of(arguments, arguments.program)
    run, as_json = reading.run, arguments.format == "json"
    if run is None:
        if as_json:
            failed = next(f for f in reading.before if f.level >= Severity.ERROR)
            error = (failed.message, failed.span.line)
            print_json({**listing.listing([], error), "findings": findings_as_json(reading.findings())})
        else:
            print_findings(reading.findings(), reading.sources)
        return FINDINGS
    if as_json:
        events = list(run)
        line = run.failed.span.line if run.failed and run.failed_line is None else run.failed_line
        printed = listing.listing(events, (run.failed.message, line) if run.failed else None)
        print_json({**printed, "findings": findings_as_json(reading.findings())})
        write_parameters(run, arguments)
        return FINDINGS if run.failed else OK
    for event in run:
        print(listing.as_text(event))
    others = len(reading.findings())
    if run.failed:
        print_findings([run.failed], run.sources)
        span = run.failed.span
        file = one_line(span.file)
        note(f"stopped at {file}:{span.line}" if span.line else f"stopped at the end of {file}")
        others -= 1
    if others > 0:
        note(f"{others} {'more ' if run.failed else ''}finding{'s' if others > 1 else ''}: `gcodesim lint` shows all")
    write_parameters(run, arguments)
    return FINDINGS if run.failed else OK
