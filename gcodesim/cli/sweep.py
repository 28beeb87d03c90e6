"""What `gcodesim sweep` does: reads the study, has its runs done, writes tables and page, judges."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, Final

from gcodesim import compiled
from gcodesim.cli.exits import FINDINGS, INTERNAL, OK, UsageError
from gcodesim.cli.formats import wants_formats, write_formats
from gcodesim.cli.options import read_source
from gcodesim.cli.output import note, print_count, print_findings, print_json, print_table
from gcodesim.cli.suite import Bar
from gcodesim.cli.workers import hands_of
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.extras import require_extra
from gcodesim.files.output_folder import (
    LOG_NAME,
    SWEEP_NAME,
    SWEEP_PAGE,
    SWEEP_TABLES,
    FolderInUseError,
    claimed,
    link_on_the_way,
    overwriting,
)
from gcodesim.files.whole_file import write_whole
from gcodesim.frozen import frozen
from gcodesim.numbers import clean
from gcodesim.scale.hands import Alone
from gcodesim.sweep.design import Point, count, points
from gcodesim.sweep.journal import NAME as JOURNAL
from gcodesim.sweep.journal import ForeignJournalError, Journal
from gcodesim.sweep.measure import figure
from gcodesim.sweep.page import aim_of, column_of, write_page
from gcodesim.sweep.prepared import Allowed, Prepared, prepared
from gcodesim.sweep.row import Row, cells, headings, limit_findings
from gcodesim.sweep.running import Tally, do_runs, folder_of, rows
from gcodesim.sweep.search import SearchOutcome, search
from gcodesim.sweep.study_file import StudyFile, read_study
from gcodesim.sweep.summary import Summary, summary_as_json
from gcodesim.sweep.tables import write_tables
from gcodesim.sweep.verdict import verdict_of

_MOST_SHOWN: Final = 8
REPLAY: Final = "report.html"
"""The page of one run, in the folder of its files."""


def sweep(arguments: argparse.Namespace) -> int:
    """Run the command; the exit status."""
    from gcodesim.cli.simulate import announce_compiling

    begin = time.perf_counter()
    compiled.when_cold = announce_compiling
    file = read_study(read_source(arguments.study, "study"), arguments.study, arguments.allow_path)
    if file.study is None:
        return _faulty(file, list(file.findings), {file.source.name: file.source}, arguments)
    allowed = Allowed(paths=tuple(arguments.allow_path), code=arguments.allow_code, today=arguments.today)
    ready, found = prepared(file, file.study, allowed)
    found = sorted([*file.findings, *found], key=lambda one: one.order)
    if ready is None:
        return _faulty(file, found, {file.source.name: file.source}, arguments)
    if arguments.number is not None:
        return _run_alone(ready, arguments)
    if arguments.replay:
        require_extra("report", "replays of the best and the worst run")
    if arguments.find and ready.study.find is None:
        raise UsageError(f"{arguments.study} does not say what to `find`")
    with _folder(arguments, ready) as journal:
        if arguments.dry_run:
            return _dry(ready, journal)
        status = _sweep(ready, journal, arguments)
    note(f"{time.perf_counter() - begin:.1f} s")
    return status


@contextmanager
def _folder(arguments: argparse.Namespace, ready: Prepared) -> Iterator[Journal]:
    """The output folder, claimed for this sweep, with its journal."""
    out = arguments.out
    if link_on_the_way(out) is not None and not out.is_dir():
        raise UsageError(f"{out} is reached through a link")
    if arguments.resume and not (out / JOURNAL).is_file():
        raise UsageError(f"{out} has no sweep to go on with")
    lost = overwriting(out, [SWEEP_NAME, *SWEEP_TABLES, SWEEP_PAGE], (), Span(ready.file.source.name))
    if lost:
        raise UsageError(f"{lost[0].message}; give the sweep a folder of its own by --out")
    if arguments.dry_run and not out.is_dir():
        raise UsageError(f"{count(ready.study)} runs, none of them known: {out} is not there yet")
    try:
        with claimed(out):
            journal = Journal(out)
            try:
                yield journal
            finally:
                journal.close()
    except FolderInUseError:
        raise UsageError(f"another sweep is writing into {out}; wait for its end, or name another --out") from None
    except ForeignJournalError:
        raise UsageError(f"{out / JOURNAL} was not written by gcodesim; name another --out") from None


def _sweep(ready: Prepared, journal: Journal, arguments: argparse.Namespace) -> int:
    """Have all runs done, whatever ends it: what is done by then is in the tables."""
    total = ready.study.find.runs if arguments.find and ready.study.find is not None else count(ready.study)
    tally = Tally(total=total)
    if arguments.again:
        journal.forget_all()
    found: SearchOutcome | None = None
    tried: list[Point] = []
    try:
        with Bar(total) as step, hands_of(arguments, total) as hands:
            work = partial(
                do_runs,
                ready,
                journal=journal,
                hands=hands,
                tally=tally,
                out=arguments.out,
                progress=lambda tally: step(f"{tally.known} known" if tally.known else ""),
            )
            if arguments.find:
                found = search(
                    ready.study, partial(_tried, ready, journal, partial(work, keep=arguments.keep_logs), tried)
                )
            else:
                work(points(ready.study), keep=arguments.keep_logs)
            chosen = _Chosen(ready=ready, journal=journal, tried=tried if found is not None else None)
            if arguments.replay:
                again = replace(tally)  # these runs are counted already; faults and lost ones go into the same lists
                work([row.point for row in _extremes(chosen, found)], keep=True, tally=again)
    except (KeyboardInterrupt, UsageError):
        chosen = _Chosen(ready=ready, journal=journal, tried=tried if arguments.find else None)
        _write(ready, chosen, arguments)
        done = sum(1 for _ in chosen.rows())
        note(f"{done} of {total} runs are kept in {arguments.out}; `--resume` goes on")
        raise
    return _judged(ready, chosen, arguments, tally, found)


@frozen(eq=False)
class _Chosen:
    """The runs that tables and page show: all of the study, or the `tried` ones of a search."""

    ready: Prepared
    journal: Journal
    tried: Sequence[Point] | None

    def rows(self) -> Iterator[Row]:
        return rows(self.ready, points(self.ready.study) if self.tried is None else self.tried, self.journal)


def _tried(
    ready: Prepared,
    journal: Journal,
    work: Callable[[Sequence[Point]], None],
    tried: list[Point],
    wanted: Sequence[Point],
) -> list[Row | None]:
    """The rows of the points that a search asks for."""
    work(wanted)
    tried += wanted
    return [next(iter(rows(ready, [point], journal)), None) for point in wanted]


def _write(ready: Prepared, chosen: _Chosen, arguments: argparse.Namespace) -> None:
    made = (cells(ready, row, arguments.fail_on) for row in chosen.rows())
    write_tables(arguments.out, headings(ready), made)


def _judged(
    ready: Prepared, chosen: _Chosen, arguments: argparse.Namespace, tally: Tally, found: SearchOutcome | None
) -> int:
    """Write tables, page and summary, print them; the exit status."""
    _write(ready, chosen, arguments)
    summary = Summary.of(ready, chosen.rows(), arguments.fail_on)
    _write_page(chosen, summary.count, found, arguments)
    said = summary_as_json(ready, summary, summary.count if found is not None else tally.total)
    if found is not None:
        said["best"] = found.best
    text = json.dumps(clean(said), indent=1, ensure_ascii=False)
    write_whole(arguments.out / SWEEP_NAME, f"{text}\n".encode())
    if arguments.format == "json":
        print_json(said)
    elif arguments.format == "text":
        _print(ready, summary, tally, arguments)
        if found is not None:
            _print_best(chosen, found)
    if wants_formats(arguments):
        write_formats(verdict_of(ready, chosen.rows(), arguments.fail_on), arguments)
    for fault in tally.faults[:1]:
        note(f"{len(tally.faults)} runs ended with a fault of gcodesim; the first:\n{fault}")
    if tally.faults:
        return INTERNAL
    bad = found.best is None if found is not None else bool(summary.failed)  # a search goes where runs fail
    arguments.status = FINDINGS if (bad and arguments.fail_on != "never") or tally.lost else OK
    return int(arguments.status)


def _extremes(chosen: _Chosen, found: SearchOutcome | None) -> list[Row]:
    """The runs in which the figure of the page is least and greatest, and the best one of a search."""
    aim = aim_of(chosen.ready, chosen.rows())
    known = [row for row in chosen.rows() if row.status != "failed" and figure(aim, row.figures) is not None]
    if not known:
        return []
    least, most = (of(known, key=lambda row: figure(aim, row.figures) or 0.0) for of in (min, max))
    best = [row for row in known if found is not None and row.number == found.best]
    return list({row.number: row for row in (least, most, *best)}.values())


def _write_page(chosen: _Chosen, count: int, found: SearchOutcome | None, arguments: argparse.Namespace) -> None:
    """The page, and with --replay the pages of the runs that it links to."""
    ready, out = chosen.ready, arguments.out
    if arguments.replay:
        for row in _extremes(chosen, found):
            _write_replay(folder_of(out, row.key), f"run {row.number}: {row.title()}")
    links = {
        row.number: (folder_of(Path(), row.key) / REPLAY).as_posix()
        for row in chosen.rows()
        if (folder_of(out, row.key) / REPLAY).is_file()
    }
    made = (cells(ready, row, arguments.fail_on) for row in chosen.rows())
    aim = aim_of(ready, chosen.rows())
    best = None if found is None else found.best
    write_whole(out / SWEEP_PAGE, write_page(ready, headings(ready), made, links, column_of(aim), count, best).encode())


def _write_replay(folder: Path, title: str) -> None:
    from gcodesim.playback import Recording
    from gcodesim.report.page import write_page as page_of_run

    if (folder / LOG_NAME).is_file():
        page = page_of_run([Recording.open(folder / LOG_NAME)], title=title)
        write_whole(folder / REPLAY, page.encode())


def _print_best(chosen: _Chosen, found: SearchOutcome) -> None:
    if found.best is None:
        print("  no run is within all limits")
        return
    row = next(row for row in chosen.rows() if row.number == found.best)
    print(f"  best: run {row.number} ({row.title()})")


def _print(ready: Prepared, summary: Summary, tally: Tally, arguments: argparse.Namespace) -> None:
    print_findings(list(tally.lost), ready.sources)
    print_findings(summary.findings, ready.sources)
    known = f", {tally.known} of them known from before" if tally.known else ""
    print(f"{ready.file.source.name}: {summary.count} runs{known}; {summary.failed} of them fail")
    print_table(summary.table(), names=1)
    if summary.codes:
        told = ", ".join(f"{code} in {number}" for code, number in sorted(summary.codes.items()))
        print(f"  errors and warnings: {told}; `gcodesim explain CODE` says more")
    if summary.failing and not arguments.find:
        numbers = ", ".join(str(number) for number in summary.failing[:_MOST_SHOWN])
        more = " …" if summary.failed > _MOST_SHOWN else ""
        print(f"  runs that fail: {numbers}{more}; `--run {summary.failing[0]} --out DIR` shows one alone")
    print(f"  {arguments.out / SWEEP_TABLES[0]} has a row for each run, {arguments.out / SWEEP_PAGE} shows them")


def _dry(ready: Prepared, journal: Journal) -> int:
    known = sum(1 for _ in rows(ready, points(ready.study), journal))
    print(f"{count(ready.study)} runs, {known} of them known from before")
    return OK


def _run_alone(ready: Prepared, arguments: argparse.Namespace) -> int:
    """One run of the study in this process, with its files in the output folder."""
    point = _point(ready, arguments.number)
    out = arguments.out
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise UsageError(f"{out} is there already and not empty; name another folder by --out")
    task = ready.task(point, keep=True)
    from gcodesim.sweep.one import run_one

    (end,) = Alone().do(run_one, [task])
    if end.fault:
        note(end.fault)
        return INTERNAL
    for name, data in end.made.files.items():
        write_whole(out / name, data)
    from gcodesim.sweep.row import row_of

    row = row_of(ready, arguments.number, task.key[:64], point, end.made.said)
    shown = [*row.findings, *limit_findings(ready, row)]
    print_findings(shown, ready.sources)
    print_count(f"run {row.number} ({row.title()})", shown)
    print(f"\n  files are in {out}; look at it: `gcodesim report {out}`")
    return FINDINGS if row.fails(arguments.fail_on) else OK


def _point(ready: Prepared, number: int) -> Point:
    total = count(ready.study)
    if not 0 <= number < total:
        raise UsageError(f"there is no run {number}: runs are 0 to {total - 1}")
    return next(islice(points(ready.study), number, None))


def _faulty(file: StudyFile, found: Sequence[Diagnostic], sources: Any, arguments: argparse.Namespace) -> int:
    """What is wrong with the study, its cell or its values; nothing has run."""
    from gcodesim.cli.judging import Met, settle
    from gcodesim.cli.output import findings_as_json

    met = Met(program=file.path, findings=found, sources=sources, files=lambda: {file.source.name: file.path})
    arguments.baseline = arguments.write_baseline = None
    settled = settle([met], arguments)
    if arguments.format == "json":
        print_json({"findings": findings_as_json(found)})
    elif arguments.format == "text":
        print_findings(settled.shown[0].findings, sources)
        print_count(settled.shown[0].name, settled.shown[0].findings)
        print("nothing was simulated, because of what is wrong in the study")
    write_formats(settled.verdict, arguments)
    return settled.status
