"""Sums and extremes of a run, by path row and by joint: all that results need from the steps."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.lasting import Lasting
from gcodesim.frames import Array
from gcodesim.processes.column import FINDINGS, HOUSE, LINES, RESULTS

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.processes.column import Column
    from gcodesim.processes.sheet import Sheet

RowNumbers = NDArray[np.int64]

TREMBLE: Final = 1e-9
"""[m, rad] by which a motor at rest may be off its place without a new extreme of the joint."""


@dataclass(slots=True, eq=False)
class RowTotals:
    """Totals of the steps of each of the n path rows: `columns` (n,) by name, those of the sheet.

    Each column declares how its steps become one value (`Column.of`); of a flag it is the time [s].
    """

    sheet: Sheet
    columns: dict[str, Array]
    _room: dict[str, Array]  # of each column, with rows to spare: a session adds one with each of its steps
    _added: tuple[Column, ...]  # what someone asks for by rows: what only the log shows costs nothing here

    @staticmethod
    def zeros(count: int, sheet: Sheet) -> RowTotals:
        columns = {column.name: np.zeros(count) for column in sheet.columns}
        own = sheet.shown_in(LINES | RESULTS | FINDINGS)
        return RowTotals(sheet, columns, dict(columns), tuple(dict.fromkeys((*HOUSE, *own))))

    def __getitem__(self, column: str) -> Array:
        """A column (n,)."""
        return self.columns[column]

    def grow(self, count: int) -> None:
        """Further rows, up to `count` in all."""
        for name, values in self.columns.items():
            if count > len(self._room[name]):
                self._room[name] = np.concatenate([values, np.zeros(2 * count - len(values))])
            self.columns[name] = self._room[name][:count]

    def add(self, record: StepRecord) -> None:
        """Add the steps of a record, in order."""
        rows = record.window.row
        for column in self._added:
            values, total = record[column.name], self.columns[column.name]
            if column.of == "last":
                total[rows] = values  # for repeated rows the last one counts
            elif not values.any():
                continue
            elif column.of == "greatest":
                np.maximum.at(total, rows, np.abs(values))
            elif column.of == "any":
                np.add.at(total, rows, values * record.window.dt)
            else:
                np.add.at(total, rows, values)


@dataclass(slots=True, eq=False)
class JointTotals:
    """Extremes of each of j joints over the run, and the rows at which they came; SI.

    `told`: whether the world tells speeds and efforts; else these are zero.
    """

    least: Array
    most: Array
    least_row: RowNumbers
    most_row: RowNumbers
    speed: Array
    acceleration: Array
    effort: Array
    effort_row: RowNumbers
    saturated_row: RowNumbers = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    saturated: Lasting = field(default_factory=lambda: Lasting(0))
    told: bool = True

    @staticmethod
    def start(q: Array, *, told: bool = True) -> JointTotals:
        """The state before the first step: the robot stands at `q` (j,)."""
        count = len(q)
        zero, none = np.zeros(count), np.full(count, -1, dtype=np.int64)
        return JointTotals(
            least=q.copy(),
            most=q.copy(),
            least_row=none.copy(),
            most_row=none.copy(),
            speed=zero.copy(),
            acceleration=zero.copy(),
            effort=zero.copy(),
            effort_row=none.copy(),
            saturated_row=none.copy(),
            saturated=Lasting(count),
            told=told,
        )

    def add(
        self,
        q: Array,
        qd: Array,
        qdd: Array,
        effort: Array,
        saturated: NDArray[np.bool_],
        rows: RowNumbers,
        ticks: RowNumbers,
    ) -> None:
        """Add n steps: columns (n, j), the row (n,) of each step and its ticks (n,) of the clock."""
        if not len(q):
            return
        index = np.arange(q.shape[1])
        low, high = q.argmin(axis=0), q.argmax(axis=0)
        lower, higher = q[low, index] < self.least - TREMBLE, q[high, index] > self.most + TREMBLE
        self.least_row[lower], self.most_row[higher] = rows[low][lower], rows[high][higher]
        self.least = np.where(lower, q[low, index], self.least)
        self.most = np.where(higher, q[high, index], self.most)
        if not self.told:
            return
        self.speed = np.maximum(self.speed, np.abs(qd).max(axis=0))
        self.acceleration = np.maximum(self.acceleration, np.abs(qdd).max(axis=0))
        top = np.abs(effort).argmax(axis=0)
        stronger = np.abs(effort[top, index]) > self.effort
        self.effort_row[stronger] = rows[top][stronger]
        self.effort = np.maximum(self.effort, np.abs(effort[top, index]))
        fresh = saturated.any(axis=0) & (self.saturated_row < 0)
        self.saturated_row[fresh] = rows[saturated.argmax(axis=0)][fresh]
        self.saturated.add(saturated, ticks)
