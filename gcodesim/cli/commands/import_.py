"""`gcodesim import tools FILE`: tools from the files of CAM systems and controls, as keys of a cell."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any, Final

from gcodesim.cli.exits import FINDINGS, OK, UsageError

_REFUSED: Final = "refused: "


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
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="write the keys into FILE; without it they are printed"
    )
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
    lines = [f"# from {arguments.file.name}, a {found.what}", *found.stock.splitlines(), "tools:"]
    taken: dict[int, bool] = {}  # by number: whether it is approximated
    refused: list[str] = []
    for tool in found.tools:
        called = f"T{tool.number} ({tool.name})" if tool.name else f"T{tool.number}"
        notes = list(tool.notes)
        twice = tool.number in taken and not tool.refused
        if twice:
            notes.append("refused: its number stands a second time")
        if tool.refused or twice:
            why = next((note for note in notes if note.startswith(_REFUSED)), "")
            refused.append(f"{called}: {why.removeprefix(_REFUSED)}")
        elif tool.keys:
            taken[tool.number] = any(note.startswith("approximated") for note in notes)
            lines.append(f"  {tool.number}: {{{', '.join(f'{key}: {value}' for key, value in tool.keys.items())}}}")
        for note in notes:
            print(f"{called}: {note}", file=sys.stderr)
    _write("".join(f"{line}\n" for line in lines), arguments.out)
    near = sum(taken.values())
    names = f": {'; '.join(refused)}" if refused else ""
    counted = f"read {len(taken) - near}, approximated {near}, refused {len(refused)}{names}"
    print(counted, file=sys.stderr if arguments.out is None else sys.stdout)
    return FINDINGS if refused else OK


def _write(text: str, path: Path | None) -> None:
    """Print the keys, or write them into a file."""
    if path is None:
        print(text, end="")
        return
    from gcodesim.files.whole_file import write_whole

    try:
        write_whole(path, text.encode())
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from None
