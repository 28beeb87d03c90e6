"""Modes that G codes set: units, plane, distance, feed, path control, retract level."""

from __future__ import annotations

from gcodesim.rs274 import compensation
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects import g_name
from gcodesim.rs274.dialects.linuxcnc import (
    CENTRE,
    DIAMETER,
    DISTANCE,
    FEED_MODE,
    PATH,
    PLANE,
    RETRACT,
    SPINDLE_MODE,
    UNITS,
)
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.words import Words
from gcodesim.units import INCH, MM


def spindle_mode(words: Words, control: Control) -> None:
    """G96 and G97."""
    code = words.g.get(SPINDLE_MODE)
    if code is None:
        return
    state = control.state
    if code == 960:
        if "s" not in words.values:
            raise Fault("GS105", "G96 needs the word S", at="g96", hint="S is the cutting speed, D the greatest rpm")
        state.surface_speed = True
        cap = words.get("d")
        state.surface_speed_cap = abs(cap) if cap else None
    else:
        state.surface_speed = False
        state.surface_speed_cap = None
    control.say_spindle()


def feed_mode(words: Words, control: Control) -> None:
    """G93, G94, G95; a change discards F."""
    code = words.g.get(FEED_MODE)
    state = control.state
    if code is not None and code != state.feed_mode:
        state.feed_mode = code
        state.feed = 0.0


def feed_rate(words: Words, control: Control) -> None:
    """F, in the unit in force before this block's G20 or G21."""
    value = words.get("f")
    if value is not None and control.state.feed_mode != 930:
        control.state.feed = value
        control.state.feed_unit = control.state.unit


def plane(words: Words, control: Control) -> None:
    code = words.g.get(PLANE)
    if code is None:
        return
    if control.state.side and code != control.state.plane:
        raise Fault(
            "GS150",
            "the plane cannot change while cutter compensation is on",
            at=f"g{code // 10}",
            hint="say G40 first",
        )
    control.state.plane = code


def units(words: Words, control: Control) -> None:
    code = words.g.get(UNITS)
    if code is not None:
        unit = INCH if code == 200 else MM
        factor = control.state.unit / unit
        control.change_unit(unit)
        if control.state.side and factor != 1.0:
            compensation.scale(control, factor)


def diameter(words: Words, control: Control) -> None:
    """G7 and G8."""
    code = words.g.get(DIAMETER)
    if code is not None:
        control.state.diameter = code == 70


def path_control(words: Words, control: Control) -> None:
    """G61, G61.1, G64 P Q."""
    code = words.g.get(PATH)
    if code is None:
        return
    state = control.state
    if state.side:
        hint = "say G40 first"
        raise Fault("GS150", "path control cannot change while cutter compensation is on", at=g_name(code), hint=hint)
    state.path = code
    if code == 640:
        tolerance, naive = words.get("p"), words.get("q")
        if (tolerance or 0.0) < 0.0 or (naive or 0.0) < 0.0:
            raise Fault("GS106", "a tolerance of G64 is negative", at="p" if (tolerance or 0.0) < 0.0 else "q")
        state.path_tolerance = (tolerance or 0.0) * state.unit
        state.path_naive = state.path_tolerance if naive is None else naive * state.unit
    control.say_path()


def distance(words: Words, control: Control) -> None:
    """G90, G91, G90.1, G91.1."""
    code = words.g.get(DISTANCE)
    if code is not None:
        control.state.incremental = code == 910
    code = words.g.get(CENTRE)
    if code is not None:
        control.state.centre_absolute = code == 901


def retract(words: Words, control: Control) -> None:
    """G98, G99."""
    code = words.g.get(RETRACT)
    if code is not None and control.state.side:
        hint = "say G40 first"
        raise Fault("GS150", f"G{code // 10} is refused while cutter compensation is on", at=g_name(code), hint=hint)
    if code is not None:
        control.state.retract = code
