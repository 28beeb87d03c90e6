"""A program in a cell, read and planned: its job."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from gcodesim.canon import Axes
from gcodesim.cell import Cell, LoadedCell
from gcodesim.cell.cell import MAIN
from gcodesim.cell.language import settings_of_cell
from gcodesim.cell.reach import reach_findings
from gcodesim.checks.idle import idle_findings
from gcodesim.diagnostics import Diagnostic, Findings, Severity, SourceText, Span
from gcodesim.jobs.cast import cast_of, is_of_cell
from gcodesim.jobs.job import KINEMATIC, Job, Options
from gcodesim.planning.shop_posing import bearers_of
from gcodesim.rs274 import Settings, interpret
from gcodesim.shop import Shop, open_shop

if TYPE_CHECKING:
    from gcodesim.executor.watcher import Watcher

    Show = Callable[[Job, Watcher | None], Watcher]
    """Puts a watcher that shows the run before the one that there is."""


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
            from gcodesim.jobs.meetings import meet

            job.meetings = meet(jobs, _reread)
    return job


def _reread(job: Job, marks: int | None) -> None:
    """Read and plan the job again; up to the mark at which its program waits for ever, if it passes so many before."""
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
    job.shop, job.bearers = shop, bearers_of(shop, {})
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
