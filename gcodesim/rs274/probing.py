"""G38.2 to G38.5: straight probing."""

from __future__ import annotations

from gcodesim import canon
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
    if not control.settings.answered:
        control.skip(who, place_of(words.block, who.lower()))
    feed, unit = control.feed(control.moves_linear(end))
    control.out.append(
        canon.ProbeMove(
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


def tripped(
    control: Control, event: canon.ProbeMove, reply: canon.Touched | canon.Axes | None, *, meets: bool = True
) -> Fault | None:
    """Store where the probe tripped and stopped; returns the fault with which a control would stop there.

    A `reply` of axes is both places in one; None: it trips at the programmed end, unless it may miss and never `meets`.
    """
    state = control.state
    tripping = reply is not None or meets or event.must_trip
    point = state.current
    if isinstance(reply, canon.Touched):
        tripping = reply.tripped
        point = _here(control, reply.point)
        state.current = _here(control, reply.stop)
    elif reply is not None:
        point = state.current = _here(control, reply)
    control.parameters.changes += 1
    control.remember_trip(point, tripped=tripping)
    return _fault(event, reply) if isinstance(reply, canon.Touched) else None


def _here(control: Control, axes: canon.Axes) -> Vector:
    """A controlled point in M as the active work system has it; axes that no machine here has stay where they are."""
    unit, state = control.state.unit, control.state
    x, y, z = (value / unit for value in axes[:3])
    a, b, c = (value / DEG for value in axes[3:])
    return control.point_of((x, y, z, a, b, c, *control.tip(state.current)[6:]))


def _fault(event: canon.ProbeMove, reply: canon.Touched) -> Fault | None:
    who, what = event.word, "contact" if event.towards else "a loss of contact"
    if reply.refused:
        now, hint = "touches nothing", "touch the surface first"
        if event.towards:
            now, hint = "touches something already", "back off first"
        return Fault("GS139", f"the probe {now} where {who} begins", hint=hint)
    if event.must_trip and not reply.tripped:
        softer = "G38.3" if event.towards else "G38.5"
        hint = f"begin nearer or go further; with {softer} and #5070 the program can decide itself"
        return Fault("GS138", f"{who} came to its end without {what}", hint=hint)
    return None
