"""`gcodesim check PROGRAM --cell CELL`: limits, reach and time, without material."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.formats import add_verdict_formats
from gcodesim.cli.judging import add_baseline, add_today
from gcodesim.cli.options import add_cell, add_channels, add_fail_on, add_language, add_programs


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "check",
        help="limits, reach, fixtures and time of a program in a cell; no material",
        description="Plan the motion of programs in a cell, each for itself: travel and joint limits, reach, "
        "collisions, time. Nothing is cut and no log is written.",
    )
    add_programs(parser)
    add_cell(parser, required=True)
    add_channels(parser)
    add_language(parser)
    add_verdict_formats(parser)
    add_fail_on(parser)
    add_baseline(parser)
    add_today(parser)
    parser.set_defaults(run=run, prog=parser.prog)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.setups.naming import is_job_file

    if any(map(is_job_file, arguments.programs)):
        from gcodesim.cli.setups import check_job

        return check_job(arguments)
    from gcodesim.cli.simulate import check_programs

    return check_programs(arguments)
