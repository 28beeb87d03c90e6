"""`gcodesim lint PROGRAM`: every fault of a program, without a cell."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.exits import FINDINGS
from gcodesim.cli.judging import add_baseline, add_today, settle
from gcodesim.cli.options import add_cell, add_fail_on, add_format, add_language, add_program


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "lint",
        help="find what is wrong with a program, without a cell",
        description="Report every fault of a program that shows without a machine. With --cell the tools, work offsets "
        "and M-codes of the cell are known.",
    )
    add_program(parser)
    add_cell(parser, required=False)
    add_language(parser)
    add_format(parser)
    add_fail_on(parser)
    add_baseline(parser)
    add_today(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.language import reading_of
    from gcodesim.cli.output import findings_as_json, print_findings, print_json, verdict

    reading = reading_of(arguments)
    if reading.run is not None:
        for _ in reading.run.stream():
            pass
        reading.sources |= reading.run.sources
    findings = reading.findings(arguments.today)
    settled = settle(findings, arguments, reading.sources)
    if arguments.format == "json":
        print_json({"findings": findings_as_json(findings)})
    else:
        print_findings(settled.shown, reading.sources)
        for remark in settled.remarks:
            print(remark)
        print(f"{reading.program.name}: {verdict(settled.shown)}")
    return FINDINGS if reading.run is None else settled.status
