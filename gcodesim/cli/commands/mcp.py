"""`gcodesim mcp [FOLDER]`: lint, check, run, diff and explain as tools for programs that write programs."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from gcodesim.cli.exits import OK, UsageError
from gcodesim.cli.interrupts import left_at_once
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
    from mcp.server.mcpserver.tools import Tool

    from gcodesim import __version__
    from gcodesim.cli.folder_tools import FolderTools, stop_calls, stoppable

    tools = FolderTools(arguments.folder)
    offered = [
        Tool.from_function(stoppable(each), structured_output=True)
        for each in (tools.lint, tools.check, tools.run, tools.diff, tools.explain)
    ]
    for tool in offered:
        _take_no_other_words(tool)
    server = MCPServer("gcodesim", version=__version__, tools=offered)

    with left_at_once(stop_calls):
        server.run("stdio")
    return OK


def _take_no_other_words(tool: Any) -> None:
    """Refuse a call with a word that the tool does not have; a client would believe that it was heard."""
    own = tool.fn_metadata.arg_model
    strict: Any = type(own.__name__, (own,), {"model_config": {"extra": "forbid"}})
    tool.fn_metadata.arg_model = strict
    tool.parameters = strict.model_json_schema(by_alias=True)
