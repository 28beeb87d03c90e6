"""Which processes each tool carries out on which targets, and what every path row asks of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.executor.part_run import PartRun, PartsTarget
from gcodesim.executor.signals import signals_of_rows
from gcodesim.executor.targets import TaskTarget, targets_of
from gcodesim.frozen import frozen
from gcodesim.motion.tool_path import HOME, RAPID, Commanded, ToolPath
from gcodesim.processes import PROCESSES
from gcodesim.processes.signal import Signal
from gcodesim.shop import Shop

if TYPE_CHECKING:
    from gcodesim.processes.protocol import Process
    from gcodesim.processes.window import ProcessState
    from gcodesim.tools.tool import Tool


Only = Literal["shape", "motion", "force"]
"""What a run may be about: the shape of the stocks, the motion of the machine, or the forces of the tools."""

PROBING: Final = frozenset(("G31", "G38.2", "G38.3", "G38.4", "G38.5"))
"""Motion words of moves that end where something is touched."""


@dataclass(slots=True, kw_only=True, eq=False)
class Task:
    """One process of a tool at one target. `state` is what the process carries from window to window."""

    tool: Tool
    target: TaskTarget
    process: Process
    state: ProcessState


@frozen(eq=False)
class RowColumns:
    """What holds in each of the n path rows: tool number, rapid, probing, and the signals (n,) by name.

    `shift` (n, 3) [m] is how far the control point has jumped up to each row because other lengths of tools came into
    force. Nothing moves then: the same place gets another name. Seen from one row, a point of another row is less by
    the difference of both.
    """

    tool: NDArray[np.int64]
    rapid: NDArray[np.bool_]
    probing: NDArray[np.bool_]
    signals: Mapping[str, NDArray[Any]]
    shift: NDArray[np.float64]

    @staticmethod
    def of(path: ToolPath, shop: Shop | None = None) -> RowColumns:
        """The columns of `path`; its signals are those that the cell of `shop` gives to the processes of its tools."""
        numbers = np.array([state.tool for state in path.states], dtype=np.int64)
        if shop is None:
            signals = signals_of_rows(path)
        else:
            mode = shop.cell.channels[shop.channel].laser_mode
            signals = signals_of_rows(path, shop.signal_sources, shop.signals, mode)
        if not len(path):  # one row at rest, so that a program without moves has a state too
            none = np.zeros(1, dtype=bool)
            return RowColumns(tool=numbers[:1], rapid=none, probing=none, signals=signals, shift=np.zeros((1, 3)))
        return RowColumns(
            tool=numbers[path.state],
            rapid=(path.kind == RAPID) | (path.kind == HOME),
            probing=np.array([state.word in PROBING for state in path.states])[path.state],
            signals=signals,
            shift=_shifts(path),
        )

    def signal(self, signal: Signal, row: NDArray[np.int64]) -> NDArray[Any]:
        """The values of a signal in rows `row` (n,); its default where the program knows no such signal."""
        values = self.signals.get(signal.name)
        return np.full(len(row), signal.default) if values is None else values[row]


def _shifts(path: ToolPath) -> NDArray[np.float64]:
    """`RowColumns.shift` of a path with rows."""
    shifts = np.zeros((len(path), 3))
    names = np.array([(*s.offset[:3], s.control == Commanded.POINT) for s in path.states], dtype=float)[path.state]
    at = np.flatnonzero((np.diff(names, axis=0) != 0.0).any(axis=1)) + 1
    shifts[at] = path.start[at, :3] - path.end[at - 1, :3]
    total: NDArray[np.float64] = np.cumsum(shifts, axis=0)
    return total


def _shaping(task: Task) -> Task:
    process = task.process.shaping
    return replace(task, process=process, state=process.begin())


@dataclass(slots=True, eq=False)
class Tasks:
    """Tasks by tool number, made when a tool is put into the spindle. `only`: what the run is about, if not all."""

    shop: Shop
    parts: PartRun | None = None
    only: Only | None = None
    _current: int | None = None
    _tasks: list[Task] = field(default_factory=list)

    def of(self, number: int) -> list[Task]:
        """The tasks of the tool in the spindle; a tool that has just been put in starts afresh."""
        if number != self._current:
            self._current = number
            tool = self.shop.tool(number)
            self._tasks = [] if tool is None else list(self._of(tool))
        return self._tasks

    def _of(self, tool: Tool) -> Iterator[Task]:
        for task in self._all_of(tool):
            if self.only == "motion" and PROCESSES[task.process.kind].acts_on != "parts":
                continue  # what is carried moves, too
            yield task if self.only != "shape" else _shaping(task)

    def _all_of(self, tool: Tool) -> Iterator[Task]:
        for kind in tool.acts_by:
            variant = PROCESSES[kind]
            for target in self._targets(tool, variant):
                process = variant.of(tool, target.material)
                yield Task(tool=tool, target=target, process=process, state=process.begin())
            if variant.acts_on != "stock":
                continue
            if tool.is_driven:
                for target in targets_of(self.shop, "milled"):
                    process = variant.of(tool, target.material)
                    yield Task(tool=tool, target=target, process=process, state=process.begin())
                continue
            for target in targets_of(self.shop, "revolved"):
                turning = variant.of_revolved(tool, target.material)
                if turning is not None:  # else GS435 says so
                    yield Task(tool=tool, target=target, process=turning, state=turning.begin())

    def _targets(self, tool: Tool, variant: type[Process]) -> list[TaskTarget]:
        if variant.acts_on != "parts":
            return targets_of(self.shop, variant.acts_on, together=variant.together)
        assert self.parts is not None
        return [PartsTarget(self.parts, self.shop, f"{self.shop.name} {tool.name}", tool.X_FT)]

    def kept(self, number: int) -> list[Task]:
        """The tasks of a tool that is kept from taking material: those that take none and are not about contact.

        The others count as just put in when they act again: inside material they cut nothing until they have left it.
        """
        self._tasks = [
            replace(task, state=task.process.begin()) if task.process.takes else task for task in self.of(number)
        ]
        return [task for task in self._tasks if not (task.process.takes or task.process.touches)]
