"""How long the machine stands where something else than its axes takes time: dwells, tool changes, the spindle."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from gcodesim.canon import Dwell, Event, Extrude, ToolChange, ToolNumber
from gcodesim.frozen import frozen
from gcodesim.motion.printer_law import filament_time
from gcodesim.motion.tool_path import PathEvent

Duration: TypeAlias = Callable[[PathEvent], float]
"""How long an event lasts [s]; 0: the machine goes on."""


@frozen
class Standstill:
    """A `Duration`: dwells and filament last their own time, tool changes `tool_change`, other calls of a tool, as by
    the T of a printer, `tool_number` [s].

    `run_up` and `run_down` [s per rad/s] are the inverse of the spindle's acceleration and braking; a spindle that
    changes its sense brakes first. `switching` says how long what a word of the program switches is waited for.
    """

    tool_change: float = 0.0
    tool_number: float = 0.0
    run_up: float = 0.0
    run_down: float = 0.0
    switching: Callable[[Event], float] | None = None

    def __call__(self, noted: PathEvent) -> float:
        event = noted.event
        if isinstance(event, Dwell):
            return max(event.seconds, 0.0)
        if isinstance(event, Extrude):
            return filament_time(event)
        if isinstance(event, ToolChange):
            return self.tool_change
        if isinstance(event, ToolNumber):
            return self.tool_number if event.span.line else 0.0  # what is in at the start is of no line
        if noted.turns is not None:
            return self.spindle_time(*noted.turns)
        return 0.0 if self.switching is None else self.switching(event)

    def spindle_time(self, before: float, after: float) -> float:
        """From one speed of the spindle [rad/s], signed, to another [s]."""
        if before * after < 0.0:
            return self.run_down * abs(before) + self.run_up * abs(after)
        more = abs(after) - abs(before)
        return self.run_up * more if more >= 0.0 else self.run_down * -more
