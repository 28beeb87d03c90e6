"""`gcodesim warm-up`: compile all kernels once, on all cores, with a line every two seconds."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.exits import INTERNAL, OK
from gcodesim.cli.output import note


def add_parser(commands: Any) -> None:
    parser = commands.add_parser("warm-up", help="compile the kernels now, so that the first run does not wait")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.warm_up import warm_up

    return OK if warm_up(note) else INTERNAL
