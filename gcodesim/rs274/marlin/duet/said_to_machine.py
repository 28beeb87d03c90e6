"""What a program has said to its printer that moves nothing, but can be asked for."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from gcodesim.rs274.marlin.line import MarlinLine

_XYZ: Final = "xyz"
_FULL: Final = 255.0
_RANGE: Final = re.compile(r"([XYZxyz])[ \t]*([-+]?[0-9.]+)(?:[ \t]*:[ \t]*([-+]?[0-9.]+))?")
_PROBE: Final = re.compile(r"([HFhf])[ \t]*([0-9]+\.?[0-9]*)")
_STATES: Final = {0.0: "off", 1.0: "standby", 2.0: "active"}  # M568 A


@dataclass(slots=True)
class SaidToMachine:
    """Axes, tools, heaters and fans by their numbers; temperatures in °C, lengths in mm.

    `limits` are the ends of the travel (M208). `active` and `standby` are temperatures to be kept, `reached` the
    heaters that were waited for since theirs was set, `on` what each is doing where that is certain. `cold` are the
    temperatures below which nothing is extruded or retracted. A probe comes down from `dive_height` at `probe_speed`
    [mm/min] (M558); at first they are those of the firmware. Unless the program says otherwise (M140 H, M563), heater
    0 is the bed's, and tool 0 has heater 1, as in the firmware's own configurations.
    """

    homed: set[int] = field(default_factory=set)
    limits: tuple[dict[int, float], dict[int, float]] = field(default_factory=lambda: ({}, {}))
    babysteps: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    active: dict[int, float] = field(default_factory=dict)
    standby: dict[int, float] = field(default_factory=dict)
    reached: set[int] = field(default_factory=set)
    on: dict[int, str] = field(default_factory=dict)
    cold: tuple[float, float] = (160.0, 90.0)
    dive_height: float = 5.0
    probe_speed: float = 120.0
    bed: int = 0
    heaters: dict[int, int] = field(default_factory=dict)
    fans: dict[int, float] = field(default_factory=dict)
    tool: int = -1
    previous_tool: int = -1
    used_tools: set[int] = field(default_factory=set)

    def hear(self, line: MarlinLine, tool: int) -> None:
        """Take in a line that was carried out; `tool` is in use behind it."""
        if tool != self.tool:
            self.previous_tool, self.tool = self.tool, tool
            self.used_tools.add(tool)
        if (act := _HEARD.get(line.name)) is not None:
            act(self, line)

    def heater_of(self, tool: int) -> int:
        return self.heaters.get(tool, tool + 1)

    def keep(self, heater: int, temperature: float | None, *, waits: bool) -> None:
        """A heater is to have a temperature; `waits`: and has it."""
        if temperature is not None:
            if temperature != self.active.get(heater):
                self.reached.discard(heater)
            self.active[heater] = temperature
            self.on.pop(heater, None)
            if temperature > 0.0:
                self.on[heater] = "active"
        if waits and heater in self.active:
            self.reached.add(heater)


Act = Callable[[SaidToMachine, MarlinLine], None]


def _index(line: MarlinLine, letter: str, usual: int) -> int:
    value = line.get(letter)
    return usual if value is None else int(value)


def _axes(line: MarlinLine) -> list[int]:
    return [axis for axis, letter in enumerate(_XYZ) if letter in line.values]


def _home(said: SaidToMachine, line: MarlinLine) -> None:
    """G28."""
    said.homed.update(_axes(line) or range(3))


def _set_position(said: SaidToMachine, line: MarlinLine) -> None:
    """G92: an axis whose place is said counts as homed."""
    said.homed.update(_axes(line) if line.values else range(3))


def _to_end(said: SaidToMachine, line: MarlinLine) -> None:
    """G0 or G1 with H1: the axes that are named are homed."""
    if line.get("h") == 1.0:
        said.homed.update(_axes(line))


def _single_probe(said: SaidToMachine, line: MarlinLine) -> None:
    """G30 alone homes Z."""
    if not line.values:
        said.homed.add(2)


def _z_probe(said: SaidToMachine, line: MarlinLine) -> None:
    """M558: H is the dive height, F the speed; of `H5:2` and `F600:120` the first counts."""
    for letter, value in _PROBE.findall(line.code):
        if letter in "Hh":
            said.dive_height = float(value)
        elif float(value) > 0.0:
            said.probe_speed = float(value)


def _motors_off(said: SaidToMachine, line: MarlinLine) -> None:
    """M18, M84: nobody knows any more where the axes are."""
    named = line.has("xyze")
    said.homed.difference_update(_axes(line) if named else range(3))


def _limits(said: SaidToMachine, line: MarlinLine) -> None:
    """M208: `X0:200`, or S1 for the lower ends, else the upper ones."""
    for letter, first, second in _RANGE.findall(line.code):
        axis = _XYZ.index(letter.lower())
        if second:
            said.limits[0][axis], said.limits[1][axis] = float(first), float(second)
        else:
            said.limits[0 if line.get("s") == 1.0 else 1][axis] = float(first)


def _babysteps(said: SaidToMachine, line: MarlinLine) -> None:
    """M290: S is Z; R0 sets them, else they add up."""
    steps = {axis: line.get(letter) for axis, letter in enumerate(_XYZ)}
    if line.get("s") is not None:
        steps[2] = line.get("s")
    for axis, step in steps.items():
        if step is not None:
            said.babysteps[axis] = step + (0.0 if line.get("r") == 0.0 else said.babysteps[axis])


def _nozzle(waits: bool) -> Act:
    """M104, M109."""

    def act(said: SaidToMachine, line: MarlinLine) -> None:
        heater = said.heater_of(_index(line, "t", said.tool))
        said.keep(heater, line.get("s") if line.get("s") is not None else line.get("r"), waits=waits)

    return act


def _bed(waits: bool) -> Act:
    """M140, M190."""

    def act(said: SaidToMachine, line: MarlinLine) -> None:
        said.bed = _index(line, "h", said.bed)
        said.keep(said.bed, line.get("s") if line.get("s") is not None else line.get("r"), waits=waits)

    return act


def _tool_temperatures(said: SaidToMachine, line: MarlinLine) -> None:
    """M568, and G10 with P: S while the tool works, R while it waits, A what its heater does."""
    tool = _index(line, "p", said.tool)
    heater = said.heater_of(tool)
    if (active := line.get("s")) is not None:
        known = said.on.get(heater)
        said.keep(heater, active, waits=False)
        if tool != said.tool:
            said.on.pop(heater, None)
            if known is not None:
                said.on[heater] = known
    if (standby := line.get("r")) is not None:
        said.standby[heater] = standby
    if (state := line.get("a")) is not None and state in _STATES:
        said.on[heater] = _STATES[state]


def _wait(said: SaidToMachine, line: MarlinLine) -> None:
    """M116: for all heaters, or those of tool P, or heater H."""
    if line.get("p") is not None:
        waited = {said.heater_of(_index(line, "p", 0))}
    elif line.get("h") is not None:
        waited = {_index(line, "h", 0)}
    else:
        waited = set(said.active)
    said.reached |= waited & said.active.keys()


def _define_tool(said: SaidToMachine, line: MarlinLine) -> None:
    """M563: H is the heater of tool P."""
    if line.get("p") is not None and line.get("h") is not None:
        said.heaters[_index(line, "p", 0)] = _index(line, "h", 0)


def _cold(said: SaidToMachine, line: MarlinLine) -> None:
    """M302."""
    extrude, retract = line.get("s"), line.get("r")
    said.cold = (said.cold[0] if extrude is None else extrude, said.cold[1] if retract is None else retract)


def _fan(said: SaidToMachine, line: MarlinLine) -> None:
    """M106, M107: up to 1 a share, above that of 255."""
    speed = 0.0 if line.name == "M107" else line.get("s")
    if speed is not None:
        said.fans[_index(line, "p", 0)] = min(speed if speed <= 1.0 else speed / _FULL, 1.0)


_HEARD: Final[dict[str, Act]] = {
    "G0": _to_end,
    "G1": _to_end,
    "G10": _tool_temperatures,
    "G28": _home,
    "G30": _single_probe,
    "G92": _set_position,
    "M18": _motors_off,
    "M84": _motors_off,
    "M104": _nozzle(False),
    "M106": _fan,
    "M107": _fan,
    "M109": _nozzle(True),
    "M116": _wait,
    "M140": _bed(False),
    "M190": _bed(True),
    "M208": _limits,
    "M290": _babysteps,
    "M302": _cold,
    "M558": _z_probe,
    "M563": _define_tool,
    "M568": _tool_temperatures,
}
