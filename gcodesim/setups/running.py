"""Set-ups run in their order: each takes the stock as an earlier one left it, and is left out where nothing changed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, Literal

from gcodesim.cell import LoadedCell
from gcodesim.cell.leftover import Leftover
from gcodesim.cell.loader import CellChange, read_cell
from gcodesim.cell.verdict import suppressed_findings
from gcodesim.diagnostics import Diagnostic, SourceText, Span
from gcodesim.files.code_digest import code_digest
from gcodesim.files.output_folder import SETUP_NAME, STOCK_SUFFIXES, overwriting
from gcodesim.frozen import frozen
from gcodesim.jobs.job import Job, Options
from gcodesim.jobs.outcome import results_of
from gcodesim.jobs.results import Results
from gcodesim.rs274 import read_program
from gcodesim.setups.memory import forget, key_of, recall, remember
from gcodesim.setups.setup_file import JobFile, Setup
from gcodesim.simulation import RunInterrupted, check, prepare, run

if TYPE_CHECKING:
    from gcodesim.executor import Progress

State = Literal["ran", "unchanged", "interrupted"]
_STOCK = STOCK_SUFFIXES[1]


@frozen(eq=False)
class SetupRun:
    """A set-up that has run, or need not run again because nothing changed: then there are neither job nor `made`.

    `results` is the content of its `results.json`; `folder` where its files are, None without an output folder.
    """

    setup: Setup
    state: State
    loaded: LoadedCell
    results: Mapping[str, Any]
    findings: Sequence[Diagnostic]
    suppressed: Sequence[tuple[Diagnostic, str]]
    sources: Mapping[str, SourceText]
    folder: Path | None
    job: Job | None = None
    made: Results | None = None
    simulated: bool = True


@frozen(eq=False)
class How:
    """How all set-ups of a job run: `said` is what the command line says of reading, `only_check` without material.

    `change` gives single values in the cell of a set-up, by the name of that; `read` reads programs and cells.
    """

    options: Options
    out: Path | None = None
    only_check: bool = False
    allow_paths: Sequence[Path] = ()
    allow_code: bool = False
    said: str = ""
    progress: Callable[[Progress], None] | None = None
    change: Callable[[str, CellChange], CellChange] = lambda _, change: change
    read: Callable[[Path], SourceText] = read_program


def run_setups(job: JobFile, how: How) -> Iterator[SetupRun]:
    """The set-ups of a job, each as soon as it has run; the last one may be `interrupted`.

    OSError if a file cannot be read or written, `WorldUnavailable` if the world cannot be opened here.
    """
    assert job.setups is not None
    code = code_digest()
    with tempfile.TemporaryDirectory(prefix="gcodesim-") as spare:
        nothing = Path(spare) / "-"
        nothing.mkdir()
        left: dict[str, Path] = {}
        for setup in job.setups:
            if setup.skip:
                left[setup.name] = nothing
                continue
            change = how.change(setup.name, setup.change(job.source, job.path.parent, dict(left)))
            left[setup.name] = nothing
            cell = replace(how.read(setup.cell), name=_name_of_cell(setup, job))
            loaded = read_cell(cell, setup.cell, how.allow_paths, allow_code=how.allow_code, change=change)
            done = _run_one(setup, loaded, how, code)
            if done.made is not None and (how.out is None or how.only_check):
                _keep_stocks(done, Path(spare) / setup.name)
                left[setup.name] = Path(spare) / setup.name
            elif done.folder is not None and done.simulated:
                left[setup.name] = done.folder
            yield done
            if done.state == "interrupted":
                return


def _name_of_cell(setup: Setup, job: JobFile) -> str:
    """How findings call the cell: by its file's name, but with its folder if the job file bears the same name."""
    if setup.cell.name != job.source.name:
        return setup.cell.name
    return PurePosixPath(os.path.relpath(setup.cell, job.path.parent)).as_posix()


def _run_one(setup: Setup, loaded: LoadedCell, how: How, code: str) -> SetupRun:
    program = how.read(setup.program)
    folder = None if how.out is None or how.only_check else how.out / setup.name
    key = key_of(program, loaded, how.options, how.said, code)
    sources = {**loaded.sources, program.name: program}
    if folder is not None:
        known = recall(folder, key)
        if known is not None:
            return SetupRun(
                setup=setup,
                state="unchanged",
                loaded=loaded,
                results=known.results,
                findings=known.findings,
                suppressed=known.suppressed,
                sources=sources,
                folder=folder,
            )
    job = prepare(program, loaded, how.options)
    state: State = "ran"
    simulated = job.plan is not None
    if how.only_check:
        _tell_of_uncut_stock(job)
        results = check(job)
    elif folder is not None and (lost := _overwritten(job, folder)):
        job.findings.extend(lost)
        results, simulated = replace(results_of(job, None, failed=True), stopped_at=lost[0].span), False
    else:
        if folder is not None:
            forget(folder)
        try:
            results, execution = run(job, folder, how.progress)
        except RunInterrupted as ended:
            results, execution, state = ended.results, ended.execution, "interrupted"
        simulated = execution is not None
    suppressed = [
        (finding, entry.reason)
        for each in job.all
        for finding, entry in suppressed_findings(each.findings, job.cell, each.program, job.options.today)
    ]
    if folder is not None and simulated and state == "ran":
        remember(folder, key, job, results.findings, suppressed)
    return SetupRun(
        setup=setup,
        state=state,
        loaded=loaded,
        results=results.as_json(),
        findings=results.findings,
        suppressed=suppressed,
        sources={name: source for each in reversed(job.all) for name, source in each.sources.items()} | sources,
        folder=folder,
        job=job,
        made=results,
        simulated=simulated,
    )


def _overwritten(job: Job, folder: Path) -> list[Diagnostic]:
    if job.options.force:
        return []
    return overwriting(folder, [SETUP_NAME], (), Span(job.program.name))


def _tell_of_uncut_stock(job: Job) -> None:
    """GS919 for each stock that an earlier set-up would have cut."""
    if job.cell is None:
        return
    for name, spec in job.cell.stocks.items():
        if isinstance(spec.shape, Leftover):
            job.findings.add(
                Diagnostic(
                    code="GS919",
                    span=job.cell.span("stock", name, "from"),
                    message=f"`{spec.shape.name}` hands its stock on uncut: a check cuts nothing",
                    hint="`gcodesim run` goes on with what is left by then",
                )
            )


def _keep_stocks(done: SetupRun, folder: Path) -> None:
    """The stocks as they are now, for later set-ups of a run without files, and of a check, which cuts nothing."""
    folder.mkdir()
    assert done.job is not None
    if done.job.legs is None or not done.job.legs.stock_up() or done.job.shop is None:
        return
    for name, placed in done.job.shop.stocks.items():
        placed.stock.save(folder / f"{name}{_STOCK}")
