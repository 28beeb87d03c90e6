"""What is still on when a program ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from gcodesim.canon import Action, Coolant, End, Event, Spindle
from gcodesim.cell.signals import SignalSource
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.units import RPM

_TOOL: Final = "the process tool"


def left_on(events: Sequence[Event], active: SignalSource | None = None) -> list[Diagnostic]:
    """GS503 to GS505 from a program's events; what M2 and M30 themselves switch off was on until then.

    `active` is what switches the process tool in this cell, if no action does. A word of the spindle is left to GS503.

    There are none for a program that was not read to its end.
    """
    ends = [event for event in events if isinstance(event, End)]
    if not ends:
        return []
    last = ends[-1].span
    spindle, cutting, flood, mist, process = 0.0, False, False, False, None
    for event in events:
        if event.span == last:
            continue
        if isinstance(event, Spindle):
            spindle = 0.0 if event.direction == "off" else event.speed * (1.0 if event.direction == "cw" else -1.0)
            cutting = event.unit == "m/s"
        elif isinstance(event, Coolant):
            flood, mist = event.flood, event.mist
        elif isinstance(event, Action) and event.target == "tool":
            process = _TOOL if event.verb == "activate" else None
        if active is not None and (number := active.word.number_of(event)) is not None:
            process = _TOOL if active.factor * number + active.zero > 0.0 else None
    return end_findings(last, spindle=spindle, cutting=cutting, process=process, flood=flood, mist=mist)


def end_findings(
    last: Span,
    *,
    spindle: float = 0.0,
    cutting: bool = False,
    process: str | None = None,
    flood: bool = False,
    mist: bool = False,
) -> list[Diagnostic]:
    """GS503 to GS505: what is still on when the program ends at `last`.

    `spindle` [rad/s], or the cutting speed [m/s] that it keeps where `cutting`;
    `process` names the process tool that an M-code left on.
    """
    found = []
    if spindle != 0.0:
        speed, unit = (abs(spindle) * 60.0, "m/min") if cutting else (abs(spindle) / RPM, "rpm")
        word = "M3" if spindle > 0.0 else "M4"
        found.append(
            Diagnostic(
                code="GS503",
                message=f"the program ends with the spindle on ({word}, {speed:.0f} {unit})",
                span=last,
                hint="put `M5` before the end",
                value=speed,
                limit=0.0,
                unit=unit,
            )
        )
    if process is not None:
        found.append(Diagnostic(code="GS504", message=f"the program ends while {process} is still on", span=last))
    if flood or mist:
        kind = " and ".join(word for word, on in (("flood", flood), ("mist", mist)) if on)
        found.append(
            Diagnostic(
                code="GS505",
                message=f"the program ends with {kind} coolant on",
                span=last,
                hint="put `M9` before the end",
            )
        )
    return found
