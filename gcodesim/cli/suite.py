"""The common part of `test` and `accept`: which cases, how they run, progress on a terminal."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim.cli.exits import UsageError
from gcodesim.cli.judging import add_today
from gcodesim.cli.options import add_allow_path, add_fail_on, read_source
from gcodesim.diagnostics.plain import one_line, raw

if TYPE_CHECKING:
    from gcodesim.regress.case import Collected
    from gcodesim.regress.outcome import Judging


def add_selection(parser: argparse.ArgumentParser) -> None:
    """Options for which cases run, and how."""
    parser.add_argument(
        "paths",
        type=Path,
        nargs="*",
        metavar="PATH",
        help="test files (NAME.test.yaml), programs, or folders of them (default: this folder)",
    )
    parser.add_argument(
        "-k",
        dest="names",
        action="append",
        default=[],
        metavar="NAME",
        help="only cases whose name has this as a part, or fits it as a pattern; may be given several times",
    )
    parser.add_argument("-j", dest="jobs", type=int, default=1, metavar="N", help="processes at once; 0: one a core")
    parser.add_argument(
        "--cell", type=Path, metavar="CELL", help="the cell of programs that no test file gives one; makes each a case"
    )
    add_allow_path(parser)
    add_fail_on(parser)
    add_today(parser)


def selected(arguments: argparse.Namespace) -> tuple[Collected, Judging]:
    """The requested cases; UsageError if there are none or a path does not exist."""
    from gcodesim.regress.case import collect
    from gcodesim.regress.outcome import Judging

    root = Path.cwd()
    paths = arguments.paths or [Path()]
    for path in paths:
        if not path.exists():
            raise UsageError(f"{path} is not there")
    if arguments.cell is not None:
        read_source(arguments.cell, "cell")
    try:
        collected = collect(
            paths, root, cell=arguments.cell, names=arguments.names, allow_paths=tuple(arguments.allow_path)
        )
    except OSError as error:
        raise UsageError(f"{error.filename} cannot be read: {error.strerror}") from None
    if not collected.cases and not collected.found:
        where = ", ".join(str(path) for path in paths)
        names = f" with a name like {', '.join(arguments.names)}" if arguments.names else ""
        raise UsageError(
            f"there is no test in {where}{names}; a test is a file NAME.test.yaml, a program with `(expect: GS…)` in a "
            "comment, or any program when --cell names a cell"
        )
    today = arguments.today or date.today()
    return collected, Judging(
        root=root,
        fail_on=arguments.fail_on,
        today=today,
        allow_paths=tuple(arguments.allow_path),
        allow_code=arguments.allow_code,
    )


@contextmanager
def workers_are_safe() -> Iterator[None]:
    """UsageError if a worker is killed, because it needed more than the machine has."""
    from gcodesim.regress.workers import WorkerLostError

    try:
        yield
    except WorkerLostError as reason:
        raise UsageError(f"{reason}, perhaps for want of memory; fewer at once (-j) need less") from None


def jobs_of(arguments: argparse.Namespace) -> int:
    if arguments.jobs < 0:
        raise UsageError("-j takes a number from 0 on")
    if hasattr(os, "sched_getaffinity"):  # not everywhere
        return arguments.jobs or len(os.sched_getaffinity(0))
    return arguments.jobs or os.cpu_count() or 1


class Bar:
    """Progress of the cases on a terminal; nothing elsewhere."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._bar: Any = None

    def __enter__(self) -> Callable[[str], None]:
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

            case = TextColumn("{task.fields[case]}", markup=False)
            columns = (MofNCompleteColumn(), BarColumn(), TimeRemainingColumn(), case)
            self._bar = Progress(*columns, console=Console(file=raw(sys.stderr)), transient=True)
            self._task = self._bar.add_task("cases", total=self._total, case="")
            self._bar.start()
        return self._step

    def _step(self, name: str) -> None:
        if self._bar is not None:
            self._bar.update(self._task, advance=1, case=one_line(name))

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()
