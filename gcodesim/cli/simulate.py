"""The common part of `run` and `check`: read, plan, run, print."""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from signal import SIGINT
from types import FrameType
from typing import TYPE_CHECKING, Final

from gcodesim import compiled
from gcodesim.cell import load_cell
from gcodesim.cell.verdict import suppressed_findings
from gcodesim.cli.exits import UsageError
from gcodesim.cli.formats import write_formats
from gcodesim.cli.interrupts import Interrupted, handled, interrupted_by
from gcodesim.cli.judging import Met, ShownProgram, settle
from gcodesim.cli.language import Language, files_of, write_parameters
from gcodesim.cli.nearest import no_such
from gcodesim.cli.options import is_auto, read_source
from gcodesim.cli.output import note, print_count, print_findings, print_json, print_table
from gcodesim.diagnostics import Severity, SourceText
from gcodesim.diagnostics.plain import one_line, raw
from gcodesim.files.output_folder import CELL_NAME, IN_USE, LOG_NAME, OVERWRITES, link_on_the_way, names_of
from gcodesim.jobs.job import BULLET, Job, Options
from gcodesim.jobs.results import Results
from gcodesim.report import summary_rows
from gcodesim.simulation import RunInterrupted, check, prepare, run

if TYPE_CHECKING:
    from gcodesim.cell import LoadedCell
    from gcodesim.cli.window import ShownRun
    from gcodesim.executor import Execution, Progress
    from gcodesim.log.live import LiveView


def _loaded(arguments: argparse.Namespace, program: SourceText) -> LoadedCell:
    """The cell for `program`; UsageError without one, which tells what the program needs."""
    if arguments.cell is None:
        from gcodesim.cli.without_cell import needs_text

        raise UsageError(needs_text(program, arguments.prog))
    if is_auto(arguments.cell):
        from gcodesim.cli.without_cell import made_cell

        return made_cell(program, getattr(arguments, "out", None))
    read_source(arguments.cell, "cell")
    return load_cell(arguments.cell, arguments.allow_path, allow_code=arguments.allow_code)


def further_programs(arguments: argparse.Namespace, loaded: LoadedCell) -> dict[str, SourceText]:
    """The programs that the command line names for further channels; UsageError for one that the cell does not have."""
    if loaded.cell is None:
        return {}
    known = loaded.cell.channels
    for name in arguments.channel:
        if name not in known:
            raise UsageError(no_such("channel", name, known))
    if set(known) <= set(arguments.channel):
        raise UsageError(f"--channel names a program for every channel, so that none is left for {arguments.prog}")
    return {name: read_source(path, "program") for name, path in arguments.channel.items()}


def options_of(arguments: argparse.Namespace) -> Options:
    """What the command line says about reading and running; programs of further channels are left out."""
    language = Language.of(arguments)
    return Options(
        world=getattr(arguments, "world", None),
        settings=language.over,
        findings=tuple(language.findings),
        sources=language.sources,
        today=arguments.today,
        force=getattr(arguments, "force", False),
        only=getattr(arguments, "only", None),
        fail_on=None if arguments.fail_on == "never" else Severity[arguments.fail_on.upper()],
    )


def _prepared(
    arguments: argparse.Namespace, program: SourceText, loaded: LoadedCell, options: Options | None = None
) -> Job:
    compiled.when_cold = announce_compiling
    return prepare(program, loaded, options or _options(arguments, loaded))


def _options(arguments: argparse.Namespace, loaded: LoadedCell) -> Options:
    return replace(options_of(arguments), channels=further_programs(arguments, loaded))


def _met(arguments: argparse.Namespace, path: Path, loaded: LoadedCell, job: Job, results: Results) -> Met:
    folders = [folder for each in job.all if each.reading for folder in each.reading.settings.subroutines]
    today = job.options.today
    suppressed = [
        pair for each in job.all for pair in suppressed_findings(each.findings, job.cell, each.program, today)
    ]
    sources = {name: source for each in reversed(job.all) for name, source in each.sources.items()}
    return Met(
        program=path,
        cell=arguments.cell if not loaded.made else loaded.path if hasattr(arguments, "out") else None,
        findings=results.findings,
        suppressed=[(finding, entry.reason) for finding, entry in suppressed],
        sources=sources,
        files=lambda: (
            {file.name: file for file in arguments.channel.values()}
            | files_of(arguments, path, sources, list(dict.fromkeys(folders)), loaded)
        ),
        results=results.as_json(),
    )


def check_programs(arguments: argparse.Namespace) -> int:
    """`gcodesim check`."""
    programs = [read_source(path, "program") for path in arguments.programs]
    one = None if arguments.cell is None or is_auto(arguments.cell) else _loaded(arguments, programs[0])
    cells = [one or _loaded(arguments, program) for program in programs]
    jobs = [_prepared(arguments, program, loaded) for program, loaded in zip(programs, cells, strict=True)]
    checked = [check(job) for job in jobs]
    settled = settle(
        [
            _met(arguments, path, loaded, job, results)
            for path, loaded, job, results in zip(arguments.programs, cells, jobs, checked, strict=True)
        ],
        arguments,
    )
    for number, (job, results, shown) in enumerate(zip(jobs, checked, settled.shown, strict=True), start=1):
        if arguments.format == "json":
            print_json(results.as_json())  # a line each
        elif arguments.format == "text":
            remarks = settled.remarks if number == len(jobs) else []
            print_run(shown, results, remarks, simulated=job.plan is not None)
    write_formats(settled.verdict, arguments)
    return settled.status


def run_program(arguments: argparse.Namespace) -> int:
    """`gcodesim run`."""
    begin = time.perf_counter()
    live = _live(arguments)
    window = _window(arguments)
    try:
        return _run_program(arguments, live, window, begin)
    finally:
        if window is not None:
            window.close()
        if live is not None:
            live.close()


def _live(arguments: argparse.Namespace) -> LiveView | None:
    """The live view of the log, if requested."""
    if arguments.live is None:
        return None
    from gcodesim.log.live import LiveView, LiveViewError

    try:
        live = LiveView(arguments.live, arguments.live_from)
    except LiveViewError as reason:
        raise UsageError(str(reason)) from None
    note(f"live at {live.address} : open this as a Foxglove WebSocket connection in Foxglove or Lichtblick")
    return live


def _window(arguments: argparse.Namespace) -> ShownRun | None:
    """The window of the run, if requested."""
    if not arguments.gui:
        return None
    from gcodesim.cli.window import ShownRun
    from gcodesim.world import WorldUnavailable

    try:
        return ShownRun()
    except WorldUnavailable as reason:
        raise UsageError(str(reason)) from None


def refuse_early(arguments: argparse.Namespace) -> None:
    """UsageError, before any work, for a world or an output folder that cannot be had."""
    from gcodesim.world import WorldUnavailable, require_world

    if arguments.only in ("shape", "force") and (arguments.world == BULLET or arguments.live is not None):
        asked = "--live" if arguments.live is not None else "--world bullet"
        raise UsageError(f"{asked} shows a motion, which --only {arguments.only} leaves out")
    if arguments.world is not None:
        try:
            require_world(arguments.world)
        except WorldUnavailable as reason:
            raise UsageError(str(reason)) from None
    if arguments.out.exists() and not arguments.out.is_dir():
        raise UsageError(f"{arguments.out} is a file, not a folder")
    link = None if arguments.force else link_on_the_way(arguments.out)
    if link is not None:
        raise UsageError(
            f"{link} is a link to another folder; name that folder itself with --out, or follow the link with --force"
        )


def _run_program(arguments: argparse.Namespace, live: LiveView | None, window: ShownRun | None, begin: float) -> int:
    from gcodesim.world import WorldUnavailable

    refuse_early(arguments)
    with RunBar() as bar:
        program = read_source(arguments.program, "program")
        loaded = _loaded(arguments, program)
        options, path = _options(arguments, loaded), arguments.program
        with RunStop() as stop:

            def progress(now: Progress) -> None:
                bar(now)
                stop.obey()

            results: Results
            execution: Execution | None
            try:
                if arguments.from_line not in (None, 1):
                    from gcodesim.cli.taking_up import taken_up, tell_refusal

                    taken = taken_up(arguments, program, loaded, options, progress)
                    if taken.program is None:
                        return tell_refusal(arguments, taken)
                    program, options, path = taken.program, taken.options, arguments.out / taken.program.name
                job = _prepared(arguments, program, loaded, options)
                results, execution = run(job, arguments.out, progress, live, window)
            except RunInterrupted as ended:
                results, execution = ended.results, ended.execution
            except WorldUnavailable as reason:
                raise UsageError(str(reason)) from None
            except OSError as error:
                raise UsageError(unwritten(arguments.out, error)) from None
    interrupted = execution is not None and execution.interrupted
    if interrupted or stop.signal:
        arguments.write_baseline = None  # the findings of a partial run are no basis for a baseline
    settled = settle([_met(arguments, path, loaded, job, results)], arguments)
    if arguments.format == "json":
        print_json(results.as_json())
    elif arguments.format == "text":
        print_run(settled.shown[0], results, settled.remarks, simulated=execution is not None, interrupted=interrupted)
        if execution is not None:
            others = [*([CELL_NAME] if loaded.made else []), *([path.name] if path != arguments.program else [])]
            _print_files(arguments.out, results, others)
    write_formats(settled.verdict, arguments)
    if window is not None and not interrupted and sys.stdin.isatty():
        note("close the window to go on; a click on a body says what it is")
        window.stay()
    if not interrupted:
        write_parameters(job.reading, arguments)
    if execution is not None:
        note_effort(begin, results.times.total)
    return stop.status(settled.status, interrupted=interrupted)


def note_effort(begin: float, simulated: float) -> None:
    """What a run took since `begin` of the performance counter, for `simulated` seconds."""
    seconds = time.perf_counter() - begin
    if seconds > 0.0:
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        ratio = f"{simulated / seconds:.3g}"
        note(f"{seconds:.1f} s of computing, {ratio} simulated seconds in a real one, peak memory {memory:.0f} MB")


def unwritten(out: Path, error: OSError) -> str:
    """Report what the system refused, such as writing to a full disk, and where the log is that can still be read."""
    from gcodesim.log import LogWriteError

    reason = error.strerror or str(error)
    name = None if error.filename is None else Path(os.fsdecode(error.filename))
    if name is None:
        told = reason
    elif isinstance(error, LogWriteError):
        told = f"{name}: {reason}"
    else:
        told = f"{name} cannot be {'written' if name.is_relative_to(out) else 'read or written'}: {reason}"
    rest = ""
    if (out / LOG_NAME).exists():
        rest = f"; {out / LOG_NAME} is complete, files beside it are missing"
    elif (out / f"{LOG_NAME}.part").exists():
        rest = f"; what was logged so far is in {out / LOG_NAME}.part, which `gcodesim info` reads"
    return f"{told}{rest}"


def announce_compiling(signature: str, obstacle: str) -> None:
    """Compile what such a run needs on all cores, and say so."""
    from gcodesim.warm_up import warm_up_for

    warm_up_for(signature, obstacle, note)


_TOGETHER_S: Final = 0.2
"""Signals that come no later than this after the first [s] are the same wish."""


class RunStop:
    """Ctrl-C or SIGTERM during a run: the first finishes the current steps and closes the log, a second does not.

    Before the run moves, there is nothing to tell and the first one ends it at once. Two that come together are one:
    `timeout` and shells send theirs to a process and once more to its group.
    """

    signal = 0  # the signal that arrived
    _since_s = 0.0  # when it did
    _moves = False

    def __enter__(self) -> RunStop:
        self._handled = handled(self._ask)
        self._handled.__enter__()
        return self

    def _ask(self, number: int, _frame: FrameType | None) -> None:
        now_s = time.monotonic()
        if not self._moves or (self.signal and now_s - self._since_s > _TOGETHER_S):
            raise Interrupted(number)
        if self.signal:
            return
        self.signal, self._since_s = number, now_s
        # not print: a signal may come while a stream is in use
        os.write(2, b"gcodesim: stopping; the log is closed first (Ctrl-C again stops at once)\n")

    def obey(self) -> None:
        """End the run, which has moved, if that was requested."""
        self._moves = True
        if self.signal:
            raise Interrupted(self.signal)

    def status(self, status: int, *, interrupted: bool) -> int:
        """The exit status of a run that would else have `status`; says if the signal came when the run was over."""
        if self.signal and not interrupted:
            note("interrupted when the run was over; what it wrote is whole")
        return interrupted_by(self.signal or SIGINT) if interrupted or self.signal else status

    def __exit__(self, *_: object) -> None:
        self._handled.__exit__(None, None, None)


class RunBar:
    """A bar with the time left on a terminal, nothing elsewhere. It says `reading` until the first step is done."""

    def __enter__(self) -> RunBar:
        self._bar = None
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

            self._bar = Progress(
                TextColumn("{task.description}"),
                BarColumn(),
                TextColumn("{task.percentage:>3.0f} %"),
                TimeRemainingColumn(),
                console=Console(file=raw(sys.stderr)),
                transient=True,
            )
            self._task = self._bar.add_task("reading", total=None)
            self._bar.start()
        return self

    def __call__(self, progress: Progress) -> None:
        if self._bar is not None:
            block = f"block {progress.row + 1}"
            self._bar.update(self._task, completed=progress.step, total=progress.steps, description=block)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()


def print_run(
    shown: ShownProgram, results: Results, remarks: Sequence[str], *, simulated: bool, interrupted: bool = False
) -> None:
    print_findings(shown.findings, shown.met.sources)
    for remark in remarks:
        print(remark)
    print_count(shown.name, shown.findings, "interrupted, with " if interrupted else "")
    stopped = results.stopped_at
    if not simulated:
        kept = any(finding.code in (OVERWRITES, IN_USE) for finding in results.findings)
        where = "is in the output folder" if kept else "is wrong in the cell"
        print(f"nothing was simulated, because of what {where}")
        return
    if stopped is not None:
        where = f"{stopped.file}:{stopped.line}" if stopped.line else stopped.file
        print(f"stopped at {one_line(where)}; what follows was not simulated")
    print()
    print_table(summary_rows(results))


def _print_files(out: Path, results: Results, others: Sequence[str]) -> None:
    coated = () if results.coating is None else results.coating["bodies"]
    print()
    doses = {name: stock.doses for name, stock in results.stocks.items()}
    painted = () if results.target is None else (results.target.stock,)
    names = names_of(results.stocks, coated, doses, painted, results.inputs.get("only"))
    print(f"  files in {out}: {', '.join([*names, *others])}")
    if LOG_NAME in names:
        print(f"  look at it: open {out / LOG_NAME} in Foxglove or Lichtblick, with the layout that is inside")
