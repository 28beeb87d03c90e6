"""What a run shows to be wrong: misuse of tools, joints at their limits, power and force above what the cell allows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcodesim.canon import ToolChange
from gcodesim.cell.machine import LETTERS
from gcodesim.checks.events import Flags
from gcodesim.checks.misuse import RowUse, blind_findings, stock_findings
from gcodesim.checks.saturation import saturation_findings
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.executor.record import StepRecord
from gcodesim.executor.tasks import RowColumns
from gcodesim.executor.totals import JointTotals, RowTotals
from gcodesim.frames import Array
from gcodesim.shop import Shop
from gcodesim.tools.cutter import Cutter
from gcodesim.units import KW, UM

if TYPE_CHECKING:
    from gcodesim.executor import Execution
    from gcodesim.planning import Plan

RUB = 2.0 * UM  # [m] of its own wall that an arm may take when it comes back and is bent otherwise than before


class Inspector:
    """Looks at a run while it goes on, so that findings stand at their time in the log, and once more at its end."""

    def __init__(self, plan: Plan, shop: Shop, dt_ns: int) -> None:
        self._plan, self._shop, self._dt = plan, shop, dt_ns * 1e-9
        self._rows = RowColumns.of(plan.path)
        self._names = {number: tool.name for number, tool in shop.cell.tools.items()}
        self._known: set[tuple[str, Span]] = set()
        self._changes = {
            timed.row: timed.event.span for timed in plan.path.events if isinstance(timed.event, ToolChange)
        }
        self._blind = _blind_turns(plan, shop)
        self._grain = _least_rapid(self._rows, shop)
        self._up = _straight_up(plan, shop)
        self._probes, self._left_taps = _rows_of(plan, _PROBES), _rows_of(plan, _LEFT_TAPS)
        self._starts = plan.trajectory.row_start if len(plan.path) else np.zeros(1)

    def fresh(self, record: StepRecord, totals: RowTotals, joints: JointTotals) -> list[Diagnostic]:
        """Findings that came up in the steps of `record`."""
        use = record.rapid & (record.removed > 0.0) | record.stopped | record.reversed | record.inside | record.tilted
        use |= (record.shank_depth > 0.0) | (record.holder_depth > 0.0)
        use |= (record.removed > 0.0) if self._blind else False
        found = self._misuse(totals) if use.any() else []
        if record.world.saturated.any():
            found += self._saturation(joints)
        if self._above_limits(record):
            found += self._limits(totals)
        fresh = [finding for finding in found if (finding.code, finding.span) not in self._known]
        self._known |= {(finding.code, finding.span) for finding in fresh}
        return fresh

    def final(self, execution: Execution) -> list[Diagnostic]:
        """All findings of the run."""
        return [
            *self._misuse(execution.rows),
            *self._saturation(execution.joints),
            *self._limits(execution.rows),
        ]

    def _span(self, row: int) -> Span:
        path = self._plan.path
        return path.span(row) if 0 <= row < len(path) else Span(self._shop.cell.name)

    def _misuse(self, totals: RowTotals) -> list[Diagnostic]:
        rows = self._rows
        setting = np.cumsum(np.diff(rows.tool, prepend=rows.tool[:1]) != 0)
        setting = setting + np.cumsum(np.diff(rows.spindle, prepend=rows.spindle[:1]) != 0.0)
        use = RowUse(
            rapid=rows.rapid,
            tool=rows.tool,
            setting=setting.astype(np.int64),
            changed=np.diff(rows.tool, prepend=-1) != 0,
            spindle=rows.spindle,
            time=self._starts,
            rapid_cut=np.where(self._up, 0.0, totals.rapid_cut),
            rapid_bound=totals.rapid_bound + self._grain,
            stopped_cut=np.where(self._up | self._probes, 0.0, totals.stopped_cut),
            reversed_cut=np.where(self._up | self._left_taps, 0.0, totals.reversed_cut),
            shank=totals.shank,
            holder=totals.holder,
            inside=totals.inside,
            tilted=totals.tilted,
        )
        return [
            *stock_findings(use, self._span, self._names, self._changes),
            *blind_findings(self._blind, totals.removed, self._starts, self._span),
        ]

    def _saturation(self, joints: JointTotals) -> list[Diagnostic]:
        own = self._shop.kinematics.joints
        return saturation_findings(
            self._shop.joint_names,
            own.kinds,
            limit=own.effort,
            effort=joints.effort,
            first_row=joints.saturated_row,
            steps=joints.saturated_steps,
            dt=self._dt,
            spans=self._span,
            starts=self._starts,
        )

    def _above_limits(self, record: StepRecord) -> bool:
        """Whether a step asks for more than the cell's `limits` allow."""
        limits = self._shop.cell.limits
        return (
            _above(record.power, limits.spindle_power)
            or _above(record.torque, limits.spindle_torque)
            or (limits.force is not None and _above(np.linalg.norm(record.wrench[:, :3], axis=1), limits.force))
        )

    def _limits(self, totals: RowTotals) -> list[Diagnostic]:
        """What the cell's `limits` allow, against what the run asked for."""
        limits = self._shop.cell.limits
        found = []
        columns: tuple[tuple[str, float | None, Array, float, str, str], ...] = (
            ("GS510", limits.spindle_power, totals.power, KW, "kW", "power of the spindle"),
            ("GS511", limits.spindle_torque, totals.torque, 1.0, "N·m", "torque of the spindle"),
            ("GS512", limits.force, totals.force, 1.0, "N", "force on the tool"),
        )
        for code, limit, values, unit, name, what in columns:
            if limit is None or not (values > limit).any():
                continue
            over = np.flatnonzero(values > limit)
            worst = int(over[np.argmax(values[over])])
            most = float(values[worst])
            found.append(
                Diagnostic(
                    code=code,
                    message=f"{what} reaches {most / unit:.4g} {name}; the cell allows {limit / unit:.4g} {name}",
                    span=self._span(int(over[0])),
                    hint=f"the greatest value is in line {self._span(worst).line}; cut less deep, less wide or slower",
                    count=len(np.unique(self._plan.path.block[over])) if len(self._plan.path) else 1,
                    time=float(self._starts[over[0]]),
                    value=most / unit,
                    limit=limit / unit,
                    unit=name,
                )
            )
        return found


_PROBES = frozenset(("G31", "G38.2", "G38.3", "G38.4", "G38.5"))  # what they touch ends them on the machine
_LEFT_TAPS = frozenset(("G74",))


def _rows_of(plan: Plan, words: frozenset[str]) -> Flags:
    """Rows (n,) whose motion word is one of `words`."""
    path = plan.path
    if not len(path):
        return np.zeros(1, dtype=np.bool_)
    return np.array([state.word in words for state in path.states], dtype=np.bool_)[path.state]


def _straight_up(plan: Plan, shop: Shop) -> Flags:
    """Rows (n,) along the spindle's axis away from the work, as out of a hole: the tool has been below already."""
    path = plan.path
    up = np.zeros(max(len(path), 1), dtype=np.bool_)
    retreat = shop.mover.retreat
    if len(path) and retreat is not None:
        way = path.end - path.start
        along = way[:, :3] @ retreat
        way[:, :3] -= along[:, None] * retreat
        up[:] = (along > 0.0) & (np.abs(way).max(axis=1) < 1e-9)
    return up


def _least_rapid(rows: RowColumns, shop: Shop) -> Array:
    """What each row (n,) may take [m³] at rapid and has yet cut nothing: a cell, or a rub of the tool's own wall."""
    grids = (placed.stock.grid[2:] for placed in shop.stocks.values())
    grain = max((float(dx * dy * max(dx, dy)) for dx, dy in grids), default=0.0)
    rubs = {
        number: RUB * np.pi * tool.diameter * tool.flute_length
        for number, tool in shop.cell.tools.items()
        if isinstance(tool, Cutter)
    }
    numbers, of_row = np.unique(rows.tool, return_inverse=True)
    least: Array = np.array([max(grain, rubs.get(int(number), 0.0)) for number in numbers])[of_row]
    return least


def _above(values: Array, limit: float | None) -> bool:
    return limit is not None and bool((np.abs(values) > limit).any())


def _blind_turns(plan: Plan, shop: Shop) -> dict[str, Flags]:
    """Rows (n,) in which a rotary axis turns whose place the cell does not tell, by its letter; only those that do."""
    start, end = plan.path.start, plan.path.end
    columns = {letter: LETTERS.index(letter) for letter in shop.mover.timed_only} if len(plan.path) else {}
    turns = {letter: start[:, column] != end[:, column] for letter, column in columns.items()}
    return {letter: rows for letter, rows in turns.items() if rows.any()}
