"""`gcodesim lint PROGRAM...`: every fault of programs, without a cell."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import FINDINGS
from gcodesim.cli.formats import add_verdict_formats
from gcodesim.cli.judging import Met, add_baseline, add_today, print_findings_of, settle
from gcodesim.cli.options import add_cell, add_fail_on, add_language, add_programs

if TYPE_CHECKING:
    from gcodesim.cli.language import ProgramReading


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "lint",
        help="find what is wrong with a program, without a cell",
        description="Report every fault of programs that shows without a machine. With --cell the tools, work offsets "
        "and M-codes of the cell are known.",
    )
    add_programs(parser)
    add_cell(parser, required=False)
    add_language(parser)
    add_verdict_formats(parser)
    add_fail_on(parser)
    add_baseline(parser)
    add_today(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    read = [_read(arguments, path) for path in arguments.programs]
    met = [_met(arguments, path, one) for path, one in zip(arguments.programs, read, strict=True)]
    settled = settle(met, arguments)
    print_findings_of(settled, arguments)
    return FINDINGS if any(reading.run is None for reading in read) else settled.status


def _read(arguments: argparse.Namespace, path: Path) -> ProgramReading:
    from gcodesim.cli.language import reading_of

    reading = reading_of(arguments, path)
    if reading.run is not None:
        for _ in reading.run.stream():
            pass
        reading.sources |= reading.run.sources
    return reading


def _met(arguments: argparse.Namespace, path: Path, reading: ProgramReading) -> Met:
    from gcodesim.cli.language import files_of

    return Met(
        program=path,
        cell=arguments.cell,
        findings=reading.findings(arguments.today),
        suppressed=reading.suppressed(arguments.today),
        sources=reading.sources,
        files=lambda: files_of(arguments, path, reading.sources, reading.folders, reading.loaded),
    )
