"""When sensors read: every so often, at words of the program, or both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

from gcodesim.canon import Action, Noticed
from gcodesim.cell.sensors import MountedSensor
from gcodesim.cell.signals import SignalWord
from gcodesim.frozen import frozen
from gcodesim.sensors.orders import orders_of

if TYPE_CHECKING:
    from gcodesim.cell import Cell
    from gcodesim.planning import Plan
    from gcodesim.sensors.sensor import Sensor

MOST_SIGHTS: Final = 10_000
"""Readings of one sensor that has to see the scene: each takes milliseconds and stands whole in the log."""


@frozen(eq=False)
class Station:
    """A sensor in its place: in a frame of the scene, or, with `tool`, at the tip while that tool is on the flange."""

    name: str
    sensor: Sensor
    frame: str = ""
    tool: int | None = None
    trigger: SignalWord | None = None

    @property
    def log_frame(self) -> str:
        """The frame of the log in which it stands."""
        return "tool" if self.tool is not None else f"{self.sensor.order[0]}/{self.name}"

    def topic(self, output: str) -> str:
        """The topic of one of its outputs."""
        return f"/{self.sensor.order[0]}/{self.name}/{output}"


def stations_of(cell: Cell) -> tuple[Station, ...]:
    """The sensors of a cell, then those that are tools, each with its name; tools are called `T9`."""
    return (
        *(_mounted(name, mounted) for name, mounted in cell.sensors.items()),
        *(
            Station(name=f"T{number}", sensor=tool.sensor, tool=number)
            for number, tool in sorted(cell.tools.items())
            if tool.sensor is not None
        ),
    )


def station_of(cell: Cell, name: str) -> Station:
    """A sensor of the cell by its name."""
    return _mounted(name, cell.sensors[name])


def _mounted(name: str, mounted: MountedSensor) -> Station:
    return Station(name=name, sensor=mounted.sensor, frame=f"sensor/{name}", trigger=mounted.mount.trigger)


def regular_steps(station: Station, step_ns: int, first: int, last: int) -> set[int]:
    """The steps, first < step <= last, at whose end a sensor reads by its period; 0 is the start."""
    return {step for step in _periodic(station.sensor.period, step_ns, first, last) if first < step <= last}


def told_steps(station: Station, plans: Sequence[Plan], step_ns: int) -> set[int]:
    """The last steps that end before a word at which a sensor reads, or with it; 0 is the start."""
    return {step for plan in plans for step in _told(station, plan, step_ns)}


def _periodic(period: float | None, step_ns: int, first: int, last: int) -> Iterator[int]:
    """The first steps that end no earlier than whole periods."""
    if period is None:
        return
    period_ns = max(round(period * 1e9), step_ns)
    for number in range(max(first, 0) * step_ns // period_ns, last * step_ns // period_ns + 1):
        yield -(-number * period_ns // step_ns)


def _told(station: Station, plan: Plan, step_ns: int) -> Iterator[int]:
    orders = orders_of([station.sensor]) if station.trigger is None else ()
    before = 0.0
    for timed in plan.trajectory.events:
        event, now = timed.event, False
        if isinstance(event, Noticed):
            now = event.sensor == station.name
        elif isinstance(event, Action):
            now = (event.target, event.verb) in orders
        if station.trigger is not None:
            value = station.trigger.number_of(event)
            if value is not None:
                now = now or station.trigger.type == "code" or (before == 0.0 and value != 0.0)
                before = value
        if now:
            yield int(round(timed.time * 1e9) // step_ns)
