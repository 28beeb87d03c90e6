"""G16: the first axis of the plane is a radius, the second an angle, until G15."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from gcodesim.arithmetic.scalars import atan2, cos, sin
from gcodesim.frozen import frozen
from gcodesim.rs274.arcs import PLANE_AXES
from gcodesim.rs274.cycles import check_repeats
from gcodesim.rs274.dialects.fanuc import POLAR
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words

ON, OFF = 160, 150


@frozen(kw_only=False)
class Polar:
    """What an axis word that is missing stands for: centre [program units], radius, angle [deg]."""

    centre: tuple[float, float]
    radius: float
    angle: float


def switch(words: Words, control: FanucControl) -> None:
    """G15 and G16. Before the first radius and angle, those of the point where the tool stands count."""
    code, state = words.g.get(POLAR), control.state
    if code == OFF:
        state.polar = None
    elif code == ON:
        first, second, _ = PLANE_AXES[state.plane]
        x, y = state.current[first], state.current[second]
        state.polar = Polar((0.0, 0.0), math.hypot(x, y), math.degrees(atan2(y, x)))


def resolve(words: Words, control: FanucControl, start: Vector) -> None:
    """Put the coordinates of the end in place of radius and angle.

    In G90 a radius counts from the program's zero and an angle from the first axis; in G91 a radius counts from
    `start`, which stays the centre until the next radius, and an angle is added.
    """
    state = control.state
    if state.polar is None:
        return
    first, second, _ = PLANE_AXES[state.plane]
    a, b = "xyz"[first], "xyz"[second]
    values = words.values
    if not {"i", "j", "k"}.isdisjoint(values):
        letter = next(letter for letter in "ijk" if letter in values)
        raise Fault("GS110", "in polar coordinates an arc is given by R", at=letter, hint="say G15 before, or write R")
    if a not in values and b not in values:
        return
    if state.scale != (1.0, 1.0, 1.0) or state.mirror != (None, None, None):
        hint = "say G50 and G50.1 before, or G15"
        raise Fault("GS106", "G16 is not simulated together with G51 or G51.1", at=a if a in values else b, hint=hint)
    polar = state.polar
    radius, angle = values.pop(a, None), values.pop(b, None)
    if radius is not None:
        centre = (start[first], start[second]) if state.incremental else (0.0, 0.0)
        polar = replace(polar, centre=centre, radius=radius)
    if angle is not None:
        polar = replace(polar, angle=polar.angle + angle if state.incremental else angle)
    state.polar = polar
    turn = math.radians(polar.angle)
    end = (polar.centre[0] + polar.radius * cos(turn), polar.centre[1] + polar.radius * sin(turn))
    for letter, axis, value in ((a, first, end[0]), (b, second, end[1])):
        values[letter] = value - start[axis] if state.incremental else value


def repeats(words: Words, control: FanucControl, code: int) -> Iterator[Words]:
    """The block of a cycle, as often as it drills: with K an incremental angle is added for every hole."""
    letter = next((letter for letter in "kl" if letter in words.values), None)
    if control.state.polar is None or not control.state.incremental or letter is None:
        yield words
        return
    who = f"G{code // 10}"
    count = words.whole(letter, who) or 0
    check_repeats(count, 0.0, 0.0, who, letter)
    for _ in range(max(1, count)):
        own = Words(words.block)
        own.g, own.names = words.g, words.names
        own.values = {name: value for name, value in words.values.items() if name != letter or value < 1.0}
        yield own


def refuse(words: Words, control: FanucControl, who: str) -> None:
    """Codes whose words have no meaning in polar coordinates in any manual."""
    if control.state.polar is not None and words.has_axes():
        raise Fault("GS106", f"{who} is not simulated in polar coordinates", at=who.lower(), hint="say G15 before")
