"""`gcodesim lint PROGRAM`: every fault of a program, without a cell."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

from gcodesim.cli.exits import FINDINGS, status_of
from gcodesim.cli.options import add_cell, add_fail_on, add_format, add_language, add_program, read_source


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
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.language import settings_of
    from gcodesim.cli.output import findings_as_json, print_findings, print_json, verdict
    from gcodesim.rs274 import interpret
    from gcodesim.rs274.assumed import assumed_tools

    program = read_source(arguments.program, "program")
    settings = settings_of(arguments)
    if settings is None:
        return FINDINGS
    if arguments.cell is None and arguments.tools is None:
        settings = replace(settings, tool_table=assumed_tools(program))
    reading = interpret(program, settings)
    for _ in reading.stream():
        pass
    findings = reading.findings
    if arguments.format == "json":
        print_json({"findings": findings_as_json(findings)})
    else:
        print_findings(findings, reading.sources)
        print(f"{program.name}: {verdict(findings)}")
    return status_of(findings, arguments.fail_on)
