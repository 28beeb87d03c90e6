"""`gcodesim import tools FILE`: tools from the files of CAM systems and controls, as keys of a cell."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import FINDINGS, OK, UsageError


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "import",
        help="tools from the files of CAM systems and controls",
        description="Print tools of a file as keys of a cell: a tool.tbl of LinuxCNC, a library of Fusion (.tools, "
        ".json), a tool bit or library of FreeCAD (.fctb, .fctl), a project of CAMotics (.camotics). What is "
        "approximated or refused is told for each tool. The exit status is 1 when one is refused.",
    )
    parser.add_argument("what", metavar="WHAT", choices=("tools",), help="what to import: tools")
    parser.add_argument("file", type=Path, metavar="FILE", help="the file to read")
    parser.add_argument("--inch", action="store_true", help="lengths of a tool.tbl are inches")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from gcodesim.starter.tool_files import ToolFileError, read_tools

    try:
        found = read_tools(arguments.file, inch=arguments.inch)
    except OSError as error:
        raise UsageError(f"{arguments.file} cannot be read: {error.strerror}") from None
    except ToolFileError as error:
        raise UsageError(str(error)) from None
    print(f"# from {arguments.file.name}, a {found.what}")
    print(found.stock, end="")
    print("tools:")
    taken: set[int] = set()
    refused = 0
    for tool in found.tools:
        notes = list(tool.notes)
        twice = tool.number in taken and not tool.refused
        if twice:
            notes.append("refused: its number stands a second time")
        if tool.refused or twice:
            refused += 1
        elif tool.keys:
            taken.add(tool.number)
            print(f"  {tool.number}: {{{', '.join(f'{key}: {value}' for key, value in tool.keys.items())}}}")
        for note in notes:
            called = f"T{tool.number} ({tool.name})" if tool.name else f"T{tool.number}"
            print(f"{called}: {note}", file=sys.stderr)
    print(f"{len(taken)} tools read, {refused} refused", file=sys.stderr)
    return FINDINGS if refused else OK
