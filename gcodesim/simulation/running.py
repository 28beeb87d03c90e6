"""A job that is carried out: checked without material, or run with its stock."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.files.output_folder import FolderInUseError, claimed, in_use
from gcodesim.jobs.collisions import collisions
from gcodesim.jobs.job import Job
from gcodesim.jobs.outcome import first_error, results_of
from gcodesim.jobs.rehearsal import asks_of_parts, rehearse
from gcodesim.jobs.results import Results
from gcodesim.simulation.run_folder import RunFolder

if TYPE_CHECKING:
    from gcodesim.executor import Execution, Progress
    from gcodesim.log.live import LiveView
    from gcodesim.simulation.one_run import Show


class RunInterrupted(KeyboardInterrupt):
    """Somebody stopped a run. Its results so far are in the log, in its files and here; they are never compared."""

    def __init__(self, results: Results, execution: Execution) -> None:
        super().__init__()
        self.results, self.execution = results, execution


def check(job: Job) -> Results:
    """Results without material: time, distance, travel of the joints, findings of reading, limits and reach.

    A program that probes meets the stock in its shape at the start, since nothing is cut.
    """
    stays = rehearse(job, onward=True) if asks_of_parts(job) else None
    for each in job.all:
        if each.legs is not None:
            while each.legs.onward() is not None:
                pass
            each.legs.tell_of_untouched_stock()
    if job.shop is not None:
        job.findings.extend(collisions(job, rehearse(job) if stays is None else stays))
    return results_of(job, None)


def run(
    job: Job,
    out: Path | None = None,
    progress: Callable[[Progress], None] | None = None,
    live: LiveView | None = None,
    show: Show | None = None,
) -> tuple[Results, Execution | None]:
    """Run the job with its stock; with `out` the log, the results and the stocks are written there.

    `live` shows the log to viewers while it is written, `show` the first machine in a window while it moves.
    Files of the same names that an earlier run left in `out` are deleted first, so that
    nothing old is left beside the results of a run that failed. `WorldUnavailable`
    is raised before anything is touched. The same holds for GS750, where a file there is an
    input or not of gcodesim (unless the job may `force` it), and GS751, where
    another run is writing there. KeyboardInterrupt ends the run: log and
    results are closed as they are, then `RunInterrupted` is raised to the caller.
    """
    from gcodesim.world import require_world

    require_world(job.world)
    if out is None:
        return _run(job, None, progress, live, show)
    folder = RunFolder(job, out)
    try:
        with claimed(out):
            lost = folder.losses()
            return (_refused(job, lost), None) if lost else _run(job, folder, progress, live, show)
    except FolderInUseError:
        return _refused(job, [in_use(Span(job.program.name))]), None


def _refused(job: Job, findings: Sequence[Diagnostic]) -> Results:
    """Results of a job that must not write its files; nothing is touched."""
    job.findings.extend(findings)
    return replace(results_of(job, None, failed=True), stopped_at=findings[0].span)


def _run(
    job: Job,
    folder: RunFolder | None,
    progress: Callable[[Progress], None] | None,
    live: LiveView | None,
    show: Show | None,
) -> tuple[Results, Execution | None]:
    if folder is not None:
        folder.keep_made_cell()
    if not _can_run(job):
        results = results_of(job, None, failed=True)
        results = replace(results, stopped_at=first_error(results.findings))
        if folder is not None:
            folder.keep_results(results)
        return results, None
    if job.others:
        from gcodesim.jobs.meetings import share_shop

        share_shop(job)
    from gcodesim.simulation.one_run import OneRun

    with OneRun(job, folder, live) as one:
        execution = one.execute(progress, show)
        results = one.conclude(execution)
    if execution.interrupted:
        raise RunInterrupted(results, execution)
    return results, execution


def _can_run(job: Job) -> bool:
    """Whether the job is planned and its stock stands; a fault of the cell or of a stock is among its findings."""
    if job.shop is None or job.plan is None or (job.others and job.meetings is None):
        return False
    assert job.legs is not None
    return job.options.only == "motion" or job.legs.stock_up()
