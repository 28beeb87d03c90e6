"""When a program switches the devices of its cell."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from gcodesim.canon import Spindle
from gcodesim.cell.device import Device, DeviceHistory
from gcodesim.diagnostics import Span

if TYPE_CHECKING:
    from gcodesim.motion.trajectory import TimedEvent


def history_of(device: Device, events: Iterable[TimedEvent]) -> DeviceHistory:
    """What a device does by the events of a plan, in their order."""
    changes = list(_changes(device, events))
    return DeviceHistory(device, [timed.time for timed, _ in changes], [value for _, value in changes])


def switches_of(device: Device, events: Iterable[TimedEvent]) -> list[tuple[float, Span]]:
    """When a device is switched [s], and by which word."""
    return [(timed.time, timed.event.span) for timed, _ in _changes(device, events)]


def _changes(device: Device, events: Iterable[TimedEvent]) -> Iterator[tuple[TimedEvent, float]]:
    for timed in events:
        event = timed.event
        if device.word.type in ("speed", "turning"):
            value = float(event.direction != "off") if isinstance(event, Spindle) else None
        else:
            value = device.word.number_of(event)
        if value is not None:
            yield timed, value
