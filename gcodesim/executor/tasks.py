"""Which process each tool carries out in each stock, and what every path row asks of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.motion.tool_path import HOME, RAPID, ToolPath
from gcodesim.processes import PROCESSES
from gcodesim.shop import PlacedStock, Shop

if TYPE_CHECKING:
    from gcodesim.processes.window import ProcessState
    from gcodesim.tools.tool import Tool


@dataclass(slots=True, kw_only=True, eq=False)
class Task:
    """One tool at work in one stock. `state` is what the process carries from window to window."""

    tool: Tool
    target: PlacedStock
    process: Any
    state: ProcessState

    @property
    def reach(self) -> float:
        """How far from its tip this tool can touch anything [m]."""
        widths = [body.radius for body in self.tool.primitives] + [body.radius_bottom for body in self.tool.primitives]
        bead = 0.5 * float(getattr(self.tool, "bead_width", 0.0))
        return max([*widths, bead, 0.0])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RowColumns:
    """What holds in each of the n path rows: tool number, signed spindle speed [rad/s], rapid, process switched on."""

    tool: NDArray[np.int64]
    spindle: Array
    rapid: NDArray[np.bool_]
    active: NDArray[np.bool_]

    @staticmethod
    def of(path: ToolPath) -> RowColumns:
        numbers = np.array([state.tool for state in path.states], dtype=np.int64)
        speeds = np.array([state.spindle for state in path.states], dtype=float)
        if not len(path):  # one resting row, so that a program without moves has a state too
            none = np.zeros(1, dtype=bool)
            return RowColumns(tool=numbers[:1], spindle=speeds[:1], rapid=none, active=none)
        return RowColumns(
            tool=numbers[path.state],
            spindle=speeds[path.state],
            rapid=(path.kind == RAPID) | (path.kind == HOME),
            active=path.active.astype(bool),
        )


@dataclass(slots=True, eq=False)
class Tasks:
    """Tasks by tool number, made when a tool comes into the spindle."""

    shop: Shop
    _current: int | None = None
    _tasks: list[Task] = field(default_factory=list)

    def of(self, number: int) -> list[Task]:
        """The tasks of the tool in the spindle; a tool that was changed in starts afresh."""
        if number != self._current:
            self._current = number
            tool = self.shop.tool(number)
            self._tasks = [] if tool is None else [self._task(tool, placed) for placed in self.shop.stocks.values()]
        return self._tasks

    @staticmethod
    def _task(tool: Tool, placed: PlacedStock) -> Task:
        process = PROCESSES[tool.process].of(tool, placed.material)
        return Task(tool=tool, target=placed, process=process, state=process.begin())
