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
        cap = words.get("d")
        state.surface_speed = cap != 0.0  # D0 makes it revolutions per minute, as on the control
        state.surface_speed_cap = abs(cap) if cap else None
    else:
        state.surface_speed = False
        state.surface_speed_cap = None
    control.say_spindle()


def feed_mode(words: Words, control: Control) -> None:
    """G93, G94, G95; the latter two discard F."""
    code = words.g.get(FEED_MODE)
    state = control.state
    if code is not None:
        state.feed_mode = code
        if code != 930:
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
    if code is None:
        return
    now = code == 70
    if now != control.state.diameter and "x" in words.values:
        words.values["x"] *= 0.5 if now else 2.0  # it was read as it was before the change
    control.state.diameter = now


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
        tolerance, naive = (_tolerance(words, control, letter) for letter in "pq")
        state.path_tolerance = (tolerance or 0.0) * state.unit
        state.path_naive = state.path_tolerance if naive is None else naive * state.unit
        if words.get("r") is not None and "m19" not in words.names:  # beside M19 it is the angle of the spindle
            control.skip("G64 R", words.block.place_of("r"))
    control.say_path()


def _tolerance(words: Words, control: Control, letter: str) -> float | None:
    """P or Q of G64; a negative one counts as none."""
    value = words.get(letter)
    if value is not None and value < 0.0:
        control.warn("GS106", f"the tolerance {letter.upper()}{value:g} of G64 is negative and counts as none")
        return None
    return value


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
