"""A program in a cell: read, planned, checked, run. What the command line and the Python API both call."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from gcodesim.canon import Event
from gcodesim.cell import Cell, LoadedCell
from gcodesim.cell.cell import MAIN
from gcodesim.cell.machine import MachineTool
from gcodesim.diagnostics import Diagnostic, Findings, Severity, SourceText, Span
from gcodesim.frames import Array
from gcodesim.language import settings_of_cell
from gcodesim.motion.build import build_tool_path
from gcodesim.motion.timing import event_durations
from gcodesim.motion.tool_path import HOME, RAPID
from gcodesim.results import Results, StockResult, Times, joint_rows, line_rows, tool_rows
from gcodesim.rs274 import Run, Settings, interpret
from gcodesim.shop import Shop, mover_of, open_shop, with_stock
from gcodesim.verdict import final_findings
from gcodesim.whole_file import write_whole

if TYPE_CHECKING:
    from gcodesim.executor import Execution, Progress
    from gcodesim.planning import Plan

LOG_NAME: Final = "run.mcap"
RESULTS_NAME: Final = "results.json"
LINES_NAME: Final = "lines.csv"
STOCK_SUFFIXES: Final = (".stl", ".stock")

KINEMATIC: Final = "kinematic"
BULLET: Final = "bullet"


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What the command line may say over the cell: `world`, settings of the reader, the day for dated suppressions."""

    world: str | None = None
    settings: Callable[[Settings], Settings] = lambda settings: settings
    today: date | None = None
    fail_on: Severity | None = Severity.ERROR


@dataclass(slots=True, kw_only=True, eq=False)
class Job:
    """A program in a cell, as far as it has come. `plan` is None when the cell or the program gives nothing to move."""

    program: SourceText
    loaded: LoadedCell
    options: Options
    findings: Findings
    shop: Shop | None = None
    reading: Run | None = None
    plan: Plan | None = None
    events: Sequence[Event] = ()
    sources: dict[str, SourceText] = field(default_factory=dict)

    @property
    def cell(self) -> Cell | None:
        return self.loaded.cell

    @property
    def stopped_at(self) -> Span | None:
        """The block at which reading ended early."""
        return self.reading.failed.span if self.reading is not None and self.reading.failed is not None else None

    def shown(self, findings: Iterable[Diagnostic]) -> list[Diagnostic]:
        """`findings` with the severities of the cell, without those that it suppresses."""
        return final_findings(findings, self.cell, self.program, self.options.today)

    @property
    def world(self) -> str:
        """Which world runs this: asked for, else named by the cell, else bullet for arms where it is installed."""
        named = self.options.world or (self.cell.simulation.world if self.cell is not None else None)
        return named or (BULLET if find_spec("pybullet") is not None else KINEMATIC)


def prepare(program: SourceText, loaded: LoadedCell, options: Options | None = None) -> Job:
    """Read the program and plan its motion in the cell; all findings so far are in the job."""
    options = options or Options()
    job = Job(
        program=program,
        loaded=loaded,
        options=options,
        findings=Findings(),
        sources={**loaded.sources, program.name: program},
    )
    job.findings.extend(loaded.findings)
    cell = loaded.cell
    if cell is None:
        return job
    shop, notes = open_shop(cell, MAIN)
    job.shop = shop
    job.findings.extend(notes)
    job.findings.extend(_world_notes(job))
    settings, problems = settings_of_cell(cell, shop.channel, shop.placement)
    job.findings.extend(problems)
    settings = replace(options.settings(settings), start=_start(shop))
    job.reading = interpret(program, settings)
    job.events = events = list(job.reading)
    job.sources |= job.reading.sources
    job.findings.extend(job.reading.findings)
    _plan(job, shop, events, settings.start)
    return job


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


def _start(shop: Shop) -> tuple[float, float, float, float, float, float]:
    """Where the controlled point stands first, in M, without tool offset."""
    from gcodesim.planning import start_of_arm, start_of_machine

    if not shop.is_arm:
        return start_of_machine(shop.kinematics.joints.names, shop.home)
    p_B = np.array(start_of_arm(shop.kinematics, shop.home)[:3])
    x, y, z = shop.X_BM.inverse().apply(p_B)
    return (float(x), float(y), float(z), 0.0, 0.0, 0.0)


def _plan(job: Job, shop: Shop, events: Sequence[Event], start: Any) -> None:
    from gcodesim.planning import plan_arm, plan_machine

    path = build_tool_path(events, start)
    duration_of = event_durations(shop.cell.magazine.change_time)
    tool_frames = {number: tool.X_FT for number, tool in shop.cell.tools.items()}
    mover = mover_of(shop)
    if isinstance(mover, MachineTool):
        plan = plan_machine(
            path,
            shop.kinematics,
            home=shop.home,
            rapids=mover.rapids,
            duration_of=duration_of,
            tool_frames=tool_frames,
        )
    else:
        plan = plan_arm(
            path.transform(shop.X_BM),
            shop.kinematics,
            home=shop.home,
            orientation=_orientation(shop),
            duration_of=duration_of,
            tool_frames=tool_frames,
        )
    job.plan = plan
    job.findings.extend(plan.findings)
    job.findings.extend(_clearance(shop, plan))


def _clearance(shop: Shop, plan: Plan) -> list[Diagnostic]:
    """Where the tool runs into a fixture."""
    if not shop.cell.fixtures:
        return []
    from gcodesim.checks.clearance import clearance_findings, fixture_body
    from gcodesim.kinematics import Cartesian

    X_BW = shop.X_WB.inverse()
    bodies = [
        fixture_body(name, fixture.shape, X_BW @ shop.placement.fixtures[name])
        for name, fixture in shop.cell.fixtures.items()
    ]
    return clearance_findings(
        plan,
        shop.cell.tools,
        [body for body in bodies if body is not None],
        X_BM=shop.X_BM,
        table=shop.kinematics.table if isinstance(shop.kinematics, Cartesian) else None,
    )


def _orientation(shop: Shop) -> Any:
    """How the arm holds the tool: T's Z along the asked axis, in base axes, for every work system."""
    from gcodesim.planning import Orientation

    own = shop.cell.channels[shop.channel].orientation
    R_BW = shop.X_WB.inverse().R
    frames = {
        system: _upright(R_BW @ shop.placement.tool_axis(own, system), shop, system)
        for system in shop.placement.work_offsets
    }
    return Orientation(frames=frames, upright=frames[1], spin=None if own is None else own.spin)


def _upright(axis_B: np.ndarray[Any, np.dtype[np.float64]], shop: Shop, system: int) -> Any:
    """Axes of the frame O (3, 3) whose −Z is the tool axis; its X is that of the work system as far as it can be."""
    z = -axis_B / np.linalg.norm(axis_B)
    x_system = (shop.X_BM @ shop.placement.work_offsets[system]).R[:, 0]
    x = x_system - (x_system @ z) * z
    if np.linalg.norm(x) < 1e-6:
        y_system = (shop.X_BM @ shop.placement.work_offsets[system]).R[:, 1]
        x = y_system - (y_system @ z) * z
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def check(job: Job) -> Results:
    """Results without material: time, distance, travel of the joints, findings of reading, limits and reach."""
    return _results(job, None)


def run(
    job: Job, out: Path | None = None, progress: Callable[[Progress], None] | None = None
) -> tuple[Results, Execution | None]:
    """Run the job with its stock; with `out` the log, the results and the stocks are written there.

    What an earlier run left in `out` under the same names goes first, so that
    nothing old stands beside the results of a run that failed.
    """
    from gcodesim.executor import execute
    from gcodesim.inspection import Inspector

    if job.shop is None or job.plan is None or job.cell is None:
        return _not_run(job, out), None
    job.shop, problems = with_stock(job.shop)
    job.findings.extend(problems)
    if any(problem.level >= Severity.ERROR for problem in problems):
        return _not_run(job, out), None
    recorder = None
    if out is not None:
        _forget(out, job.shop)
    if out is not None:
        from gcodesim.recorder import Recorder

        recorder = Recorder(job, out)
    execution = None
    inspector = Inspector(job.plan, job.shop, job.cell.simulation.step_ns)
    try:
        execution = execute(
            job.plan,
            job.shop,
            world_name=job.world,
            dt_ns=job.cell.simulation.step_ns,
            inspect=lambda record, rows, joints: job.shown(inspector.fresh(record, rows, joints)),
            watcher=recorder,
            progress=progress,
        )
        job.findings.extend(inspector.final(execution, job.events))
        results = _results(job, execution)
        if recorder is not None:
            recorder.finish(results, execution)
    finally:
        if recorder is not None:
            recorder.abandon()
    return results, execution


def _not_run(job: Job, out: Path | None) -> Results:
    """Results of a job that a fault of the cell or its stock keeps from starting."""
    results = _results(job, None, failed=True)
    results = replace(results, stopped_at=_first_error(results.findings))
    if out is not None:
        _forget(out, job.shop)
        out.mkdir(parents=True, exist_ok=True)
        write_whole(out / RESULTS_NAME, results.text().encode())
    return results


def _forget(out: Path, shop: Shop | None) -> None:
    """Remove the files that a run writes, as far as an earlier one left them."""
    stocks = () if shop is None or shop.cell is None else shop.cell.stocks
    names = [LOG_NAME, RESULTS_NAME, LINES_NAME, *(f"{name}{suffix}" for name in stocks for suffix in STOCK_SUFFIXES)]
    for name in names:
        (out / name).unlink(missing_ok=True)


def inputs_of(job: Job) -> dict[str, Any]:
    """What went in, by name and hash; no folder of this machine."""
    simulation = job.cell.simulation if job.cell is not None else None
    own, *others = job.loaded.files
    return {
        "gcodesim": version("gcodesim"),
        "seed": simulation.seed if simulation is not None else None,
        "world": job.world,
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
    """Whether `source` is a subprogram: read with the program, but not it."""
    return job.reading is not None and source.name in job.reading.sources and source.name != job.program.name


def _results(job: Job, execution: Execution | None, *, failed: bool = False) -> Results:
    findings = job.shown(job.findings)
    interrupted = execution is not None and execution.interrupted
    failed = failed or job.cell is None or job.stopped_at is not None or interrupted
    worst = max((finding.level for finding in findings), default=None)
    fail_on = job.options.fail_on
    bad = worst is not None and fail_on is not None and worst >= fail_on
    if job.plan is None or job.shop is None:
        return Results(
            status="failed",
            stopped_at=_first_error(findings),
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
    if interrupted and execution is not None:  # what never ran does not count
        ran = np.arange(len(path)) <= execution.last_row
        length, row_time = np.where(ran, length, 0.0), np.where(ran, row_time, 0.0)
    names = {number: tool.name for number, tool in shop.cell.tools.items()}
    stopped = job.stopped_at
    if interrupted and stopped is None and execution is not None:
        stopped = path.span(execution.last_row) if len(path) else None
    return Results(
        status="failed" if failed else "findings" if bad else "ok",
        stopped_at=stopped,
        inputs=inputs_of(job),
        findings=findings,
        times=_times(plan, rapid, row_time, execution),
        feed_distance=float(length[~rapid].sum()),
        rapid_distance=float(length[rapid].sum()),
        stocks={} if execution is None else _stock_results(shop, execution),
        tools=tool_rows(path, names, row_time, totals),
        joints=_joints(plan, shop, execution),
        not_simulated=_not_simulated(job),
        lines=line_rows(path, row_time, length, totals),
    )


def _first_error(findings: Sequence[Diagnostic]) -> Span | None:
    return next((finding.span for finding in findings if finding.level >= Severity.ERROR), None)


def _times(plan: Plan, rapid: Any, row_time: Array, execution: Execution | None) -> Times:
    """Where the time goes, from the time law."""
    from gcodesim.canon import ToolChange

    events = list(plan.trajectory.events)
    if execution is not None and execution.interrupted:
        end = plan.trajectory.duration * execution.steps / max(execution.planned, 1)
        events = [event for event in events if event.time <= end]
    change = sum(e.duration for e in events if isinstance(e.event, ToolChange))
    dwell = sum(e.duration for e in events if not isinstance(e.event, ToolChange))
    feed = float(row_time[~rapid].sum())
    engaged = 0.0
    if execution is not None and len(row_time):
        engaged = float(np.minimum(execution.rows.engaged, row_time)[~rapid].sum())
    return Times(feed=feed, engaged=engaged, rapid=float(row_time[rapid].sum()), dwell=dwell, tool_change=change)


def _stock_results(shop: Shop, execution: Execution) -> dict[str, StockResult]:
    results = {}
    for name, placed in shop.stocks.items():
        stock = placed.stock
        removed, added = execution.volumes.get(name, (0.0, 0.0))
        results[name] = StockResult(
            material=stock.material,
            initial=placed.initial,
            removed=removed,
            deposited=added,
            remaining=stock.volume,
            resolution=float(stock.grid[2:].max()),
            error_bound=stock.error_bound(),
        )
    return results


def _joints(plan: Plan, shop: Shop, execution: Execution | None) -> list[dict[str, Any]]:
    from gcodesim.executor.totals import JointTotals

    joints = shop.kinematics.joints
    if execution is not None:
        totals = execution.joints
    else:
        extremes = plan.extremes()
        totals = JointTotals.start(extremes.least)
        totals.least, totals.most = extremes.least, extremes.most
        totals.least_row, totals.most_row = extremes.row_of_least, extremes.row_of_most
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
