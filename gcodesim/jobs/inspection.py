"""What a run shows to be wrong: misuse of tools, joints at their limits, power and force above what the cell allows."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.checks.saturation import saturation_findings
from gcodesim.diagnostics import Diagnostic, Severity, Span
from gcodesim.executor.record import StepRecord
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.jobs.calls import Calls
from gcodesim.jobs.chatter import chatter_findings
from gcodesim.jobs.grips import BY_MOTION, grip_finding, held_at_end
from gcodesim.jobs.loads import loads_of
from gcodesim.jobs.loose_pieces import loose_finding
from gcodesim.jobs.plan_rows import PlanRows
from gcodesim.processes import PROCESSES
from gcodesim.processes.column import FINDINGS
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.checks.stock_watch import StockWatch
    from gcodesim.executor import Execution
    from gcodesim.planning import Plan


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
        self._plan = plan
        self._calls.follow(plan)
        self._rows = PlanRows(plan, self._shop)

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
            *chatter_findings(execution.swings, self._rows.shape, self._span),
            *([] if self._bodies is None else self._bodies.findings()),
        ]

    def of_grips(self, execution: Execution) -> list[Diagnostic]:
        """What has happened to parts in the run."""
        return [*self._grips, *self._late_grips(execution), *self._held(execution)]

    def _span(self, row: int) -> Span:
        return self._rows.span(row)

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
        before = [span for at, span in self._rows.switches if at < time]
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
        return any(record[column.name].any() for column in told) or bool(self._rows.turns and record["engaged"].any())

    def _misuse(self, totals: RowTotals, *, ended: bool = False) -> list[Diagnostic]:
        """What each kind of process has to say about the rows of its tools."""
        found: list[Diagnostic] = []
        for kind, mine in self._rows.kinds.items():
            if PROCESSES[kind].acts_on == "stock" and not self._shop.cell.stocks:
                continue  # it was never asked; GS508 says so of what is switched on
            columns = totals.columns if mine.all() else {n: np.where(mine, c, 0) for n, c in totals.columns.items()}
            found += PROCESSES[kind].findings(replace(self._rows.shape, columns=columns, ended=ended))
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
