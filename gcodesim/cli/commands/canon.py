"""`gcodesim canon PROGRAM`: the canonical events of a program, as text or JSON; no physics."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK
from gcodesim.cli.options import add_cell, add_format, add_language, add_program, read_source


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
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    import gcodesim.canon.listing as listing
    from gcodesim.cli.language import settings_of
    from gcodesim.cli.output import note, print_findings, print_json
    from gcodesim.rs274 import interpret

    program = read_source(arguments.program, "program")
    settings = settings_of(arguments)
    if settings is None:
        return FINDINGS
    reading = interpret(program, settings)
    if arguments.format == "json":
        events = list(reading)
        failed = reading.failed
        line = failed.span.line if failed and reading.failed_line is None else reading.failed_line
        print_json(listing.listing(events, (failed.message, line) if failed else None))
        return FINDINGS if failed else OK
    for event in reading:
        print(listing.as_text(event))
    if reading.failed:
        print_findings([reading.failed], reading.sources)
        note(f"stopped at {reading.failed.span.file}:{reading.failed.span.line}")
    return FINDINGS if reading.failed else OK
