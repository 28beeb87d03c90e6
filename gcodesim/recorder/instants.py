"""The log instants of several windows together, because computing many costs little more than computing few."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.processes.column import LOG

if TYPE_CHECKING:
    from gcodesim.executor.looks import Looks
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

    There are p moments for which the log needs the place of the tip: the instants, as many before them (the ends of the
    steps before, or a tick before), and the end of each window. Since motors and bent gears decide where the tip is,
    their columns are joints `q` (p, j), tip `X_BT` (p, 4, 4) without bend and `deflection` (p, 6). `peaks` are the
    greatest sizes since the last instant, by fields of the log.
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
        """The instants `t_ns` (m,) in steps `at` (m,) of a window: at their ends, or when its `looks` are."""
        window, looks = record.window, record.window.looks
        removed = record.net_removed
        if looks is None:
            self._at_ends(record, at)
        else:
            self._at_looks(record, looks)
        row = window.row[at]
        self._extend(
            t_ns=t_ns,
            **({} if record.parts is None else {"parts": record.parts[at]}),
            row=row,
            tool=window.tool[at],
            wrench=record.wrench[at],
            kind=record.kind[at],
            engaged=record["engaged"][at],
            torque=record["torque"][at],
            power=record["power"][at],
            removal=removed[at] / window.dt[at],
            removed=self._until("removed", removed, at, looks),
            **{
                c.field: self._until(c.name, record[c.name], at, looks) if c.of == "sum" else record[c.name][at]
                for c in self._own
            },
            **{c.peak_field: self._peaks_of(c.peak_field, record[c.name], at, looks) for c in self._peaked},
        )
        self._windows += 1
        self.count += len(at)

    def _at_ends(self, record: StepRecord, at: Ints) -> None:
        """What machine and path do at the ends of steps `at` (m,)."""
        window, world = record.window, record.world
        needed = np.zeros(len(record), dtype=bool)
        needed[at] = needed[np.maximum(at - 1, 0)] = needed[-1] = True
        ends = np.flatnonzero(needed)
        place = np.cumsum(needed) + self._ends  # 0 is the end before the first step
        follows = np.array_equal(world.q, window.q)
        self._extend(
            q=world.q[ends],
            X_BT=window.tip[ends] if follows else self._plan.tip(world.q[ends], window.row[ends]),
            deflection=record.deflection[ends],
            now=place[at],
            before=np.where(at > 0, place[at - 1], self._ends),
            qd=world.qd[at],
            effort=world.effort[at],
            command=window.q[at],
            saturated=np.any(world.saturated[at], axis=1),
            target=window.tip[at],
            velocity=window.samples.velocity[at, :3],
            time=window.samples.time[at],
            dt=window.dt[at],
        )
        self._ends += len(ends)

    def _at_looks(self, record: StepRecord, looks: Looks) -> None:
        """What they do when the log looks: the machine is where it is commanded to be, but for its bend."""
        window, world, m = record.window, record.at_looks, len(looks.ticks)
        assert world is not None
        both = np.arange(2 * m).reshape(m, 2) + self._ends + 1  # one tick before, and the look
        steps = np.append(np.repeat(looks.step, 2), len(record) - 1)
        self._extend(
            q=np.concatenate([_by_turns(looks.q_before, looks.q), window.q[-1:]]),
            X_BT=np.concatenate([_by_turns(looks.tip_before, looks.tip), window.tip[-1:]]),
            deflection=record.deflection[steps],
            now=both[:, 1],
            before=both[:, 0],
            qd=world.qd,
            effort=world.effort,
            command=looks.q,
            saturated=np.any(world.saturated, axis=1),
            target=looks.tip,
            velocity=looks.samples.velocity[:, :3],
            time=looks.samples.time,
            dt=np.full(m, looks.dt),
        )
        self._ends += 2 * m + 1

    def _until(self, name: str, values: Array, at: Ints, looks: Looks | None) -> Array:
        """The sum (m,) of `values` (n,) since the run began, at the ends of steps `at` (m,) or at the `looks`."""
        until: Array = self._since_start(name, values)[at]
        return until if looks is None else until - (1.0 - looks.share) * values[at]

    def _since_start(self, name: str, values: Array) -> Array:
        """The sum (n,) of `values` (n,) and of all that came before under this name: one after the other, so that no

        bit depends on where windows begin.
        """
        sums: Array = np.cumsum(np.append(self._sums.get(name, 0.0), values))[1:]
        self._sums[name] = float(sums[-1])
        return sums

    def _peaks_of(self, name: str, values: Array, at: Ints, looks: Looks | None) -> Array:
        """The greatest size (m,) of `values` (n,) since the instant before each of those in steps `at` (m,)."""
        size = np.abs(values)
        if not len(at):
            self.peaks[name] = max(self.peaks[name], float(size.max(initial=0.0)))
            return np.zeros(0)
        following = at + 1 if looks is None else at + looks.at_ends  # what is left of a step counts from then on
        first = np.concatenate([[0], following[:-1]])
        most: Array = np.maximum.reduceat(np.append(size, 0.0), np.column_stack([first, at + 1]).ravel())[::2]
        most[0] = max(float(most[0]), self.peaks[name])
        self.peaks[name] = float(size[following[-1] :].max(initial=0.0))
        return most

    def _extend(self, **columns: Array | NDArray[Any]) -> None:
        for name, column in columns.items():
            self._columns.setdefault(name, []).append(column)

    def take(self) -> dict[str, Any]:
        """The columns by name; afterwards nothing is left.

        `now` and `before` (m,) count the moments from 1: that of an instant, and that from which its speed is told,
        `dt` earlier. 0 is the last one that was taken earlier.
        """
        taken = {name: np.concatenate(parts) for name, parts in self._columns.items()}
        self._clear()
        return taken


def _by_turns(first: Array, second: Array) -> Array:
    """Rows of two arrays (m, ...), one of each in turn (2 m, ...)."""
    both: Array = np.stack([first, second], axis=1).reshape(-1, *first.shape[1:])
    return both
