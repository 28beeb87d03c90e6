"""Entry point: parse, run one command, turn every ending into the promised exit status."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from typing import Final

from gcodesim.cli.exits import INTERNAL, INTERRUPTED, OK, USAGE, UsageError
from gcodesim.cli.parser import build_parser

# Imports make many objects that all stay: to look for garbage among them every 700 takes a tenth of a short command.
GARBAGE_EVERY: Final = 100_000


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; returns the exit status: 0 clean, 1 findings, 2 usage, 70 our fault, 130 interrupted."""
    gc.set_threshold(GARBAGE_EVERY)
    atexit.register(gc.freeze)  # else the interpreter looks through all of them several times before it ends
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(encoding="utf-8", errors="replace")  # a finding may quote any character of a program
    arguments: Namespace | None = None
    try:
        arguments = build_parser().parse_args(argv)
        status = int(arguments.run(arguments))
        sys.stdout.flush()
        return status
    except UsageError as error:
        print(f"gcodesim: {error}", file=sys.stderr)
        return USAGE
    except KeyboardInterrupt:
        print("gcodesim: interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # the reader of our output went away (`| head`); nothing may be written, but a verdict stays what it is
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return int(getattr(arguments, "status", OK))
    except Exception as error:
        _report_fault(error, sys.argv[1:] if argv is None else argv)
        return INTERNAL


def _report_fault(error: Exception, argv: Sequence[str]) -> None:
    """Say that this is our fault and what a report needs."""
    import platform
    import traceback

    from gcodesim import __version__

    traceback.print_exception(error, file=sys.stderr)
    print(
        "\ngcodesim: internal error. This is a fault of gcodesim, not of your program or cell.\n"
        "Please report it with the text above, the program and the cell if you may share them, and this line:\n"
        f"  gcodesim {__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}: "
        f"gcodesim {' '.join(argv)}",
        file=sys.stderr,
    )
