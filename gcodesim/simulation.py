"""A program in a cell: read, planned, checked, run. Both the command line and the Python API call this."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gcodesim.canon import Axes
from gcodesim.cell import Cell, LoadedCell
from gcodesim.cell.cell import MAIN
from gcodesim.cell.language import settings_of_cell
from gcodesim.cell.reach import reach_findings
from gcodesim.checks.coarse import coarse_findings
from gcodesim.checks.idle import idle_findings
from gcodesim.checks.missing_length import cutting_without_length
from gcodesim.diagnostics import Diagnostic, Findings, Severity, SourceText, Span
from gcodesim.files.output_folder import (
    CELL_NAME,
    RESULTS_NAME,
    FolderInUseError,
    claimed,
    forget,
    in_use,
    names_of,
    other_cell,
    overwriting,
)
from gcodesim.files.whole_file import write_whole
from gcodesim.jobs.beam_beyond import beyond_findings
from gcodesim.jobs.cast import cast_of, is_of_cell
from gcodesim.jobs.coating import film_findings, film_names
from gcodesim.jobs.collisions import collisions
from gcodesim.jobs.job import KINEMATIC, Job, Options
from gcodesim.jobs.loose_pieces import fallen_pieces
from gcodesim.jobs.meetings import meet, share_shop
from gcodesim.jobs.outcome import first_error, results_of
from gcodesim.jobs.rehearsal import asks_of_parts, rehearse
from gcodesim.jobs.results import Results
from gcodesim.processes import PROCESSES
from gcodesim.rs274 import Settings, interpret
from gcodesim.shop import Shop, open_shop

if TYPE_CHECKING:
    from gcodesim.executor import Execution, Progress
    from gcodesim.executor.halt import RunHalt
    from gcodesim.executor.record import StepRecord
    from gcodesim.executor.totals import JointTotals, RowTotals
    from gcodesim.executor.track import Watcher
    from gcodesim.jobs.inspection import Inspector
    from gcodesim.log.live import LiveView
    from gcodesim.observation.eyes import Eyes
    from gcodesim.planning import Plan
    from gcodesim.recorder import Recorder

    Show = Callable[[Job, Watcher | None], Watcher]
    """Puts a watcher that shows the run before the one that there is."""


class RunInterrupted(KeyboardInterrupt):
    """Somebody stopped a run. Its results so far are in the log, in its files and here; they are never compared."""

    def __init__(self, results: Results, execution: Execution) -> None:
        super().__init__()
        self.results, self.execution = results, execution


def prepare(program: SourceText, loaded: LoadedCell, options: Options | None = None) -> Job:
    """Read the program and plan its motion in the cell; all findings so far are in the job.

    With programs for further channels, in `options` or in the cell, all of them: the job is that of the first channel,
    and has the `others`, all timed so that they wait for each other.
    """
    options = options or Options()
    if loaded.cell is None:
        return _prepared(program, loaded, options, MAIN, running=())
    known = loaded.cell.channels
    cast = cast_of(loaded.cell, program, {name: text for name, text in options.channels.items() if name in known})
    jobs = [_prepared(text, loaded, options, name, running=tuple(cast)) for name, text in cast.items()]
    job = jobs[0]
    job.findings.extend(
        Diagnostic(
            code="GS712",
            span=loaded.cell.span("channels"),
            message=f"there is no channel `{name}`, for which a program is named",
            hint=f"channels are {', '.join(f'`{each}`' for each in known)}",
        )
        for name in options.channels
        if name not in known
    )
    if len(jobs) > 1:
        job.others = jobs[1:]
        if all(each.plan is not None for each in jobs):
            job.meetings = meet(jobs, _reread)
    return job


def _reread(job: Job, marks: int) -> None:
    """Read and plan the job again, up to the mark at which its program waits for ever: it passes so many before."""
    of_cell = [finding for finding in job.findings if is_of_cell(finding, job)]
    job.findings, job.plan, job.events, job.probings = Findings(), None, (), []
    _read_and_plan(job, running=("", job.channel), marks=marks)
    known = set(job.findings)
    job.findings.extend(finding for finding in of_cell if finding not in known)


def _prepared(
    program: SourceText, loaded: LoadedCell, options: Options, channel: str, *, running: Sequence[str]
) -> Job:
    """One program in the cell, read and planned, by itself or one of those that are `running`, the first of them first.

    What is wrong with the cell as a whole is told with the first.
    """
    job = Job(
        program=program,
        loaded=loaded,
        options=options,
        findings=Findings(),
        channel=channel,
        alone=len(running) < 2,
        sources={**loaded.sources, **options.sources, program.name: program},
    )
    if not running or channel == running[0]:
        job.findings.extend(loaded.findings)
        job.findings.extend(options.findings)
    if loaded.cell is not None:
        _read_and_plan(job, running)
    return job


def _read_and_plan(job: Job, running: Sequence[str], marks: int | None = None) -> None:
    """Open the shop of a job, read its program, or a part up to one of its marks, and plan it."""
    cell = job.cell
    assert cell is not None
    shop = open_shop(cell, job.channel)
    standing = standing_findings(shop)
    job.findings.extend(standing)
    if any(finding.level >= Severity.ERROR for finding in standing):
        return
    job.shop = shop
    if not running or job.channel == running[0]:
        job.findings.extend(_world_notes(job))
        job.findings.extend(idle_findings(cell, running or (shop.channel,)))
    settings, problems = settings_of_cell(cell, shop.channel, shop.placement)
    job.findings.extend(problems)
    settings = replace(
        job.options.settings(settings),
        start=_start(shop),
        joint_home=not shop.mover.joints_are_axes,
        answered=True,
    )
    job.reading = interpret(job.program, settings)
    from gcodesim.jobs.legs import Legs

    job.legs = Legs(job, settings.start, marks=marks)
    job.legs.onward()


def standing_findings(shop: Shop) -> list[Diagnostic]:
    """GS725, GS726, GS734: findings about the place of the work of the shop's channel."""
    return [*shop.placement.findings, *reach_findings(shop.cell, shop.channel, shop.placement)]


def layout_findings(cell: Cell) -> list[Diagnostic]:
    """What is wrong with a cell that was read without error: places and tool tables of all its channels, no notes."""
    found: list[Diagnostic] = []
    for channel in cell.channels:
        shop = open_shop(cell, channel)
        found += standing_findings(shop)
        found += settings_of_cell(cell, channel, shop.placement)[1]
    return [finding for finding in dict.fromkeys(found) if finding.level > Severity.NOTE]


def settings_in_cell(cell: Cell) -> tuple[Settings, list[Diagnostic]]:
    """Settings with which `prepare` reads the program of the cell's main channel, and what is wrong with them."""
    shop = open_shop(cell, MAIN)
    settings, problems = settings_of_cell(cell, shop.channel, shop.placement)
    return replace(settings, start=_start(shop), joint_home=not shop.mover.joints_are_axes), problems


def _world_notes(job: Job) -> list[Diagnostic]:
    assert job.cell is not None
    if job.options.world is None and job.cell.simulation.world is None and job.world == KINEMATIC:
        return [
            Diagnostic(
                code="GS731",
                span=Span(job.cell.name),
                message="pybullet is not installed: the kinematic world runs, without dynamics",
                hint="it has wheels for Python 3.11 on x86-64 Linux; `world: kinematic` says that this is meant",
            )
        ]
    return []


def _start(shop: Shop) -> Axes:
    """Where the controlled point is at first, in M, without tool offset."""
    from gcodesim.planning import posing_of

    return posing_of(shop).start(shop.kinematics, shop.home)


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
    span = Span(job.program.name)
    try:
        with claimed(out):
            names = _names(job.shop, out)
            lost = [] if job.options.force else overwriting(out, names, _inputs(job), span)
            if job.loaded.made and not job.options.force:
                lost += other_cell(out, job.loaded.sources[job.loaded.files[0].name].raw, span)
            if lost:
                return _refused(job, lost), None
            return _run(job, out, progress, live, show)
    except FolderInUseError:
        return _refused(job, [in_use(span)]), None


def _refused(job: Job, findings: Sequence[Diagnostic]) -> Results:
    """Results of a job that must not write its files; nothing is touched."""
    job.findings.extend(findings)
    return replace(results_of(job, None, failed=True), stopped_at=findings[0].span)


def _run(
    job: Job,
    out: Path | None,
    progress: Callable[[Progress], None] | None,
    live: LiveView | None,
    show: Show | None,
) -> tuple[Results, Execution | None]:
    from gcodesim.executor import TrackPlan, execute_together
    from gcodesim.jobs.inspection import Inspector
    from gcodesim.jobs.pace import pacing_of

    if out is not None and job.loaded.made:
        write_whole(out / CELL_NAME, job.loaded.sources[job.loaded.files[0].name].raw)
    if job.shop is None or job.plan is None or job.cell is None or (job.others and job.meetings is None):
        return _not_run(job, out), None
    assert job.legs is not None
    only = job.options.only
    if only != "motion" and not job.legs.stock_up():
        return _not_run(job, out), None
    if job.others:
        share_shop(job)
    coarse = {each.channel: _coarse(each) for each in job.all}
    bodies = {each.channel: each.legs.watch_stocks() for each in job.all if each.legs is not None}
    recorder = None
    if out is not None:
        forget(out, _names(job.shop, out))
    if out is not None and only in (None, "motion"):
        from gcodesim.recorder import Recorder as Writing

        recorder = Writing(job, out, live)
    execution = None
    freely = job.world != KINEMATIC
    inspectors = {
        each.channel: Inspector(*_inspected(each), freely=freely, bodies=bodies[each.channel]) for each in job.all
    }

    def onward(halt: RunHalt) -> Plan | None:
        """The next leg, if the program has one; whoever watches the run gets to know it."""
        if job.others:  # all legs have been planned, or there would be no common clock
            return None
        assert job.legs is not None
        known = set(job.findings)
        plan = job.legs.onward(halt)
        if recorder is not None:
            recorder.expect(job.shown(finding for finding in job.findings if finding not in known))
        if plan is not None:
            inspectors[job.channel].follow(plan)
        return plan

    def brought_by(each: Job, watcher: Watcher | None) -> TrackPlan:
        assert each.plan is not None and each.shop is not None
        inspector = inspectors[each.channel]

        def inspect(record: StepRecord, rows: RowTotals, joints: JointTotals) -> list[Diagnostic]:
            if each.seen is not None:
                each.seen(record)
            return each.shown(inspector.fresh(record, rows, joints))

        return TrackPlan(
            plan=each.plan, shop=each.shop, inspect=inspect, watcher=watcher, only=only, bodies=bodies[each.channel]
        )

    watchers: list[Watcher | None] = [None for _ in job.all] if recorder is None else [recorder, *recorder.others]
    eyes = _eyes(job, recorder, out)
    if eyes is not None:
        watchers[0] = eyes
    if show is not None:
        watchers[0] = show(job, watchers[0])
    try:
        execution = execute_together(
            [brought_by(each, watcher) for each, watcher in zip(job.all, watchers, strict=True)],
            world_name=job.world,
            pacing=pacing_of(job),
            progress=progress,
            onward=onward,
        )
        if execution.interrupted:
            job.legs.stop()
        for each, own in zip(job.all, (execution, *execution.others), strict=True):
            _inspect_all(each, inspectors[each.channel], own, coarse=coarse[each.channel])
        if job.shop is not None:
            job.findings.extend(film_findings(job.shop))
            job.findings.extend(_collisions(job, execution))
        if eyes is not None:
            eyes.close()
            job.findings.extend(eyes.findings())
            job.sensed = eyes.results
        for each, own in zip(job.all, (execution, *execution.others), strict=True):
            each.findings.extend(beyond_findings(each, own))
        if only == "motion":
            job.legs.tell_of_untouched_stock()
        for each, own in zip(job.all, (execution, *execution.others), strict=True):
            for name, piece in fallen_pieces(each, own):
                job.fallen.setdefault(name, []).append(piece)
        if job.cell.target is not None and only in (None, "shape"):
            from gcodesim.jobs.verification import verify

            job.target, found = verify(job, execution)
            job.findings.extend(found)
        results = results_of(job, execution)
        if recorder is not None:
            recorder.finish(results, execution)
        elif out is not None and job.shop is not None:
            from gcodesim.recorder.result_files import write_files

            write_files(out, job.shop, results, job.skins, shapes=only != "force")
    finally:
        if recorder is not None:
            recorder.abandon()
    if execution.interrupted:
        raise RunInterrupted(results, execution)
    return results, execution


def _eyes(job: Job, recorder: Recorder | None, out: Path | None) -> Eyes | None:
    """What reads the sensors of the cell, and lets the log watch as well; None without sensors."""
    from gcodesim.observation.schedule import stations_of

    assert job.shop is not None and job.cell is not None
    if not stations_of(job.cell):
        return None
    from gcodesim.observation.eyes import Eyes
    from gcodesim.observation.files import SensorFiles

    return Eyes(
        job.shop,
        job.cell.simulation.step_ns,
        job.cell.simulation.seed,
        inner=recorder,
        outlet=None if recorder is None else recorder.sensed,
        files=None if out is None else SensorFiles(out),
    )


def _collisions(job: Job, execution: Execution) -> list[Diagnostic]:
    """What has hit what, as far as the run went."""
    assert job.cell is not None and job.shop is not None
    end = execution.steps * job.cell.simulation.step_ns * 1e-9 if execution.interrupted else None
    stays = execution.stays if job.shop.moves_parts else None
    return list(collisions(job, stays, end))


def _coarse(job: Job) -> bool:
    """Whether a stock is too coarse for a tool, which is reported."""
    assert job.shop is not None and job.plan is not None
    found = list(coarse_findings(job.shop, job.plan))
    job.findings.extend(found)
    return bool(found)


def _inspected(job: Job) -> tuple[Plan, Shop, int]:
    assert job.plan is not None and job.shop is not None and job.cell is not None
    return job.plan, job.shop, job.cell.simulation.step_ns


def _inspect_all(job: Job, inspector: Inspector, execution: Execution, *, coarse: bool) -> None:
    """Add the findings of a whole run; `coarse`: the grid has been reported before."""
    assert job.shop is not None and job.plan is not None
    job.findings.extend(inspector.final(execution))
    job.findings.change(cutting_without_length(job.findings, job.plan, job.shop, execution.rows["removed"]))
    if not coarse:
        job.findings.extend(coarse_findings(job.shop, job.plan))


def _not_run(job: Job, out: Path | None) -> Results:
    """Results of a job that cannot start because of a fault in the cell or its stock."""
    results = results_of(job, None, failed=True)
    results = replace(results, stopped_at=first_error(results.findings))
    if out is not None:
        forget(out, _names(job.shop, out))
        write_whole(out / RESULTS_NAME, results.text().encode())
    return results


def _names(shop: Shop | None, out: Path) -> list[str]:
    """The files that a run in this shop writes into `out`, and those that its sensors have left there."""
    if shop is None:
        return names_of(())
    from gcodesim.observation.files import names_left
    from gcodesim.observation.schedule import stations_of

    kinds = [kind for kind in shop.sheet.kinds[1:] if getattr(PROCESSES[kind], "dose", "")]
    doses = {name: [PROCESSES[kind].dose for kind in kinds] for name in shop.cell.stocks}
    painted = shop.cell.stocks if shop.cell.target is not None else ()
    own = names_of(shop.cell.stocks, film_names(shop.cell.coats), doses, painted)
    return [*own, *names_left(out, stations_of(shop.cell))]


def _inputs(job: Job) -> list[Path]:
    """All inputs of a job that were read from files."""
    read = [source.folder / source.name for source in job.sources.values() if source.folder is not None]
    return [*read, *(file.path for file in job.loaded.files)]
