"""G38.2 to G38.5: straight probing."""

from __future__ import annotations

from gcodesim import canon
from gcodesim.rs274 import parameters as numbers
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words, place_of
from gcodesim.units import DEG


def probe(words: Words, control: Control, code: int) -> None:
    """Move towards or away from the workpiece until the probe changes."""
    state = control.state
    who = g_name(code).upper()
    at = who.lower() if who.lower() in words.names else None
    if state.side:
        raise Fault("GS150", f"{who} is refused while cutter compensation is on", at=at, hint="say G40 first")
    if state.feed_mode == 950:
        raise Fault("GS180", f"{who} cannot be used under G95", at=at, hint="say G94 and F before")
    if state.feed == 0.0:
        raise Fault("GS107", f"{who} without a feed: F is 0", at=at, hint="write F before or in this block")
    end = end_point(words, control)
    if code in (382, 384) and end == state.current:
        raise Fault("GS180", f"{who} ends where it starts", at=at, hint="probe towards another point")
    control.skip(who, place_of(words.block, who.lower()))
    feed, unit = control.feed(control.moves_linear(end))
    control.out.append(
        canon.Probe(
            span=control.span,
            end=control.si_axes(control.tip(end)),
            block=control.block_number,
            word=who,
            feed=feed,
            feed_unit=unit,
            towards=code in (382, 383),
            must_trip=code in (382, 384),
        )
    )
    state.current = end


def tripped(control: Control, event: canon.Probe, reply: canon.Axes | None) -> None:
    """Take over where the probe stopped: `reply` in the machine frame, or the programmed end."""
    state = control.state
    if reply is not None:
        unit = state.unit
        tip: Vector = (
            *(value / unit for value in reply[:3]),
            *(value / DEG for value in reply[3:]),
            *control.tip(state.current)[6:],
        )  # type: ignore[assignment]
        state.current = control.point_of(tip)
    control.parameters.changes += 1
    for axis in range(9):
        value = control.machine_units(state.current[axis], axis)
        control.parameters.numbers[numbers.PROBE + axis] = state.current[axis] if axis < 9 else value
    control.parameters.numbers[numbers.PROBE_RESULT] = 1.0
