"""`gcodesim run PROGRAM --cell CELL`: simulate, write log and results, print the verdict."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.formats import add_verdict_formats
from gcodesim.cli.judging import add_baseline, add_today
from gcodesim.cli.options import (
    add_cell,
    add_channels,
    add_fail_on,
    add_from_line,
    add_language,
    add_parameter_output,
    add_program,
)

PORT = 8765
"""Where viewers look first."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "run",
        help="simulate a program in a cell: material, forces, log, results",
        description="Simulate a program in a cell. Prints findings and a summary; writes run.mcap (the log), "
        "results.json, lines.csv and the shape of each stock. A YAML file in place of the program lists set-ups, which "
        "run one after the other, each into a folder of its own.",
    )
    add_program(parser)
    add_cell(parser, required=True)
    add_channels(parser)
    parser.add_argument(
        "--out", type=Path, default=Path("out"), metavar="DIR", help="folder for the files (default: out)"
    )
    parser.add_argument(
        "--force",
        action="store_true",
        help="overwrite files in DIR also where the run reads them, or gcodesim did not write them",
    )
    parser.add_argument(
        "--world",
        choices=("kinematic", "bullet"),
        help="instead of what the cell says: kinematic has no dynamics; bullet has inertia, gravity and motors",
    )
    parser.add_argument(
        "--only",
        choices=("shape", "motion", "force"),
        help="leave the rest out: shape cuts the stock without forces and writes no log; motion moves the machine and "
        "cuts nothing; force cuts with forces and writes neither log nor shapes",
    )
    parser.add_argument(
        "--live",
        type=_port,
        nargs="?",
        const=PORT,
        metavar="PORT",
        help=f"show the log in a viewer while it is computed, at ws://localhost:PORT (default {PORT}; 0: any free one)",
    )
    parser.add_argument(
        "--live-from",
        type=_origin,
        action="append",
        default=[],
        metavar="ORIGIN",
        help="let a viewer on the pages of another host watch, such as https://viewer.example.org (repeatable); pages "
        "of this machine and of Foxglove may, with the token of the printed address",
    )
    parser.add_argument(
        "--gui",
        action="store_true",
        help="show the run in pybullet's own window; a click on a body prints its name, frame and cell line",
    )
    add_from_line(
        parser,
        required=False,
        says="take the program up at line N, with the stock as the lines before leave it, behind a preamble that DIR "
        "gets as `restart`",
    )
    add_language(parser)
    add_parameter_output(parser)
    add_verdict_formats(parser)
    add_fail_on(parser)
    add_baseline(parser)
    add_today(parser)
    parser.set_defaults(run=run, prog=parser.prog)


def _port(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) < 1 << 16):
        raise argparse.ArgumentTypeError(f"'{text}' is no port from 0 to 65535; without a number write --live last")
    return int(text)


def _origin(text: str) -> str:
    from gcodesim.log.live_door import is_origin

    origin = text.rstrip("/").lower()
    if not is_origin(origin):
        raise argparse.ArgumentTypeError(f"'{text}' is no origin of pages, such as https://viewer.example.org")
    return origin


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.setups.naming import is_job_file

    if is_job_file(arguments.program):
        from gcodesim.cli.setups import run_job

        return run_job(arguments)
    from gcodesim.cli.simulate import run_program

    return run_program(arguments)
