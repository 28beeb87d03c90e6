"""What the tool in hand is told to do: the words that a program would have for it, as events of the next steps."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from gcodesim.canon import Action, Event, ToolChange
from gcodesim.cell.signal_values import SIGNAL
from gcodesim.processes import PROCESSES
from gcodesim.processes.signal import ACTIVE, SPINDLE, Signal
from gcodesim.session import caller

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

ON: Final = ("tool", "activate")
OFF: Final = ("tool", "deactivate")
CLOSE: Final = ("gripper", "close")
OPEN: Final = ("gripper", "open")

_M: Final = 0  # the number of an M-code that nobody wrote


def hears(tool: Tool, order: tuple[str, str]) -> bool:
    """Whether a process of the tool is set by this target and verb."""
    return any(signal.is_set_by({order}) for kind in tool.processes for signal in PROCESSES[kind].reads)


def turns(tool: Tool) -> bool:
    """Whether the speed of the spindle matters to it, as it may to a tool without a process."""
    return not tool.processes or any(SPINDLE in PROCESSES[kind].reads for kind in tool.processes)


def _takes_actions(tool: Tool | None) -> bool:
    """Whether it is switched on by an event; extruders are by the rows of the path itself."""
    if tool is None:
        return False
    signals = (signal for kind in tool.processes for signal in PROCESSES[kind].reads)
    return any(signal.name != ACTIVE.name and signal.is_set_by({ON}) for signal in signals)


def settings_of(tool: Tool) -> dict[str, Signal]:
    """What a script may set of a tool by a number, by name: signals that neither its moves nor a switch gives."""
    read = [signal for kind in tool.processes for signal in PROCESSES[kind].reads]
    return {signal.name: signal for signal in read if not (signal.set_by or signal.with_moves)}


@dataclass(slots=True, eq=False)
class Switches:
    """Events that come with the next steps, and what the tool was told last."""

    _tool: Tool | None = None
    _told_on: bool = False
    _waiting: list[Event] = field(default_factory=list)
    values: dict[str, float] = field(default_factory=dict)  # of settings, until the tool is changed

    @staticmethod
    def holding(tool: Tool | None) -> Switches:
        """Those of a machine that holds a tool from the start, switched off."""
        return Switches(tool, _waiting=[action(OFF)] if _takes_actions(tool) else [])

    def change(self, number: int, tool: Tool | None) -> None:
        """The tool in hand goes, switched off, and `tool` comes."""
        self.turn(False)
        self._waiting += [action((SIGNAL, name)) for name in self.values]
        self.values.clear()
        self._waiting.append(ToolChange(span=caller.line(), tool=number))
        self._tool = tool
        if _takes_actions(tool):  # or a power, or a flow, alone would have it on
            self._waiting.append(action(OFF))

    def turn(self, on: bool) -> None:
        """Switch the tool on or off, unless it is so already."""
        self._waiting += self.turning(on)

    def turning(self, on: bool) -> list[Event]:
        """The events that switch it on or off; none for a tool that goes by the rows of the path."""
        if on == self._told_on or not _takes_actions(self._tool):
            return []
        self._told_on = on
        return [action(ON if on else OFF)]

    def tell(self, order: tuple[str, str]) -> None:
        """Tell the tool something at once."""
        self._waiting.append(action(order))

    def set(self, name: str, value: float) -> None:
        """Give a setting a value at once."""
        self.values[name] = value
        self._waiting.append(action((SIGNAL, name), value))

    @property
    def changes_tool(self) -> bool:
        """Whether a change of tools waits."""
        return any(isinstance(event, ToolChange) for event in self._waiting)

    def taken(self) -> tuple[Event, ...]:
        """What waits; nothing does afterwards."""
        events, self._waiting = tuple(self._waiting), []
        return events


def action(order: tuple[str, str], value: float | None = None) -> Action:
    """The event that tells a tool something, in the line of the script."""
    target, verb = order
    return Action(span=caller.line(), m=_M, p=None, q=value, target=target, verb=verb)
