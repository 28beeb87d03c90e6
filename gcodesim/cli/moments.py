"""Moments and ranges of a run on the command line: `12.5`, `800 ms`, `2:30 min`, `10:20`, `100:250`."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Final

from gcodesim.cli.exits import UsageError

if TYPE_CHECKING:
    from gcodesim.playback import Recording

_UNITS: Final = {"": 1_000_000_000, "s": 1_000_000_000, "ms": 1_000_000, "us": 1_000, "min": 60_000_000_000}
_TIME = re.compile(r"\s*([0-9]*\.?[0-9]+)\s*(s|ms|us|min)?\s*", re.ASCII)


def nanoseconds(text: str) -> int:
    """A time such as `12.5`, `12.5 s` or `20 ms` in ns; for argparse."""
    found = _TIME.fullmatch(text)
    if found is None:
        raise argparse.ArgumentTypeError(f"'{text}' is no time; `12.5 s` and `20 ms` are")
    return round(float(found[1]) * _UNITS[found[2] or ""])


def time_range(text: str) -> tuple[int, int | None]:
    """`10:20` as begin and end [ns]; either side may be left out. A unit behind the last number is that of both."""
    first, colon, last = text.partition(":")
    if not colon:
        raise argparse.ArgumentTypeError(f"'{text}' is no range of time; `10:20` is (in s)")
    unit = re.sub(r"[0-9.\s]", "", last)
    if first.strip() and unit and not re.search("[a-z]", first):
        first += unit
    begin = nanoseconds(first) if first.strip() else 0
    end = nanoseconds(last) if last.strip() else None
    if end is not None and end < begin:
        raise argparse.ArgumentTypeError(f"'{text}' ends before it begins")
    return begin, end


def line_range(text: str) -> tuple[int, int, str | None]:
    """`100:250` or `sub.ngc:10:20` as first and last line and the file, None for the program itself."""
    found = re.fullmatch(r"(?:(.+):)?([0-9]+):([0-9]+)", text, re.ASCII)
    if found is None or int(found[2]) > int(found[3]):
        raise argparse.ArgumentTypeError(f"'{text}' is no range of lines; `100:250` is")
    return int(found[2]), int(found[3]), found[1]


def add_range(parser: argparse.ArgumentParser) -> None:
    """`--time` and `--lines`, which exclude each other."""
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--time", type=time_range, metavar="FROM:TO", help="only this time, in s: `10:20`, `90:`")
    group.add_argument(
        "--lines", type=line_range, metavar="FIRST:LAST", help="only while these program lines run: `100:250`"
    )


def chosen_range(arguments: argparse.Namespace, recording: Recording) -> tuple[int, int | None]:
    """Begin and end [ns] of what `add_range` was given; UsageError for lines that never ran."""
    if arguments.lines is not None:
        first, last, file = arguments.lines
        span = recording.timeline.span_of_lines(first, last, recording.end_ns, file)
        if span is None:
            raise UsageError(f"no line from {first} to {last} of {file or recording.name} ran")
        return span
    if arguments.time is not None:
        begin, end = arguments.time
        if begin > recording.end_ns:
            raise UsageError(f"the run ends at {recording.end_ns * 1e-9:g} s, before {begin * 1e-9:g} s")
        return begin, end
    return 0, None


def reads_logs(run: Callable[[argparse.Namespace], int]) -> Callable[[argparse.Namespace], int]:
    """Wraps `run` of a command so that a log that turns out to be damaged is a usage error."""

    @wraps(run)
    def guarded(arguments: argparse.Namespace) -> int:
        try:
            return run(arguments)
        except Exception as error:
            from gcodesim.log.logfile import LogReadError

            if not isinstance(error, LogReadError):
                raise
            raise UsageError(f"the log is damaged: {error}") from None

    return guarded


def open_recording(path: object) -> Recording:
    """The log or output folder named on the command line; UsageError if nothing of it can be read."""
    from pathlib import Path

    from gcodesim.playback import Recording, RecordingError

    try:
        return Recording.open(Path(str(path)))
    except RecordingError as error:
        raise UsageError(str(error)) from None


def status_of_reading(*recordings: Recording) -> int:
    """After reading: report on stderr (stdout may hold a table) what could not be read; returns the exit status."""
    from gcodesim.cli.exits import status_of
    from gcodesim.cli.output import print_findings

    found = [finding for recording in recordings for finding in recording.findings]
    print_findings(found, {}, sys.stderr)
    return status_of(found, "error")
