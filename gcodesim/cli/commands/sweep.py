"""`gcodesim sweep STUDY`: a program in a cell, many times, each time with other values."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.formats import add_verdict_formats
from gcodesim.cli.judging import add_today
from gcodesim.cli.options import add_allow_path, add_fail_on
from gcodesim.cli.workers import add_scheduler

_DESCRIPTION = """Run a program in a cell, or set-ups, with all values that a study (YAML) lists: of keys of the cell,
of parameters of the program, of files; as grids, rows, Sobol points, a Latin hypercube or lines of a table. Each run is
a row of runs.csv and runs.parquet in the output folder; sweep.html shows them. What was run before with the same
inputs is not run again, so a sweep that was interrupted goes on where it was. `docs/how-to/sweeps.md` has it all."""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "sweep", help="many runs with other values: tables, limits, a page", description=_DESCRIPTION
    )
    parser.add_argument("study", type=Path, metavar="STUDY", help="the study file (YAML)")
    parser.add_argument(
        "-o", "--out", type=Path, default=Path("sweep"), metavar="DIR", help="output folder (default: sweep)"
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on with the sweep in --out; status 2 if there is none"
    )
    parser.add_argument("--again", action="store_true", help="run everything again, also what is known")
    parser.add_argument("--find", action="store_true", help="search for the best point as `find` of the study says")
    parser.add_argument(
        "--run", dest="number", type=int, metavar="N", help="do run N alone, in this process, and keep its files"
    )
    parser.add_argument(
        "--keep-logs", action="store_true", help="keep log, results and stocks of each run in --out/runs"
    )
    parser.add_argument(
        "--replay",
        action="store_true",
        help="link the best and the worst run in the page to a report with replay of each (extra report)",
    )
    parser.add_argument(
        "-n", "--dry-run", action="store_true", help="say how many runs there are, and how many are known"
    )
    add_workers(parser)
    add_allow_path(parser)
    add_fail_on(parser)
    add_today(parser)
    add_verdict_formats(parser)
    parser.set_defaults(run=run)


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Options for who does the runs."""
    group = parser.add_argument_group("workers", "who does the runs; tables and verdicts do not depend on it")
    group.add_argument(
        "-j", dest="jobs", type=int, default=0, metavar="N", help="processes at once (default 0: one a core)"
    )
    add_scheduler(group)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.cli.sweep import sweep

    return sweep(arguments)
