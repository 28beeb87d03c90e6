"""What happened in the steps of a window, as columns. Log, totals and checks look at nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.executor.freeing import Freed
from gcodesim.executor.stint import Stint, deflection_of
from gcodesim.executor.window import StepWindow
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.processes.column import FORCE, Column
from gcodesim.processes.gripping import GripEvent

if TYPE_CHECKING:
    from gcodesim.executor.loose_bodies import LooseBody
    from gcodesim.processes.sheet import Sheet
    from gcodesim.world import WorldSteps


@frozen(eq=False)
class StepRecord:
    """n steps: the window, what the world did, and what all processes did to all their targets.

    wrench, deflection (n, 6) in base axes at the tip; `kind` (n,) points into the kinds of the sheet; `columns` (n,)
    by name are those of the sheet, zero where no process gives a value; `feeds` (n,) are steps along feed moves.
    `grips` are what happened to parts, each with its step of the record; `parts` (n, parts, 4, 4) is X_WP of all
    parts, then of all devices, and `things` their frames; both in the record of the first channel. `freed` is what was
    cut loose, each with its step of the record, and `loose` how it falls, where the world is an engine. `beside` are
    the records of further channels in the same steps, by their movers; in that of the first. `at_looks`: what the
    machine does when the log looks at the window, if not at the ends of steps.
    """

    window: StepWindow
    world: WorldSteps
    sheet: Sheet
    wrench: Array
    deflection: Array
    kind: NDArray[np.int64]
    columns: Mapping[str, NDArray[Any]]
    feeds: NDArray[np.bool_]
    grips: tuple[tuple[int, GripEvent], ...] = ()
    parts: Array | None = None
    things: tuple[str, ...] = ()
    freed: tuple[tuple[int, Freed], ...] = ()
    loose: tuple[LooseBody, ...] = ()
    beside: Mapping[str, StepRecord] = field(default_factory=dict)
    at_looks: WorldSteps | None = None

    def __len__(self) -> int:
        return len(self.window)

    def __getitem__(self, column: str) -> NDArray[Any]:
        """A column (n,)."""
        return self.columns[column]

    def places(self, row: int) -> dict[str, Array]:
        """X_WF (4, 4) of parts and devices at the end of a step, by their frames."""
        return {} if self.parts is None else dict(zip(self.things, self.parts[row], strict=True))

    def opening(self, row: int, widest: float) -> float:
        """How far open (0 to 1) a gripper is in a step that opens so wide [m]."""
        if "opening" not in self.columns or widest <= 0.0:
            return 1.0
        return min(float(self.columns["opening"][row]) / widest, 1.0)

    @property
    def net_removed(self) -> Array:
        """Volume (n,) [m³] that the stocks have lost in each step, below zero where they gained."""
        net: Array = self.columns["removed"] - self.columns["added"]
        return net

    @property
    def standing(self) -> dict[str, float]:
        """The values at the end of the window that hold until a process gives others."""
        return {c.name: float(self.columns[c.name][-1]) for c in self.sheet.columns if c.of == "last"}


def record_of(
    window: StepWindow,
    world: WorldSteps,
    stints: Sequence[Stint],
    sheet: Sheet,
    standing: Mapping[str, float] | None = None,
    feeds: NDArray[np.bool_] | None = None,
) -> StepRecord:
    """Put the stints of a window together; `standing` are the values that held at the end of the window before.

    `feeds` (n,): see `StepRecord`; None: all steps.
    """
    n = len(window)
    wrench, deflection = np.zeros((n, 6)), np.zeros((n, 6))
    kind = np.zeros(n, dtype=np.int64)
    columns = {column.name: _blank(column, n, standing or {}) for column in sheet.columns}
    for stint in stints:
        answer = stint.answer
        if answer is None or stint.wrench is None:
            continue
        here = slice(stint.begin, stint.end)
        wrench[here] += stint.wrench
        deflection[here] += deflection_of(stint)
        for column in sheet.columns:
            values = answer.columns.get(column.name)
            if values is None and column.steady:
                values = _steady(column, stint)
            if values is not None:
                _put_in(columns[column.name], column, values, here)
        kind[here] = np.where(answer["engaged"], sheet.kinds.index(stint.task.process.kind), kind[here])
    columns[FORCE.name] = norms(wrench[:, :3])
    grips = tuple(
        (stint.begin + event.step, event)
        for stint in stints
        if stint.answer is not None
        for event in stint.answer.changes
        if isinstance(event, GripEvent)
    )
    return StepRecord(
        window=window,
        world=world,
        sheet=sheet,
        wrench=wrench,
        deflection=deflection,
        kind=kind,
        columns=columns,
        feeds=np.ones(n, dtype=bool) if feeds is None else feeds,
        grips=grips,
        freed=tuple((stint.begin + piece.step, piece) for stint in stints for piece in stint.freed),
    )


def _blank(column: Column, n: int, standing: Mapping[str, float]) -> NDArray[Any]:
    if column.of == "last":
        return np.full(n, standing.get(column.name, 0.0))
    return np.zeros(n, dtype=bool if column.of == "any" else float)


def _steady(column: Column, stint: Stint) -> NDArray[Any] | None:
    """What a process that says nothing of this column says by the one that the column names."""
    assert stint.answer is not None and stint.wrench is not None
    return norms(stint.wrench[:, :3]) if column.steady == FORCE.name else stint.answer.columns.get(column.steady)


def _put_in(into: NDArray[Any], column: Column, values: NDArray[Any], here: slice) -> None:
    """Combine the values of one process in the steps `here` with those of others."""
    if column.of == "any":
        into[here] |= values
    elif column.of == "last":
        into[here] = values
        into[here.stop :] = values[-1]
    elif column.adds:
        into[here] += values
    else:
        into[here] = np.where(np.abs(values) > np.abs(into[here]), values, into[here])
