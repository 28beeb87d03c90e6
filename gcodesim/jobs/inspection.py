"""What a run shows to be wrong: misuse of tools, joints at their limits, power and force above what the cell allows."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.matrices import dots
from gcodesim.canon import AXIS_LETTERS, Dwell, ToolChange
from gcodesim.cell.signal_values import value_after
from gcodesim.checks.saturation import saturation_findings
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.diagnostics.events import Flags
from gcodesim.executor.record import StepRecord
from gcodesim.executor.tasks import RowColumns
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.jobs.calls import Calls
from gcodesim.jobs.chatter import chatter_findings
from gcodesim.jobs.grips import BY_MOTION, grip_finding, held_at_end
from gcodesim.jobs.loads import loads_of
from gcodesim.jobs.loose_pieces import loose_finding
from gcodesim.processes import PROCESSES
from gcodesim.processes.column import FINDINGS
from gcodesim.processes.gripping import Gripping
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import SPINDLE
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.executor import Execution
    from gcodesim.planning import Plan
    from gcodesim.tools.tool import Tool


LESS: Final = "cut less deep, less wide or slower"


class Inspector:
    """Inspects a run while it goes on, so that findings are at their times in the log, and again at its end."""

    def __init__(
        self, plan: Plan, shop: Shop, dt_ns: int, *, freely: bool = False, bodies: StockWatch | None = None
    ) -> None:
        """`bodies` knows how near the machine has come to stocks; `freely`: parts are free in the world.

        What `fresh` finds may be left out until `watched` is set: somebody looks at findings before the end.
        """
        self.watched = False
        self._shop, self._dt, self._bodies = shop, dt_ns * 1e-9, bodies
        self._known: set[tuple[str, Span]] = set()
        self._loads = loads_of(shop.cell.limits)
        self._grips: list[Diagnostic] = []
        self._freely = freely
        self._calls = Calls(plan, shop, self._dt)
        self._called: list[Diagnostic] = []
        self._freed: list[Diagnostic] = []
        self.follow(plan)

    def follow(self, plan: Plan) -> None:
        """Inspect the rows of `plan`, which is that of all legs so far."""
        self._plan, shop = plan, self._shop
        self._calls.follow(plan)
        self._starts = plan.trajectory.row_start if len(plan.path) else np.zeros(1)
        self._turns = _blind_turns(plan, shop)
        rows = RowColumns.of(plan.path, shop)
        spindle = rows.signals[SPINDLE.name]
        setting = np.cumsum(np.diff(rows.tool, prepend=rows.tool[:1]) != 0)
        setting = setting + np.cumsum(np.diff(spindle, prepend=spindle[:1]) != 0.0)
        self._shape = Rows(
            rapid=rows.rapid,
            tool=rows.tool,
            setting=setting.astype(np.int64),
            changed=np.diff(rows.tool, prepend=-1) != 0,
            retreat=_straight_up(plan, shop),
            time=self._starts,
            columns={},
            span=self._span,
            with_word=cache(lambda words: _rows_of(plan, words)),
            tools=shop.cell.tools,
            turns=self._turns,
            change_spans={
                timed.row: timed.event.span for timed in plan.path.events if isinstance(timed.event, ToolChange)
            },
            stay_spans=_stay_spans(plan),
            grain=_grain(shop),
        )
        self._switches = [
            (each.time, each.event.span)
            for each in plan.trajectory.events
            if any(value_after(each.event, signal, shop.signal_sources) is not None for signal in Gripping.reads)
        ]
        self._kinds = {
            kind: np.isin(rows.tool, [n for n, tool in shop.cell.tools.items() if _does(shop, kind, tool)])
            for kind in shop.sheet.kinds[1:]
        }

    def fresh(self, record: StepRecord, totals: RowTotals, joints: JointTotals) -> list[Diagnostic]:
        """Findings that came up in the steps of `record`."""
        found = self._misuse(totals) if self.watched and self._tells(record) else []
        found += self._grips_of(record)
        called = self._calls.of(record)
        self._called += called
        found += called
        freed = [loose_finding(piece, self._plan, self._shop) for _, piece in record.freed]
        self._freed += freed
        found += freed
        found += [] if self._bodies is None else self._bodies.fresh()
        if self.watched and record.world.saturated.any():
            found += self._saturation(joints)
        if self._above_limits(record) and self.watched:
            found += self._limits(totals)
        fresh = [finding for finding in found if (finding.code, finding.span) not in self._known]
        self._known |= {(finding.code, finding.span) for finding in fresh}
        return fresh

    def final(self, execution: Execution) -> list[Diagnostic]:
        """All findings of the run."""
        return [
            *self._misuse(execution.rows, ended=not execution.interrupted),
            *self.of_grips(execution),
            *self._called,
            *self._freed,
            *self._saturation(execution.joints),
            *self._limits(execution.rows),
            *chatter_findings(execution.swings, self._shape, self._span),
            *([] if self._bodies is None else self._bodies.findings()),
        ]

    def of_grips(self, execution: Execution) -> list[Diagnostic]:
        """What has happened to parts in the run."""
        return [*self._grips, *self._late_grips(execution), *self._held(execution)]

    def _span(self, row: int) -> Span:
        path = self._plan.path
        return path.span(row) if 0 <= row < len(path) else Span(self._shop.cell.name)

    def _grips_of(self, record: StepRecord) -> list[Diagnostic]:
        """What happened to parts, once for each line."""
        found = []
        known = {(finding.code, finding.span) for finding in self._grips}
        for step, event in record.grips:
            tool = self._shop.tool(int(record.window.tool[step]))
            time = int(record.window.ticks[step]) * self._dt
            row = int(record.window.row[step])
            done = int(record.window.ticks[step + 1]) * self._dt
            span = self._span(row) if event.kind in BY_MOTION else self._switch_before(done, row)
            finding = grip_finding(event, tool, span, time, freely=self._freely)  # type: ignore[arg-type]
            if finding is not None and (finding.code, finding.span) not in known:
                known.add((finding.code, finding.span))
                found.append(finding)
        self._grips += found
        return found

    def _switch_before(self, time: float, row: int) -> Span:
        """The word that last told a gripper something before `time` [s]; where there is none, the line of a row."""
        before = [span for at, span in self._switches if at < time]
        return before[-1] if before else self._span(row)

    def _late_grips(self, execution: Execution) -> list[Diagnostic]:
        path = self._plan.path
        span = self._switch_before(np.inf, len(path) - 1)
        number = path.state_of(len(path) - 1).tool if len(path) else 0
        found = (
            grip_finding(event, self._shop.tool(number), span, (event.step + 1) * self._dt, freely=self._freely)  # type: ignore[arg-type]
            for event in execution.late_grips
        )
        return [finding for finding in found if finding is not None]

    def _held(self, execution: Execution) -> list[Diagnostic]:
        own = {name: end for name, end in execution.parts.items() if end.holder.split(" ")[0] == self._shop.name}
        path = self._plan.path
        labels = {body.name: body.label for body in self._shop.scene.bodies}
        return held_at_end(own, labels, self._span(len(path) - 1) if len(path) else Span(self._shop.cell.name))

    def _tells(self, record: StepRecord) -> bool:
        """Whether a step of the window may be a reason for a process to complain."""
        told = (column for column in record.sheet.columns if column.shown_in & FINDINGS)
        return any(record[column.name].any() for column in told) or bool(self._turns and record["engaged"].any())

    def _misuse(self, totals: RowTotals, *, ended: bool = False) -> list[Diagnostic]:
        """What each kind of process has to say about the rows of its tools."""
        found: list[Diagnostic] = []
        for kind, mine in self._kinds.items():
            if PROCESSES[kind].acts_on == "stock" and not self._shop.cell.stocks:
                continue  # it was never asked; GS508 says so of what is switched on
            columns = totals.columns if mine.all() else {n: np.where(mine, c, 0) for n, c in totals.columns.items()}
            found += PROCESSES[kind].findings(replace(self._shape, columns=columns, ended=ended))
        return found

    def _saturation(self, joints: JointTotals) -> list[Diagnostic]:
        own = self._shop.kinematics.joints
        seconds, longest, begin = joints.saturated.in_seconds(self._dt)
        return saturation_findings(
            self._shop.joint_names,
            own.kinds,
            limit=own.effort,
            effort=joints.effort,
            first_row=joints.saturated_row,
            seconds=seconds,
            longest=longest,
            begin=begin,
            spans=self._span,
        )

    def _above_limits(self, record: StepRecord) -> bool:
        """Whether a step asks for more than the cell's `limits` allow; notes for how long it does."""
        ticks = np.diff(record.window.ticks)
        above = [load.add(record[load.column], ticks, self._dt) for load in self._loads]  # each has to see the steps
        return any(above)

    def _limits(self, totals: RowTotals) -> list[Diagnostic]:
        """What the run needed, compared with what the cell's `limits` allow."""
        found = []
        for load in self._loads:
            over = np.flatnonzero(totals[load.column] > load.limit)
            if not len(over):
                continue
            values = totals[load.column]
            worst = int(over[np.argmax(values[over])])
            most, allowed = float(values[worst]) / load.per, load.limit / load.per
            count = len(distinct(self._plan.path.block[over])) if len(self._plan.path) else 1
            found.append(
                Diagnostic(
                    code=load.code,
                    severity=Severity.NOTE if load.brief else None,
                    message=f"{load.what} reaches {most:.4g} {load.unit}; the cell allows {allowed:.4g} {load.unit}; "
                    f"it is above that for {load.duration}",
                    span=self._span(int(over[0])),
                    hint=f"the greatest value is in line {self._span(worst).line}; "
                    + ("the spindle turns on through a peak as short as this" if load.brief else LESS),
                    count=count,
                    time=load.begin,
                    value=most,
                    limit=allowed,
                    unit=load.unit,
                )
            )
        return found


def _does(shop: Shop, kind: str, tool: Tool) -> bool:
    """Whether a tool may carry out this kind of process: on a lathe any turns, drills as well."""
    return kind in tool.acts_by or (kind == "turning" and shop.mover.lathe)


def _rows_of(plan: Plan, words: frozenset[str]) -> Flags:
    """Rows (n,) whose motion word is one of `words`."""
    path = plan.path
    if not len(path):
        return np.zeros(1, dtype=np.bool_)
    return np.array([state.word in words for state in path.states], dtype=np.bool_)[path.state]


def _straight_up(plan: Plan, shop: Shop) -> Flags:
    """Rows (n,) along the spindle's axis away from the work, as out of a hole: the tool has been down there already."""
    path = plan.path
    up = np.zeros(max(len(path), 1), dtype=np.bool_)
    retreat = shop.mover.retreat
    if len(path) and retreat is not None:
        way = path.end - path.start
        along = dots(way[:, :3], retreat)
        way[:, :3] -= along[:, None] * retreat
        up[:] = (along > 0.0) & (np.abs(way).max(axis=1) < 1e-9)
    return up


def _stay_spans(plan: Plan) -> dict[int, Span]:
    """Where the program asks for the stay before a row: filament that comes out there, else a dwell."""
    trajectory = plan.trajectory
    stays = None if trajectory.filament is None else trajectory.filament.stays
    spans: dict[int, Span] = {}
    for k, timed in enumerate(trajectory.events):
        if isinstance(timed.event, Dwell) if stays is None else stays[k] > 0.0:
            spans.setdefault(min(timed.row, max(len(plan.path) - 1, 0)), timed.event.span)
    return spans


def _grain(shop: Shop) -> float:
    """Volume [m³] of a cell of the coarsest stock."""
    cells = (placed.stock.spacing for placed in shop.stocks.values())
    return max((float(dx * dy * max(dx, dy)) for dx, dy in cells), default=0.0)


def _blind_turns(plan: Plan, shop: Shop) -> dict[str, Flags]:
    """Rows (n,) in which a rotary axis turns whose place the cell does not give, by its letter; only axes that turn."""
    start, end = plan.path.start, plan.path.end
    columns = {letter: AXIS_LETTERS.index(letter) for letter in shop.mover.timed_only} if len(plan.path) else {}
    turns = {letter: start[:, column] != end[:, column] for letter, column in columns.items()}
    return {letter: rows for letter, rows in turns.items() if rows.any()}
