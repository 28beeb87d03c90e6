"""The log instants of several windows together, because computing many costs little more than computing few."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.processes.column import LOG

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord
    from gcodesim.planning import Plan
    from gcodesim.processes.sheet import Sheet

Ints = NDArray[np.int64]

MANY: Final = 1000
"""Number of instants that is worth writing."""

MOST_WINDOWS: Final = 8
"""Windows after which the instants are written however few they are; other messages of the log wait that long."""


class Instants:
    """Takes windows, and gives their values at the log instants as columns.

    `ends` are the p steps for which the log needs the place of the tip: those of the instants, those before
    them, and the last of each window. Since motors and bent gears decide where the tip is, their columns
    are joints `q` (p, j), tip `X_BT` (p, 4, 4) without bend and `deflection` (p, 6). `peaks` are the greatest sizes
    since the last instant, by fields of the log.
    """

    def __init__(self, plan: Plan, sheet: Sheet) -> None:
        self._plan = plan
        self._own = sheet.own(LOG)
        self._peaked = [column for column in sheet.shown_in(LOG) if column.of == "greatest"]
        self._sums: dict[str, float] = {}  # since the start of the run
        self.peaks = dict.fromkeys((column.peak_field for column in self._peaked), 0.0)  # since the last instant
        self._clear()

    def follow(self, plan: Plan) -> None:
        """Windows of a further leg follow; `plan` is that of all legs so far."""
        self._plan = plan

    def _clear(self) -> None:
        self._columns: dict[str, list[Any]] = {}
        self._windows = 0
        self._ends = 0
        self.count = 0

    @property
    def worth_writing(self) -> bool:
        return self.count >= MANY or self._windows >= MOST_WINDOWS

    def add(self, record: StepRecord, t_ns: Ints, at: Ints) -> None:
        """The instants `t_ns` (m,), which are steps `at` (m,) of a window."""
        window, world = record.window, record.world
        removed = record.net_removed
        needed = np.zeros(len(record), dtype=bool)
        needed[at] = needed[np.maximum(at - 1, 0)] = needed[-1] = True
        ends = np.flatnonzero(needed)
        place = np.cumsum(needed) + self._ends  # 0 is the end before the first step
        follows = np.array_equal(world.q, window.q)
        row = window.row[at]
        self._extend(
            q=world.q[ends],
            X_BT=window.tip[ends] if follows else self._plan.tip(world.q[ends], window.row[ends]),
            deflection=record.deflection[ends],
            t_ns=t_ns,
            now=place[at],
            before=np.where(at > 0, place[at - 1], self._ends),
            qd=world.qd[at],
            effort=world.effort[at],
            command=window.q[at],
            saturated=np.any(world.saturated[at], axis=1),
            **({} if record.parts is None else {"parts": record.parts[at]}),
            row=row,
            tool=window.tool[at],
            target=window.tip[at],
            velocity=window.samples.velocity[at, :3],
            time=window.samples.time[at],
            wrench=record.wrench[at],
            kind=record.kind[at],
            engaged=record["engaged"][at],
            torque=record["torque"][at],
            power=record["power"][at],
            removal=removed[at] / window.dt[at],
            dt=window.dt[at],
            removed=self._since_start("removed", removed)[at],
            **{
                c.field: (self._since_start(c.name, record[c.name]) if c.of == "sum" else record[c.name])[at]
                for c in self._own
            },
            **{c.peak_field: self._peaks_of(c.peak_field, record[c.name], at) for c in self._peaked},
        )
        self._windows += 1
        self._ends += len(ends)
        self.count += len(at)

    def _since_start(self, name: str, values: Array) -> Array:
        """The sum (n,) of `values` (n,) and of all that came before under this name: one after the other, so that no

        bit depends on where windows begin.
        """
        sums: Array = np.cumsum(np.append(self._sums.get(name, 0.0), values))[1:]
        self._sums[name] = float(sums[-1])
        return sums

    def _peaks_of(self, name: str, values: Array, at: Ints) -> Array:
        """The greatest size (m,) of `values` (n,) since the instant before each of `at` (m,)."""
        size = np.abs(values)
        if not len(at):
            self.peaks[name] = max(self.peaks[name], float(size.max(initial=0.0)))
            return np.zeros(0)
        end = int(at[-1]) + 1
        most: Array = np.maximum.reduceat(size[:end], np.concatenate([[0], at[:-1] + 1]))
        most[0] = max(float(most[0]), self.peaks[name])
        self.peaks[name] = float(size[end:].max(initial=0.0))
        return most

    def _extend(self, **columns: Array | NDArray[Any]) -> None:
        for name, column in columns.items():
            self._columns.setdefault(name, []).append(column)

    def take(self) -> dict[str, Any]:
        """The columns by name; afterwards nothing is left.

        `now` and `before` (m,) count the ends of steps from 1: that of an instant's step, and of the step before it.
        0 is the last end that was taken earlier.
        """
        taken = {name: np.concatenate(parts) for name, parts in self._columns.items()}
        self._clear()
        return taken
