"""`run` and `check` of a job file: set-up after set-up, then one verdict on all."""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcodesim import compiled
from gcodesim.cli.exits import UsageError
from gcodesim.cli.formats import write_formats
from gcodesim.cli.judging import Met, settle
from gcodesim.cli.language import files_of, said_of_reading
from gcodesim.cli.options import read_source
from gcodesim.cli.output import print_count, print_findings, print_json, print_table
from gcodesim.cli.simulate import (
    RunBar,
    RunStop,
    announce_compiling,
    note_effort,
    options_of,
    print_run,
    refuse_early,
    unwritten,
)
from gcodesim.diagnostics import Span
from gcodesim.files.output_folder import SETUPS_NAME, overwriting
from gcodesim.files.whole_file import write_whole
from gcodesim.numbers import clean
from gcodesim.setups.results import setup_rows, setups_as_json
from gcodesim.setups.running import How, SetupRun, run_setups
from gcodesim.setups.setup_file import JobFile, folders_of_job, read_job_file

if TYPE_CHECKING:
    from gcodesim.executor import Progress


def run_job(arguments: argparse.Namespace) -> int:
    """`gcodesim run JOB`."""
    begin = time.perf_counter()
    _refuse(arguments, ("live", "gui", "write_parameters", "from_line"))
    refuse_early(arguments)
    job = _job(arguments, arguments.program)
    if job.setups is None:
        return _faulty(job, arguments)
    path = arguments.out / SETUPS_NAME
    if not arguments.force and overwriting(arguments.out, [SETUPS_NAME], (), Span(job.source.name)):
        raise UsageError(f"{path} was not written by gcodesim; give the run a folder by --out, or --force it")
    with RunBar() as bar, RunStop() as stop:

        def progress(now: Progress) -> None:
            bar(now)
            stop.obey()

        done: list[SetupRun] = []
        with _told(arguments.out):
            for one in run_setups(job, _how(job, arguments, progress, out=arguments.out)):
                done.append(one)
                if stop.signal:
                    break
    planned = sum(not setup.skip for setup in job.setups)
    interrupted = bool(done) and (len(done) < planned or done[-1].state == "interrupted")
    if interrupted or stop.signal:
        arguments.write_baseline = None
    if not interrupted:
        text = json.dumps(clean(setups_as_json(done)), indent=1, ensure_ascii=False)
        with _told(arguments.out):
            write_whole(path, f"{text}\n".encode())
    status = _tell(job, done, arguments)
    if arguments.format == "text":
        folders = ", ".join(one.setup.name for one in done if one.folder is not None)
        if interrupted:
            print(f"\n  interrupted: {len(done)} of {planned} set-ups began; folders in {arguments.out}: {folders}")
        else:
            print(f"\n  {path} has the results of all; folders beside it: {folders}")
        print(f"  look at it: `gcodesim report {arguments.out}`")
    note_effort(begin, sum(one.results["time"]["total_s"] for one in done if one.state != "unchanged"))
    return stop.status(status, interrupted=interrupted)


def check_job(arguments: argparse.Namespace) -> int:
    """`gcodesim check JOB`."""
    if len(arguments.programs) > 1:
        raise UsageError("a job is checked by itself: one YAML file, or programs in one cell")
    _refuse(arguments, ())
    job = _job(arguments, arguments.programs[0])
    if job.setups is None:
        return _faulty(job, arguments)
    return _tell(job, list(run_setups(job, _how(job, arguments, None))), arguments)


def _refuse(arguments: argparse.Namespace, others: Sequence[str]) -> None:
    """UsageError for options that go with one program only."""
    given = [name for name in ("cell", "channel", *others) if getattr(arguments, name) not in (None, {}, False)]
    if given:
        option = given[0].replace("_", "-")
        raise UsageError(f"--{option} does not go with a job, whose set-ups name their programs and cells themselves")


def _job(arguments: argparse.Namespace, path: Path) -> JobFile:
    compiled.when_cold = announce_compiling
    return read_job_file(read_source(path, "job"), path, (*folders_of_job(path), *arguments.allow_path))


def _how(job: JobFile, arguments: argparse.Namespace, progress: Any, out: Path | None = None) -> How:
    return How(
        options=options_of(arguments),
        out=out,
        only_check=out is None,
        allow_paths=(*folders_of_job(job.path), *arguments.allow_path),
        allow_code=arguments.allow_code,
        said=said_of_reading(arguments),
        progress=progress,
    )


@contextmanager
def _told(out: Path) -> Iterator[None]:
    """UsageError for what the system refuses."""
    from gcodesim.world import WorldUnavailable

    try:
        yield
    except WorldUnavailable as reason:
        raise UsageError(str(reason)) from None
    except OSError as error:
        raise UsageError(unwritten(out, error)) from None


def _faulty(job: JobFile, arguments: argparse.Namespace) -> int:
    """What is wrong with the job file itself; nothing has run."""
    met = Met(
        program=job.path,
        findings=list(job.findings),
        sources={job.source.name: job.source},
        files=lambda: {job.source.name: job.path},
    )
    settled = settle([met], arguments)
    if arguments.format == "json":
        from gcodesim.cli.output import findings_as_json

        print_json({"findings": findings_as_json(job.findings)})
    elif arguments.format == "text":
        print_findings(settled.shown[0].findings, met.sources)
        print_count(settled.shown[0].name, settled.shown[0].findings)
        print("nothing was simulated, because of what is wrong in the job")
    write_formats(settled.verdict, arguments)
    return settled.status


def _met(job: JobFile, one: SetupRun, arguments: argparse.Namespace) -> Met:
    readings = () if one.job is None else [each.reading for each in one.job.all if each.reading is not None]
    folders = list(dict.fromkeys(folder for reading in readings for folder in reading.settings.subroutines))
    program = one.setup.program
    return Met(
        program=program,
        cell=one.setup.cell,
        findings=one.findings,
        suppressed=one.suppressed,
        sources=one.sources,
        files=lambda: {job.source.name: job.path} | files_of(arguments, program, one.sources, folders, one.loaded),
        results=one.results,
        setup=one.setup.name,
    )


def _tell(job: JobFile, done: Sequence[SetupRun], arguments: argparse.Namespace) -> int:
    """Print what was found and left of each set-up, and one table of all; the exit status."""
    if not done:
        raise UsageError(f"{os.fspath(job.path)} leaves out all of its set-ups")
    settled = settle([_met(job, one, arguments) for one in done], arguments)
    if arguments.format == "json":
        print_json(clean(setups_as_json(done)))
    elif arguments.format == "text":
        for one, shown in zip(done, settled.shown, strict=True):
            print(f"== {one.setup.name}: {one.setup.program.name} in {one.setup.cell.name}")
            if one.made is None:
                print_findings(shown.findings, shown.met.sources)
                print_count(shown.name, shown.findings, "unchanged since the last run, with ")
            else:
                stopped = one.state == "interrupted"
                print_run(shown, one.made, (), simulated=one.simulated, interrupted=stopped)
            print()
        for remark in settled.remarks:
            print(remark)
        print_table(setup_rows(done))
    write_formats(settled.verdict, arguments)
    return settled.status
