"""`gcodesim mcp [FOLDER]`: lint, check, run, diff and explain as tools for programs that write programs."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import OK, UsageError
from gcodesim.cli.interrupts import handled, leave_at_once
from gcodesim.extras import require_extra


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "mcp",
        help="offer lint, check, run, diff and explain as tools of the Model Context Protocol",
        description="Serve a folder on standard input and output, by the Model Context Protocol. Tools get paths in "
        "the folder and no others, and answer what the commands print with --format json. Needs the extra mcp.",
    )
    parser.add_argument(
        "folder",
        type=Path,
        nargs="?",
        default=Path(),
        metavar="FOLDER",
        help="where programs and cells are (default: .)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    require_extra("mcp", "this command")
    if not arguments.folder.is_dir():
        raise UsageError(f"there is no folder {arguments.folder}")
    from mcp.server.mcpserver import MCPServer

    from gcodesim import __version__
    from gcodesim.cli.folder_tools import FolderTools

    tools = FolderTools(arguments.folder)
    server = MCPServer("gcodesim", version=__version__)
    for tool in (tools.lint, tools.check, tools.run, tools.diff, tools.explain):
        server.tool(structured_output=True)(tool)
    with handled(leave_at_once):
        server.run("stdio")
    return OK
