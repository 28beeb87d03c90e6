"""From a job and its execution to the results for files and people."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

from gcodesim.cell.standing import standing_of
from gcodesim.cell.verdict import idle_suppressions
from gcodesim.diagnostics import Diagnostic, Severity, SourceText, Span
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.jobs.coating import coating_of
from gcodesim.jobs.grips import part_results
from gcodesim.jobs.job import Job
from gcodesim.jobs.joint_results import joint_results
from gcodesim.jobs.operations import RowTimes, operation_rows, pace_figures
from gcodesim.jobs.paces import row_paces
from gcodesim.jobs.printing import printing_of
from gcodesim.jobs.results import (
    BodyResult,
    DoseResult,
    FallenPiece,
    Results,
    StockResult,
    Times,
    TurnedResult,
    joint_rows,
    line_rows,
    tool_rows,
)
from gcodesim.motion.tool_path import HOME, RAPID
from gcodesim.numbers import rounded
from gcodesim.processes.column import LINES, REMOVED, RESULTS
from gcodesim.processes.melting import METALS, mostly
from gcodesim.rs274.marlin.estimate import estimate_in
from gcodesim.shop import PlacedStock, Shop
from gcodesim.solids.mass import mass_of_skin
from gcodesim.units import MM
from gcodesim.version import __version__

if TYPE_CHECKING:
    from gcodesim.canon import Event
    from gcodesim.executor import Execution
    from gcodesim.executor.accuracy import PathAccuracy
    from gcodesim.material.revolved import Revolved
    from gcodesim.material.stock import Stock
    from gcodesim.motion.standing import Standstill
    from gcodesim.motion.trajectory import TimedEvent
    from gcodesim.planning import Plan

PROFILE_TOLERANCE: Final = 1e-6
"""By how much [m] the outlines of a turned part in the results may be beside those of the run."""

INTERRUPTED: Final = "GS616"
"""The finding of a run that somebody stopped."""


def inputs_of(job: Job) -> dict[str, Any]:
    """The inputs by name and hash; no folder of this machine."""
    simulation = job.cell.simulation if job.cell is not None else None
    own, *others = job.loaded.files
    return {
        "gcodesim": __version__,
        "seed": simulation.seed if simulation is not None else None,
        "world": job.world,
        **({} if job.options.only is None else {"only": job.options.only}),
        **({} if job.options.from_line is None else {"from_line": job.options.from_line}),
        "program": {"name": job.program.name, "sha256": job.program.sha256},
        "cell": {"name": own.name, "sha256": own.sha256},
        "files": [
            {"name": name, "sha256": digest}
            for name, digest in sorted(
                {
                    **{file.name: file.sha256 for file in others},
                    **{s.name: s.sha256 for s in job.sources.values() if _is_called(job, s)},
                }.items()
            )
        ],
    }


def _is_called(job: Job, source: SourceText) -> bool:
    """Whether `source` is a subprogram: read with the program, but not the program itself."""
    return job.reading is not None and source.name in job.reading.sources and source.name != job.program.name


def results_of(job: Job, execution: Execution | None, *, failed: bool = False) -> Results:
    """The results of a job; of several programs at once those of all, with the executions of `execution.others`."""
    own = _results_of(job, execution, failed=failed)
    if execution is not None and job.shop is not None:
        totals = [execution.rows, *(other.rows for other in execution.others)]
        own = replace(own, coating=coating_of(job.shop, totals))
    if not job.others:
        return own
    ran = None if execution is None else execution.others
    each = [own] + [
        _results_of(other, None if ran is None else ran[index], failed=failed) for index, other in enumerate(job.others)
    ]
    return joint_results(job.all, each, ran=execution is not None)


def _results_of(job: Job, execution: Execution | None, *, failed: bool) -> Results:
    interrupted = execution is not None and execution.interrupted
    failed = failed or job.cell is None or job.stopped_at is not None or interrupted
    everything = list(job.findings)
    if job.cell is not None and not failed:
        whole = execution is not None and job.options.only is None
        everything += idle_suppressions(everything, job.cell, job.program, ran=whole)
        everything.sort(key=lambda finding: finding.order)
    findings = job.shown(everything)
    worst = max((finding.level for finding in findings), default=None)
    fail_on = job.options.fail_on
    bad = worst is not None and fail_on is not None and worst >= fail_on
    if job.plan is None or job.shop is None:
        return Results(
            status="failed",
            stopped_at=first_error(findings),
            inputs=inputs_of(job),
            findings=findings,
            times=Times(),
            feed_distance=0.0,
            rapid_distance=0.0,
            not_simulated=_not_simulated(job),
        )
    plan, shop = job.plan, job.shop
    path = plan.path
    totals = None if execution is None else execution.rows
    length = path.length
    rapid = (path.kind == RAPID) | (path.kind == HOME)
    row_time = plan.trajectory.row_time
    ran: int | None = None
    stopped = job.stopped_at
    if execution is not None and execution.interrupted:  # what never ran does not count
        stop = _stop_of(plan, _end_ns(job, plan, execution))
        ran = stop.row + 1
        length, row_time = length.copy(), row_time.copy()
        length[ran:] = row_time[ran:] = 0.0
        length[ran - 1 : ran] *= stop.share  # of its time; of its path a little less while it speeds up
        row_time[ran - 1 : ran] *= stop.share
        stopped = stop.span
        findings = sorted([*findings, _interrupted(job, stop)], key=lambda finding: finding.order)
    rests = _rests(plan, _end_ns(job, plan, execution))
    names = {number: tool.name for number, tool in shop.cell.tools.items()}
    stands = [(rest.row, rest.event.span, rest.duration) for rest in rests]
    own = shop.sheet.own(RESULTS)
    paces = row_paces(plan.trajectory)
    engaged = None if totals is None or job.options.only == "motion" else totals["engaged"]
    removed = None if totals is None else totals[REMOVED.name]
    known = RowTimes(time=row_time, distance=length, paces=paces, stands=stands, engaged=engaged, removed=removed)
    return Results(
        status="failed" if failed else "findings" if bad else "ok",
        stopped_at=stopped,
        inputs=inputs_of(job),
        findings=findings,
        times=_times(rests, rapid, row_time, execution, standing_of(shop.cell, shop.channel)),
        feed_distance=float(length[~rapid].sum()),
        rapid_distance=float(length[rapid].sum()),
        stocks={} if execution is None else _stock_results(shop, execution, job.fallen),
        tools=tool_rows(path, names, row_time, length, totals, own, lambda rows: pace_figures(rows, path, known)),
        operations=operation_rows(path, job.program.name, job.program.table, names, known),
        joints=_joints(plan, shop, execution),
        not_simulated=_not_simulated(job),
        probings=[probing for probing in job.probings if probing.time * 1e9 <= _end_ns(job, plan, execution)],
        lines=line_rows(path, row_time, length, totals, stands, ran, shop.sheet.own(LINES), paces),
        printing=printing_of(plan, shop.cell.tools, row_time, estimate_in(job.program)),
        path_accuracy=None if execution is None else _accuracy_of(plan, execution.accuracy),
        parts={} if execution is None else part_results(execution.parts, lambda frame: frame.rpartition("/")[2]),
        columns=own,
        sensors=job.sensed if execution is not None else {},
        target=job.target,
    )


def _accuracy_of(plan: Plan, accuracy: PathAccuracy | None) -> dict[str, Any] | None:
    """Path accuracy as in `results.json`."""
    if accuracy is None or not accuracy.count:
        return None
    return {
        "AT_mm": rounded(accuracy.greatest / MM),
        "line_of_AT": plan.path.span(accuracy.row).line if accuracy.row >= 0 else None,
        "time_of_AT_s": rounded(accuracy.time),
        "AT_engaged_mm": rounded(accuracy.cutting / MM),
        "rms_mm": rounded(accuracy.mean / MM),
    }


def first_error(findings: Sequence[Diagnostic]) -> Span | None:
    return next((finding.span for finding in findings if finding.level >= Severity.ERROR), None)


def _end_ns(job: Job, plan: Plan, execution: Execution | None) -> int:
    """When the run ended: at the end of the plan, or with the step after which it was interrupted."""
    if execution is None or not execution.interrupted or job.cell is None:
        return plan.trajectory.duration_ns
    return execution.steps * job.cell.simulation.step_ns


@frozen
class _Stop:
    """Where a run was interrupted: at `time` [s], in path row `row`, of which `share` had run, in the block of `span`.

    `row` is -1 and `span` None when no block had begun.
    """

    time: float
    row: int
    share: float
    span: Span | None


def _stop_of(plan: Plan, end_ns: int) -> _Stop:
    """The last block that had begun, as in the log: one that moves, or one during which the machine stands."""
    path, trajectory, end = plan.path, plan.trajectory, end_ns * 1e-9
    row, share, span, order = -1, 0.0, None, (-1, -1)
    if len(path):
        row = max(int(np.searchsorted(trajectory.row_ns[0], end_ns, side="right")) - 1, 0)
        begin, until = float(trajectory.row_start[row]), float(trajectory.row_end[row])
        share = min(max((end - begin) / max(until - begin, 1e-12), 0.0), 1.0)
        first = int(np.searchsorted(path.block, path.block[row]))  # blocks only grow along a path
        span, order = path.span(first), (int(trajectory.row_ns[0][first]), 2 * first + 1)
    for timed in trajectory.events:
        place = (round(timed.time * 1e9), 2 * timed.row)
        if place[0] <= end_ns and place >= order and timed.event.span.line:
            span, order = timed.event.span, place
    return _Stop(time=end, row=row, share=share, span=span)


def _interrupted(job: Job, stop: _Stop) -> Diagnostic:
    return Diagnostic(
        code=INTERRUPTED,
        span=stop.span or Span(job.program.name),
        message=f"the run was interrupted after {stop.time:.3f} s; what follows was not simulated",
        hint="run it again: numbers and shapes are those of the part that ran",
        time=stop.time,
    )


def _rests(plan: Plan, end_ns: int) -> list[TimedEvent]:
    """The events during which the machine stood still until `end_ns`, of those that had begun."""
    rests = (event for event in plan.trajectory.events if event.duration > 0.0)
    begun = ((event, end_ns - round(event.time * 1e9)) for event in rests)
    return [replace(event, duration=min(event.duration, left * 1e-9)) for event, left in begun if left >= 0]


def _times(
    rests: Sequence[TimedEvent], rapid: Any, row_time: Array, execution: Execution | None, standing: Standstill
) -> Times:
    """Where the time goes, from the time law."""
    from gcodesim.canon import Spindle, ToolChange, ToolNumber

    def stood(of: Callable[[Event], bool]) -> float:
        return float(sum(e.duration for e in rests if of(e.event)))

    changes = (ToolChange, ToolNumber)
    change = stood(lambda event: isinstance(event, changes))
    spindle = stood(lambda event: isinstance(event, Spindle))
    awaited = standing.switching
    devices = 0.0 if awaited is None else stood(lambda event: awaited(event) > 0.0)
    dwell = stood(
        lambda event: not isinstance(event, (*changes, Spindle)) and (awaited is None or awaited(event) == 0.0)
    )
    feed = float(row_time[~rapid].sum())
    engaged = 0.0
    if execution is not None and len(row_time):
        engaged = float(np.minimum(execution.rows["engaged"], row_time)[~rapid].sum())
    return Times(
        feed=feed,
        engaged=engaged,
        rapid=float(row_time[rapid].sum()),
        dwell=dwell,
        tool_change=change,
        spindle=spindle,
        devices=devices,
    )


def _stock_results(
    shop: Shop, execution: Execution, fallen: Mapping[str, Sequence[FallenPiece]]
) -> dict[str, StockResult]:
    results = {}
    from gcodesim.executor.stock_change import UNCHANGED

    in_parts = any(placed.spec.inside is not None for placed in shop.stocks.values())
    for name, placed in shop.stocks.items():
        stock = placed.stock
        change = execution.changes.get(name, UNCHANGED)
        pieces = fallen.get(name, ())
        results[name] = StockResult(
            material=stock.material,
            initial=placed.initial,
            removed=change.removed,
            deposited=change.added,
            force=change.force if in_parts else None,
            remaining=stock.volume + sum(piece.volume for piece in pieces),
            resolution=stock.cell,
            error_bound=stock.error_bound(),
            turned=_turned(cast("Revolved", stock)) if placed.revolved else None,
            doses={} if placed.revolved else _doses(stock),
            fallen=pieces,
            body=_body(placed),
        )
    return results


def _body(placed: PlacedStock) -> BodyResult | None:
    """What a stock is as a body, as far as its density is known; None where nothing is left of it."""
    stock, density, pure = placed.stock, placed.spec.density, ""
    if density is None:
        pure = mostly(placed.material) or ""
        density = METALS[pure].density if pure else None
    if placed.revolved:
        skin = stock.surface()
        body = mass_of_skin(skin.vertices, skin.faces, 1.0) if len(skin.faces) else None
    else:
        from gcodesim.material.moments import mass_of_stock

        body = mass_of_stock(stock, 1.0)
    if body is None:
        return None
    return BodyResult(volume=stock.volume, center=body.center, inertia=body.inertia, density=density, pure=pure)


def _doses(stock: Stock) -> dict[str, DoseResult]:
    from gcodesim.processes.beam import DOSES

    (x, y), (dx, dy) = stock.origin.tolist(), stock.spacing.tolist()
    return {
        name: DoseResult(
            unit=DOSES[name].of_area,
            greatest=float(dose.max()) / DOSES[name].per_area,
            total_unit=DOSES[name].of_whole,
            total=float(dose.sum()) * dx * dy / DOSES[name].whole,
            corner=(x, y),
            cell=(dx, dy),
        )
        for name, dose in sorted(stock.doses.items())
    }


def _turned(stock: Revolved) -> TurnedResult:
    return TurnedResult(
        parted=stock.in_chuck > 0.0,
        in_chuck=stock.in_chuck,
        scrap=stock.scrap,
        threads=stock.thread_volume,
        profiles=[loop for profile in stock.finished for loop in stock.outlines(profile, PROFILE_TOLERANCE)],
    )


def _joints(plan: Plan, shop: Shop, execution: Execution | None) -> list[dict[str, Any]]:
    from gcodesim.executor.totals import JointTotals

    joints = shop.kinematics.joints
    if execution is not None:
        totals = execution.joints
    else:
        extremes = plan.extremes()
        totals = JointTotals.start(extremes.least)
        totals.least, totals.most = extremes.least, extremes.most
        # as in a run: an extreme at the start belongs to no row
        totals.least_row = np.where(extremes.least == shop.home, -1, extremes.row_of_least)
        totals.most_row = np.where(extremes.most == shop.home, -1, extremes.row_of_most)
    return joint_rows(shop.joint_names, joints, totals, plan.path)


def _not_simulated(job: Job) -> list[Mapping[str, Any]]:
    if job.reading is None:
        return []
    return [
        {"word": word, "count": count, "first_line": span.line}
        for word, (count, span) in sorted(
            job.reading.not_simulated.items(), key=lambda item: (item[1][1].line, item[0])
        )
    ]
