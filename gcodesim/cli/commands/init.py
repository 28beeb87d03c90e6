"""`gcodesim init DIR`: a commented program and cell to start from."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import OK, UsageError
from gcodesim.cli.options import read_source


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "init",
        help="write a commented program and cell that run",
        description="Write part.nc and cell.yaml, both with comments, into a folder. No file is overwritten.",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder to write into; made when it is not there")
    parser.add_argument(
        "--from",
        dest="program",
        type=Path,
        metavar="PROGRAM",
        help="write only a cell in which this program runs: dialect, machine, tools and stock as it suggests them; "
        "a project of CAMotics (.camotics) says tools, stock and resolution itself",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.files.whole_file import write_whole
    from gcodesim.starter.example import CELL, start_files
    from gcodesim.starter.first_cell import NoCellError, cell_for
    from gcodesim.starter.project_cell import SUFFIX, cell_of_project, read_project

    folder = arguments.folder
    program = None if arguments.program is None else read_source(arguments.program, "program")
    programs = [] if arguments.program is None else [arguments.program]
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"{folder} is a file, not a folder")
    try:
        if arguments.program is not None and arguments.program.suffix.lower() == SUFFIX:
            project = read_project(arguments.program)
            files, programs = {CELL: cell_of_project(project)}, list(project.programs)
        else:
            files = start_files() if program is None else {CELL: cell_for(program)}
    except NoCellError as reason:
        raise UsageError(f"{reason}; nothing was written") from None
    present = [name for name in files if os.path.lexists(folder / name)]
    if present:
        raise UsageError(f"{folder / present[0]} is there already; nothing was written")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            write_whole(folder / name, text)
    except OSError as error:
        raise UsageError(f"{folder} cannot be written: {error.strerror}") from None
    print(f"wrote {', '.join(files)} into {folder}")
    if program is None:
        print(f"next: cd {folder} && gcodesim run part.nc --cell {CELL}")
    else:
        each = ", ".join(f"gcodesim run {path} --cell {folder / CELL}" for path in programs)
        print(f"next: look at {folder / CELL}, then {each}")
    return OK
