"""Entry point: parse, run one command, turn every ending into the promised exit status."""

from __future__ import annotations

import atexit
import errno
import gc
import os
import sys
from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Final

from gcodesim.cli.exits import INTERNAL, INTERRUPTED, OK, USAGE, UsageError
from gcodesim.cli.interrupts import Interrupted, LastSignal, handled, interrupted_by
from gcodesim.cli.overwriting import refuse_files_like_options, refuse_own_inputs
from gcodesim.cli.parser import parser_for
from gcodesim.cli.streams import drop_output
from gcodesim.diagnostics.plain import PlainStream, raw
from gcodesim.extras import ExtraMissingError
from gcodesim.family import ExtensionError, package_at_fault, take_back

# Imports and the plan of a short run create some 150,000 objects that all stay. To look for garbage among them once
# takes a twelfth of such a run, after every 700 still more.
GARBAGE_EVERY: Final = 400_000

# what a write to a stream that is open can end with; anything else without a file's name has a text that says enough
_OF_STREAMS: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF, errno.EAGAIN)


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; returns the exit status.

    0 clean, 1 findings, 2 usage, 70 our fault, 130 interrupted by Ctrl-C, 143 by SIGTERM.
    """
    gc.set_threshold(GARBAGE_EVERY)
    atexit.register(gc.freeze)  # otherwise the interpreter searches all of them several times before it ends
    if not _streams_are_open():
        return USAGE
    with _plain_streams():
        return _run(argv)


@contextmanager
def _plain_streams() -> Iterator[None]:
    """Inside this context, output contains no commands to a terminal or build server except our own."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = PlainStream(raw(before[0])), PlainStream(raw(before[1]))
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def _run(argv: Sequence[str] | None) -> int:
    arguments: Namespace | None = None
    heard = LastSignal()
    try:
        with handled() as heard:
            take_back()
            words = sys.argv[1:] if argv is None else argv
            refuse_files_like_options(words)
            arguments = parser_for(words).parse_args(words)
            refuse_own_inputs(arguments)
            status = int(arguments.run(arguments))
            sys.stdout.flush()
            return status
    except (UsageError, ExtensionError, ExtraMissingError) as error:
        return _refused(str(error))
    except KeyboardInterrupt as error:
        print("gcodesim: interrupted", file=sys.stderr)
        number = error.number if isinstance(error, Interrupted) else heard.number
        return interrupted_by(number) if number else INTERRUPTED
    except BrokenPipeError:
        # the reader of our output has gone away (`| head`); nothing more can be written, but the verdict stays
        drop_output()
        return int(getattr(arguments, "status", OK))
    except OSError as error:
        # the system refused something: a full disk, a name that is too long, a folder without permission
        reason = error.strerror or str(error)
        if error.filename is not None:
            return _refused(f"{error.filename}: {reason}")
        if error.errno not in _OF_STREAMS:
            return _refused(reason)
        drop_output()
        return _refused(f"the output: {reason}")
    except Exception as error:
        _report_fault(error, sys.argv[1:] if argv is None else argv)
        return INTERNAL


def _streams_are_open() -> bool:
    """Prepare both streams; False if stdout is closed, so that nobody would get the answer."""
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115  (lives as long as the process)
    if sys.stdout is None:
        print("gcodesim: the standard output is closed; `> /dev/null` throws the answer away", file=sys.stderr)
        return False
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(encoding="utf-8", errors="replace")  # a finding may quote any character of a program
    return True


def _refused(reason: str) -> int:
    print(f"gcodesim: {reason}", file=sys.stderr)
    return USAGE


def _report_fault(error: Exception, argv: Sequence[str]) -> None:
    """Say whose fault this is, and what a bug report needs."""
    import platform
    import traceback

    from gcodesim import __version__

    traceback.print_exception(error, file=sys.stderr)
    package = package_at_fault(error)
    whose = f"{package}, which extends gcodesim" if package else "gcodesim"
    to_whom = " to its authors" if package else ""
    print(
        f"\ngcodesim: internal error. This is a fault of {whose}, not of your program or cell.\n"
        f"Please report it{to_whom} with the text above, the program and the cell if you may share them, "
        "and this line:\n"
        f"  gcodesim {__version__}, Python {platform.python_version()}, {platform.system()} {platform.machine()}: "
        f"gcodesim {' '.join(argv)}",
        file=sys.stderr,
    )
