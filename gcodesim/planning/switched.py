"""When a program switches the devices of its cell."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gcodesim.canon import Spindle
from gcodesim.cell.device import Device, DeviceHistory

if TYPE_CHECKING:
    from gcodesim.motion.trajectory import TimedEvent


def history_of(device: Device, events: Iterable[TimedEvent]) -> DeviceHistory:
    """What a device does by the events of a plan, in their order."""
    times, values = [], []
    for timed in events:
        event = timed.event
        if device.word.type in ("speed", "turning"):
            value = float(event.direction != "off") if isinstance(event, Spindle) else None
        else:
            value = device.word.number_of(event)
        if value is not None:
            times.append(timed.time)
            values.append(value)
    return DeviceHistory(device, times, values)
