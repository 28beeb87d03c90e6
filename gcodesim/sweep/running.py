"""The runs of a study: those that are not known yet are done by whoever has hands; each is kept as it ends."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.files.whole_file import write_whole
from gcodesim.scale.hands import Ended, Hands, WorkerTask
from gcodesim.sweep.design import Point
from gcodesim.sweep.journal import Journal
from gcodesim.sweep.one import run_one
from gcodesim.sweep.prepared import Prepared
from gcodesim.sweep.row import Row, row_of

RUNS: Final = "runs"
"""The folder with a folder for each run whose files are kept."""

NOT_DONE: Final = "GS632"
_KEY: Final = 64
_SHORT: Final = 16


@dataclass(slots=True, kw_only=True)
class Tally:
    """How a sweep stands."""

    total: int
    known: int = 0
    done: int = 0
    took_s: float = 0.0
    faults: list[str] = field(default_factory=list)
    lost: list[Diagnostic] = field(default_factory=list)


def do_runs(
    ready: Prepared,
    points: Iterable[Point],
    journal: Journal,
    hands: Hands,
    tally: Tally,
    *,
    out: Path,
    keep: bool = False,
    progress: Callable[[Tally], None] = lambda tally: None,
) -> None:
    """Do all runs that are not in the journal; with `keep` also those whose files are not in `out`.

    Whatever interrupts it, what has ended by then is kept. What the hands raise goes on to the caller.
    """
    asked: set[str] = set()

    def tasks() -> Iterator[WorkerTask]:
        for point in points:
            task = ready.task(point, keep=keep)
            key = task.key[:_KEY]
            if key in asked:
                tally.known += 1
            elif journal.row(key) is not None and (not keep or folder_of(out, key).is_dir()):
                tally.known += 1
                progress(tally)
            else:
                asked.add(key)
                yield task

    ending = hands.do(run_one, tasks())
    try:
        for end in ending:
            _take(end, ready, journal, tally, out)
            progress(tally)
    finally:
        ending.close()


def _take(end: Ended, ready: Prepared, journal: Journal, tally: Tally, out: Path) -> None:
    key = end.task.key[:_KEY]
    tally.done += 1
    if end.fault:
        tally.faults.append(end.fault)
    elif end.lost:
        tally.lost.append(
            Diagnostic(
                code=NOT_DONE,
                span=Span(ready.file.source.name),
                message=f"the run {key[:_SHORT]} was not done: {end.lost}",
                hint="give workers more memory, or the stock a coarser grid; then `--resume`",
            )
        )
    else:
        tally.took_s += end.took_s
        if end.made.files:
            _write(folder_of(out, key), end)
        journal.add(key, end.made.said)


def _write(folder: Path, end: Ended) -> None:
    """The files of a run, in a folder that has its name only when it is complete."""
    part = folder.with_name(f"{folder.name}.part")
    for path in (part, folder):
        shutil.rmtree(path, ignore_errors=True)
    for name, data in end.made.files.items():
        write_whole(part / name, data)
    part.rename(folder)


def folder_of(out: Path, key: str) -> Path:
    """Where the files of a run are, if they are kept."""
    return out / RUNS / key[:_SHORT]


def rows(ready: Prepared, points: Iterable[Point], journal: Journal) -> Iterator[Row]:
    """The rows of all runs that are done, in the order of the study, one after the other."""
    for number, point in enumerate(points):
        key = ready.task(point).key
        kept = journal.row(key)
        if kept is None:
            continue
        try:
            yield row_of(ready, number, key, point, kept)
        except (KeyError, TypeError, ValueError, AttributeError):  # whatever somebody has put there
            journal.forget(key)
