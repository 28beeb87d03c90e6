"""`gcodesim import WHAT FILE`: tools from the files of CAM systems and controls, settings of controls as a cell."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from gcodesim.cli.exits import FINDINGS, OK, UsageError
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import add_format
from gcodesim.cli.outline import may_be
from gcodesim.cli.output import print_json
from gcodesim.diagnostics.plain import one_line
from gcodesim.importers import IMPORTERS

if TYPE_CHECKING:
    from gcodesim.importers.importer import Imported

_REFUSED: Final = "refused: "
_TOOLS: Final = "tools"

_HELP: Final = """what:
  tools     tools of a tool.tbl of LinuxCNC, a library of Fusion (.tools, .json), a tool bit or library of FreeCAD
            (.fctb, .fctl), a project of CAMotics (.camotics), as keys of a cell
  linuxcnc  an INI of LinuxCNC as a cell: axes, limits, speeds, kinematics, tool table, parameters, subroutines
  grbl      the list of settings of `$$`, with that of `$#` behind it
  klipper   a printer.cfg of Klipper
  marlin    a Configuration.h of Marlin
  moveit    a MoveIt configuration, its folder or SRDF: robot, flange, named poses, allowed collisions, limits
`gcodesim list importers` names those of other packages too.

examples:
  gcodesim import tools tool.tbl -o tools.yaml
  gcodesim import linuxcnc machine.ini -o cell.yaml
"""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "import",
        help="tools of CAM systems, settings of controls and robots, as a cell",
        description="Print tools of a file as keys of a cell, or the settings of a control or robot as a whole cell. "
        "What is approximated, refused or not taken over is told, each by its name. The exit status is 1 when a tool "
        "is refused.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    may_be(
        parser.add_argument("what", metavar="WHAT", help="what to import, one of those below"),
        lambda: (_TOOLS, *IMPORTERS),
    )
    parser.add_argument("file", type=Path, metavar="FILE", help="the file, or for moveit the folder, to read")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="FILE", help="write into FILE; without it the keys are printed"
    )
    parser.add_argument("--inch", action="store_true", help="tools: lengths of a tool.tbl are inches")
    add_format(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    if arguments.what == _TOOLS:
        return _tools(arguments)
    if arguments.what not in IMPORTERS:
        raise UsageError(no_such("import", arguments.what, (_TOOLS, *IMPORTERS)))
    if arguments.inch:
        raise UsageError(f"--inch means nothing for {arguments.what}, which says its units")
    from gcodesim.importers.importer import NoSettingsError

    at = arguments.file if arguments.out is None else arguments.out
    folder = at if at.is_dir() else at.absolute().parent
    try:
        found = IMPORTERS[arguments.what]().read(arguments.file, folder)
    except OSError as error:
        raise UsageError(f"{arguments.file} cannot be read: {error.strerror}") from None
    except NoSettingsError as error:
        raise UsageError(str(error)) from None
    if arguments.format == "json":
        if arguments.out is not None:
            _write(found.text, arguments.out)
        print_json(_as_json(found, with_cell=arguments.out is None))
        return OK
    _write(found.text, arguments.out)
    stream = sys.stderr if arguments.out is None else sys.stdout
    for left in found.left:
        setting = left.setting
        place = f"{setting.file}:{setting.line}" if setting.line else setting.file
        value = f" = {setting.value}" if setting.value else ""
        mark = "! " if left.matters else "  "
        print(one_line(f"{mark}{place}: {setting.name}{value}: {left.why}"), file=stream)
    moving = sum(left.matters for left in found.left)
    print(
        f"{found.what}: {found.taken} settings taken over, {len(found.left)} not, of which {moving} (!) change what "
        "the machine does",
        file=stream,
    )
    return OK


def _as_json(found: Imported, *, with_cell: bool) -> dict[str, Any]:
    left = [
        {
            "name": one.setting.name,
            "value": one.setting.value,
            "file": one.setting.file,
            "line": one.setting.line,
            "why": one.why,
            "matters": one.matters,
        }
        for one in found.left
    ]
    cell = {"cell": found.text} if with_cell else {}
    return {"schema": "gcodesim-import/1", "what": found.what, "taken": found.taken, "left": left, **cell}


def _tools(arguments: argparse.Namespace) -> int:
    """Tools as keys of a cell."""
    if arguments.format == "json":
        raise UsageError("--format json is for settings; tools are printed as keys of a cell")
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
