"""`gcodesim completion bash|zsh|fish`: a script with which a shell completes gcodesim's command lines."""

from __future__ import annotations

import argparse
from typing import Any

from gcodesim.cli.exits import OK

_SHELLS = ("bash", "zsh", "fish")
_EPILOG = """to have it in each new shell:
  bash  echo 'eval "$(gcodesim completion bash)"' >> ~/.bashrc
  zsh   echo 'eval "$(gcodesim completion zsh)"' >> ~/.zshrc        (behind compinit)
  fish  gcodesim completion fish > ~/.config/fish/completions/gcodesim.fish
"""


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "completion",
        help="completion of commands, options and files for bash, zsh or fish",
        description="Print a script for a shell that completes commands, options and their values, programs, cells and "
        "codes of findings. It is made from the command line of this version.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("shell", choices=_SHELLS, metavar="SHELL", help=", ".join(_SHELLS))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    from importlib import import_module

    from gcodesim.cli.outline import outline
    from gcodesim.cli.parser import build_parser

    writer = import_module(f"gcodesim.cli.completion.{arguments.shell}")
    print(writer.script(outline(build_parser())), end="")
    return OK
