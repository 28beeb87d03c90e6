"""The argument parser: one subparser for each command, each in its own file under `commands`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module

from gcodesim import __version__
from gcodesim.cli.argument_parser import Parser

COMMANDS = (
    "run",
    "check",
    "lint",
    "canon",
    "fmt",
    "watch",
    "cell",
    "place",
    "restart",
    "init",
    "import_",
    "info",
    "export",
    "post",
    "ros",
    "plot",
    "report",
    "test",
    "accept",
    "diff",
    "explain",
    "list",
    "process",
    "optimise",
    "sweep",
    "schema",
    "completion",
    "mcp",
    "lsp",
    "warm_up",
)

_EXAMPLES = """examples:
  gcodesim init demo                            a commented program and cell to start from
  gcodesim run part.nc --cell cell.yaml         simulate: material, forces, log, results
  gcodesim check part.nc --cell cell.yaml       limits, reach, time; no material
  gcodesim lint part.nc                         the program alone
  gcodesim fmt part.nc                          the same program in one style
  gcodesim test suite/                          what programs did when accepted, do they still?
  gcodesim watch part.nc --cell cell.yaml       check it again whenever a file changes
  gcodesim explain GS203                        what a finding means and what to do

exit status: 0 clean, 1 findings (see --fail-on), 2 wrong usage, 70 fault of gcodesim, 130 interrupted (143: SIGTERM)
"""


def build_parser(names: Sequence[str] = COMMANDS) -> Parser:
    """The command line with the commands of these names; building it imports no heavy package."""
    parser = Parser(
        prog="gcodesim",
        description="Simulate G-code programs in cells of robots and machine tools: "
        "motion, material, process forces, findings by line.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"gcodesim {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name in names:
        import_module(f"gcodesim.cli.commands.{name}").add_parser(commands)
    for command in commands.choices.values():
        command.whole = build_parser
    return parser


def parser_for(words: Sequence[str]) -> Parser:
    """What reads this command line: with the one command that it begins with, or with all.

    Declaring the options of all commands takes longer than reading a short program.
    """
    asked = [name for name in COMMANDS if list(words[:1]) == [name.strip("_").replace("_", "-")]]
    return build_parser(asked or COMMANDS)
