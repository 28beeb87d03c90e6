"""What a program may ask of the printer: values of RepRapFirmware's object model (docs.duet3d.com, Object model).

Answered is what the program has said itself, or the cell; all else only the printer knows.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from gcodesim.rs274.fault import Fault
from gcodesim.rs274.marlin.duet.said_to_machine import SaidToMachine
from gcodesim.rs274.marlin.duet.syntax import Value
from gcodesim.rs274.marlin.line import MarlinLine
from gcodesim.rs274.marlin.printer import Printer
from gcodesim.units import MINUTE, MM

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control

Way = tuple[str | int, ...]
"""A name as `move.axes[0].max`, in parts."""

_AXES: Final = "XYZ"
_ANY: Final = "[]"
"""Stands for an index where values are listed."""


class ObjectModel:
    """The values of one printer as its program goes on; lengths are in mm, speeds in mm/min."""

    def __init__(self, control: Control, printer: Printer) -> None:
        self.control = control
        self.printer = printer
        self.said = SaidToMachine()

    def hear(self, line: MarlinLine) -> None:
        """Take in a line that was carried out."""
        self.said.hear(line, self.tool_in_use)

    def value(self, path: Way) -> Value:
        """The value of a name; raises `Fault` where only the printer knows it, or an index goes too far."""
        name = tuple(_ANY if type(part) is int else part for part in path)
        indices = [part for part in path if type(part) is int]
        if name in _VALUES:
            return self._answer(_VALUES[name], indices, path)
        if name[-1:] == (_ANY,) and name[:-1] in _VALUES:
            items = self._answer(_VALUES[name[:-1]], indices[:-1], path)
            if type(items) is tuple:
                return _element(items, indices[-1], path)
        message = f"`{_written(path)}` is a value of the printer, which is not known here"
        raise Fault("GS120", message, hint=_UNKNOWN)

    def exists(self, path: Way) -> bool:
        """Whether a name has a value; raises `Fault` where only the printer knows."""
        try:
            return self.value(path) is not None
        except Fault as fault:
            if fault.code == "GS123":
                return False
            raise

    def _answer(self, known: Callable[..., Value], indices: list[int], path: Way) -> Value:
        try:
            return known(self, *indices)
        except LookupError:
            raise Fault("GS123", f"there is no `{_written(path)}`") from None
        except _NotSaidError as why:
            raise Fault("GS120", f"`{_written(path)}` is not known here: {why}", hint=_UNKNOWN) from None

    # -- answers

    @property
    def tool_in_use(self) -> int:
        """The number of the tool, -1 where T-1 has put it away; before the first T that in the head."""
        return -1 if self.printer.chosen == -1 else self.printer.tool

    @property
    def next_tool(self) -> int:
        """The number of the tool that a T is about to take, else that in use."""
        return self.tool_in_use if self.printer.coming is None else self.printer.coming

    @property
    def unit(self) -> float:
        """Program units in mm."""
        return self.control.state.unit / MM

    def tools(self) -> tuple[Value, ...]:
        """The numbers of tools as T counts them, each at its place; None where there is none."""
        if not self.control.settings.has_cell:
            raise _NotSaidError("the cell says which tools there are")
        first = 1 if self.control.tools and 0 not in self.control.tools else 0
        numbers = {number - first for number in self.control.tools if number >= first}
        return tuple(index if index in numbers else None for index in range(max(numbers, default=-1) + 1))

    def tool(self, index: int) -> int:
        """A tool that there is."""
        if index not in self.tools():
            raise LookupError
        return index


class _NotSaidError(Exception):
    """Nobody has said the value; the message says what would."""


def _axis(index: int) -> int:
    if index >= len(_AXES):
        raise LookupError
    return index


def _said(known: dict[int, float], index: int, word: str) -> float:
    if index not in known:
        raise _NotSaidError(f"the program has not said it by {word}")
    return known[index]


def _limit(end: int) -> Callable[[ObjectModel, int], Value]:
    """An end of the travel of an axis: what M208 said, else what the machine of the cell has."""

    def of(do: ObjectModel, index: int) -> float:
        said = do.said.limits[end].get(_axis(index))
        if said is not None:
            return said
        travel = do.control.settings.travel.get(_AXES[index])
        if travel is None:
            raise _NotSaidError("M208 or a machine with travel in the cell says it")
        return travel[end] / MM - do.control.state.origin[index] * do.unit

    return of


def _current(do: ObjectModel, heater: int) -> Value:
    if heater not in do.said.reached:
        raise _NotSaidError("nobody waited for a temperature by M109, M190 or M116")
    return _said(do.said.active, heater, "M104, M109, M140 or M190")


def _active(do: ObjectModel, heater: int) -> Value:
    return _said(do.said.active, heater, "M104, M109, M140, M190, M568 or G10")


def _heater_state(do: ObjectModel, heater: int) -> Value:
    on = do.said.on.get(heater)
    if on is None:
        raise _NotSaidError("the program has not heated")
    return on


def _tool_state(do: ObjectModel, tool: int) -> Value:
    if do.printer.tool == do.tool(tool):
        return "active"
    return "standby" if tool in do.said.used_tools else "off"


def _of_limits(name: str, scale: float) -> Callable[[ObjectModel, int], Value]:
    return lambda do, index: float(getattr(do.printer.limits, name)[_axis(index)]) / MM * scale


def _extruder_limit(name: str, scale: float) -> Callable[[ObjectModel, int], Value]:
    return lambda do, index: float(getattr(do.printer.limits, name)[3]) / MM * scale


def _nozzle_offset(do: ObjectModel, tool: int) -> Value:
    return tuple(float(value) * do.unit for value in do.printer.offset_of(do.tool(tool))[:3])


def _machine_position(do: ObjectModel) -> list[float]:
    state = do.control.state
    return [(float(here) + float(shift)) * do.unit for here, shift in zip(state.current, state.g92, strict=True)]


def _element(items: tuple[Value, ...], index: int, path: Way) -> Value:
    if index >= len(items):
        raise Fault("GS123", f"there is no `{_written(path)}`")
    return items[index]


def _written(path: Way) -> str:
    return "".join(f"[{part}]" if type(part) is int else f".{part}" for part in path)[1:]


_NAMES: Final[dict[str, Callable[..., Value]]] = {
    "fans.[].actualValue": lambda do, fan: _said(do.said.fans, fan, "M106"),
    "fans.[].requestedValue": lambda do, fan: _said(do.said.fans, fan, "M106"),
    "heat.bedHeaters": lambda do: (do.said.bed,),
    "heat.coldExtrudeTemperature": lambda do: do.said.cold[0],
    "heat.coldRetractTemperature": lambda do: do.said.cold[1],
    "heat.heaters.[].active": _active,
    "heat.heaters.[].current": _current,
    "heat.heaters.[].standby": lambda do, heater: _said(do.said.standby, heater, "M568 or G10"),
    "heat.heaters.[].state": _heater_state,
    "job.layer": lambda do: do.printer.section.layer,
    "move.axes": lambda do: tuple(_AXES),
    "move.axes.[].acceleration": _of_limits("acceleration", 1.0),
    "move.axes.[].babystep": lambda do, axis: do.said.babysteps[_axis(axis)],
    "move.axes.[].homed": lambda do, axis: _axis(axis) in do.said.homed,
    "move.axes.[].jerk": _of_limits("jerk", MINUTE),
    "move.axes.[].letter": lambda do, axis: _AXES[_axis(axis)],
    "move.axes.[].machinePosition": lambda do, axis: _machine_position(do)[_axis(axis)],
    "move.axes.[].max": _limit(1),
    "move.axes.[].min": _limit(0),
    "move.axes.[].speed": _of_limits("speed", MINUTE),
    "move.axes.[].userPosition": lambda do, axis: float(do.control.state.current[_axis(axis)]) * do.unit,
    "move.axes.[].visible": lambda do, axis: _axis(axis) >= 0,
    "move.extruders.[].acceleration": _extruder_limit("acceleration", 1.0),
    "move.extruders.[].factor": lambda do, extruder: do.printer.flow.get(extruder, 1.0),
    "move.extruders.[].jerk": _extruder_limit("jerk", MINUTE),
    "move.extruders.[].speed": _extruder_limit("speed", MINUTE),
    "move.printingAcceleration": lambda do: do.printer.limits.printing / MM,
    "move.speedFactor": lambda do: do.printer.pace,
    "move.travelAcceleration": lambda do: do.printer.limits.travel / MM,
    "state.currentTool": lambda do: do.tool_in_use,
    "state.nextTool": lambda do: do.next_tool,
    "state.previousTool": lambda do: do.said.previous_tool,
    "state.status": lambda do: "processing",
    "tools": lambda do: do.tools(),
    "tools.[].active": lambda do, tool: (_active(do, do.said.heater_of(do.tool(tool))),),
    "tools.[].heaters": lambda do, tool: (do.said.heater_of(do.tool(tool)),),
    "tools.[].number": lambda do, tool: do.tool(tool),
    "tools.[].offsets": _nozzle_offset,
    "tools.[].standby": lambda do, tool: (_said(do.said.standby, do.said.heater_of(do.tool(tool)), "M568 or G10"),),
    "tools.[].state": _tool_state,
}
_VALUES: Final[dict[Way, Callable[..., Value]]] = {tuple(name.split(".")): answer for name, answer in _NAMES.items()}
_UNKNOWN: Final = "what only the printer knows cannot be asked here: write a value, or leave the condition out"
