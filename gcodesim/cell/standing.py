"""How long a cell's machine stands for its spindle, its tools, and devices whose arrival is awaited."""

from __future__ import annotations

from gcodesim.canon import Event
from gcodesim.cell.cell import Cell
from gcodesim.cell.language import devices_of
from gcodesim.motion.standing import Standstill
from gcodesim.rs274.dialects import DIALECTS


def standing_of(cell: Cell, channel: str) -> Standstill:
    """What the program of `channel` waits for."""
    spindle = cell.spindle
    full = spindle.full_speed(cell.limits)
    awaited = [device for device in devices_of(cell, channel) if device.awaited and device.travel_time > 0.0]

    def switching(event: Event) -> float:
        return max((d.travel_time for d in awaited if d.word.number_of(event) is not None), default=0.0)

    return Standstill(
        tool_change=cell.magazine.change_time,
        tool_number=cell.magazine.change_time if DIALECTS[cell.channels[channel].dialect].prints else 0.0,
        run_up=0.0 if full is None else spindle.run_up / full,
        run_down=0.0 if full is None else spindle.run_down / full,
        switching=switching if awaited else None,
    )
