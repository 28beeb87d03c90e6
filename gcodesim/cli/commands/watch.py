"""`gcodesim watch PATH…`: lint, check, run or test again whenever a file changes."""

from __future__ import annotations

import argparse
import shlex
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from gcodesim.cli.exits import UsageError
from gcodesim.cli.options import STDIN, add_allow_path
from gcodesim.cli.output import note
from gcodesim.files.watched import WatchedFiles

_DOES: Final = ("lint", "check", "run", "test")
_JOBS: Final = (".yaml", ".yml")
# what programs and cells are made of; results, logs and pictures are not
_INPUTS: Final = frozenset((".yaml", ".yml", ".tbl", ".var", ".py", ".stl", ".obj", ".dae", ".urdf", ".xacro", ".csv"))
_RESULTS: Final = "results.json"
_EVERY: Final = 0.3


def add_parser(commands: Any) -> None:
    parser = commands.add_parser(
        "watch",
        help="lint, check, run or test again whenever a file changes",
        description="Run a command at once, and again for what has changed: a program, its cell, or a file that one of "
        "them reads. Ctrl-C ends it.",
    )
    parser.add_argument(
        "paths", type=Path, nargs="+", metavar="PATH", help="programs, job files (YAML), or folders of tests"
    )
    parser.add_argument("--cell", type=Path, metavar="CELL", help="the cell of the programs")
    parser.add_argument(
        "--do",
        choices=_DOES,
        help="what to do (default: test for folders; check for job files and with --cell, else lint)",
    )
    parser.add_argument(
        "--every", type=_seconds, default=_EVERY, metavar="S", help=f"seconds between two looks (default: {_EVERY:g})"
    )
    parser.add_argument(
        "--with",
        dest="more",
        type=shlex.split,
        default=[],
        metavar="OPTIONS",
        help="further options of that command, as one word: --with='--only shape --out tried'",
    )
    add_allow_path(parser)
    parser.set_defaults(run=run)


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.01 <= value <= 3600.0:
        raise argparse.ArgumentTypeError("seconds from 0.01 to 3600 are expected")
    return value


def run(arguments: argparse.Namespace) -> int:
    for path in arguments.paths:
        if path == STDIN or not path.exists():
            raise UsageError("stdin cannot be watched" if path == STDIN else f"{path} is not there")
    if arguments.cell is not None and not arguments.cell.is_file():
        raise UsageError(f"cell {arguments.cell} is not there")
    tasks = [WatchedPath(path, arguments) for path in arguments.paths]
    watch(tasks, lambda: time.sleep(arguments.every))
    raise AssertionError("only a signal ends this")


class WatchedPath:
    """A path of the command line: the command for it, and the files on which that depends."""

    def __init__(self, path: Path, arguments: argparse.Namespace) -> None:
        self.path, self._arguments = path, arguments
        self._is_folder = path.is_dir()  # also while it is gone
        self.does = arguments.do or self._usual()
        self.files = WatchedFiles(self.inputs())

    def _usual(self) -> str:
        if self._is_folder:
            return "test"
        return "check" if self._arguments.cell is not None or self.path.suffix in _JOBS else "lint"

    @property
    def command(self) -> list[str]:
        """The words behind `gcodesim`."""
        given = self._arguments
        words = [self.does, str(self.path)]
        if given.cell is not None:
            words += ["--cell", str(given.cell)]
        for folder in given.allow_path:
            words += ["--allow-path", str(folder)]
        words += ["--allow-code"] if given.allow_code else []
        return [*words, *(["--changed"] if self.does == "test" else []), *given.more]

    def changed(self) -> list[Path]:
        """What has changed since the last look; files that have come count."""
        self.files.join(self._listed())
        return self.files.changed()

    def inputs(self) -> Iterator[Path]:
        """The path itself, its cell and the files that they name; of folders and job files all that may be an input."""
        yield self.path
        yield from self._listed()
        given = self._arguments
        if given.cell is not None and not self._is_many:
            from gcodesim.cell import load_cell

            yield given.cell
            with suppress(OSError):  # an editor may be writing it
                yield from (file.path for file in load_cell(given.cell, given.allow_path).files)

    @property
    def _is_many(self) -> bool:
        return self._is_folder or self.path.suffix in _JOBS

    def _listed(self) -> Iterator[Path]:
        """What lies beside a program, or in a folder."""
        from gcodesim.regress.programs import PROGRAMS

        if self._is_many:
            yield from _inputs_in(self.path if self._is_folder else self.path.parent)
        else:
            yield from (one for one in _in(self.path.parent) if one.suffix.lower() in PROGRAMS and one.is_file())


def _inputs_in(folder: Path) -> Iterator[Path]:
    from gcodesim.regress.programs import PROGRAMS

    for path in _in(folder):
        if path.name.startswith(".") or path.is_symlink():
            continue
        if path.is_dir() and not (path / _RESULTS).is_file():
            yield from _inputs_in(path)
        elif path.suffix.lower() in _INPUTS or path.suffix.lower() in PROGRAMS:
            yield path


def _in(folder: Path) -> list[Path]:
    """What a folder holds; nothing where it is gone, or may not be read."""
    with suppress(OSError):
        return sorted(folder.iterdir())
    return []


def watch(tasks: list[WatchedPath], wait: Callable[[], None], act: Callable[[WatchedPath], None] | None = None) -> None:
    """Act for each task at once, and again when files of it have changed and then stood still for one look.

    `wait` lets the time between two looks pass; only an exception ends this, such as Ctrl-C.
    """
    act = act or _run
    for task in tasks:
        act(task)
    while True:
        note("waiting for changes; Ctrl-C ends")
        for number, found in sorted(_changes(tasks, wait).items()):
            task = tasks[number]
            note(f"{', '.join(str(path) for path in found[:5])}{' …' if len(found) > 5 else ''} changed")
            act(task)
            task.files.watch(task.inputs())


def _changes(tasks: list[WatchedPath], wait: Callable[[], None]) -> dict[int, list[Path]]:
    """What has changed, by the number of the task, once nothing has changed any more between two looks."""
    found: dict[int, set[Path]] = {}
    while True:
        wait()
        fresh = {number: changed for number, task in enumerate(tasks) if (changed := task.changed())}
        for number, changed in fresh.items():
            found.setdefault(number, set()).update(changed)
        if found and not fresh:
            return {number: sorted(paths) for number, paths in found.items()}


def _run(task: WatchedPath) -> None:
    """The command in a process of its own, so that each answer is that of a fresh one."""
    note(f"gcodesim {' '.join(task.command)}")
    sys.stdout.flush()
    subprocess.run([sys.executable, "-m", "gcodesim", *task.command], stdin=subprocess.DEVNULL, check=False)
