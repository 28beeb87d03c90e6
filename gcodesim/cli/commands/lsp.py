"""`gcodesim lsp`: programs and cells in editors, by the Language Server Protocol."""

from __future__ import annotations

import argparse
import os
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import OK, UsageError
from gcodesim.cli.interrupts import left_at_once
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import dialects
from gcodesim.cli.outline import may_be
from gcodesim.extras import require_extra


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "lsp",
        help="serve an editor: findings while one types, hover, completion, outline (Language Server Protocol)",
        description="Serve an editor on standard input and output. Findings are those of `lint` and `cell validate`. "
        "A program's cell is that of --cell, of its test file, or cell.yaml beside it. Needs the extra lsp.",
    )
    parser.add_argument("--cell", type=Path, metavar="CELL", help="the cell of all programs")
    may_be(
        parser.add_argument("--dialect", metavar="NAME", help="how programs are read, whatever the cell says"), dialects
    )
    parser.add_argument(
        "--subs",
        type=Path,
        action="append",
        default=[],
        metavar="DIR",
        help="folder with subroutine files; may be given several times",
    )
    parser.add_argument(
        "--allow-path",
        type=Path,
        action="append",
        default=[],
        metavar="DIR",
        help="a folder besides the cell's own from which the cell may take files; may be given several times",
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="folder of the last run, for times beside lines (default: out)"
    )
    parser.add_argument("--stdio", action="store_true", help="as many editors say; there is no other way")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    require_extra("lsp", "this command")
    if arguments.cell is not None and not arguments.cell.is_file():
        raise UsageError(f"cell {arguments.cell} is not there")
    if arguments.dialect is not None and arguments.dialect not in dialects():
        raise UsageError(no_such("dialect", arguments.dialect, dialects()))
    from gcodesim.editor.program_document import Choices
    from gcodesim.editor.server import serve

    choices = Choices(
        cell=arguments.cell,
        dialect=arguments.dialect,
        subroutines=tuple(arguments.subs),
        allow_paths=tuple(arguments.allow_path),
        out=arguments.out,
    )
    with ExitStack() as stack:
        # of its own, since the server closes both at its end
        asked = stack.enter_context(os.fdopen(os.dup(sys.stdin.fileno()), "rb"))
        said = stack.enter_context(os.fdopen(os.dup(sys.stdout.fileno()), "wb"))
        stack.enter_context(left_at_once())
        serve(choices).start_io(asked, said)
    return OK
