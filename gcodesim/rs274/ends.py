"""Where a block's axis words lead to."""

from __future__ import annotations

import math

from gcodesim.arithmetic.scalars import atan2, cos, sin
from gcodesim.rs274.control import Control
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import AXES, Vector, subtract
from gcodesim.rs274.words import Words

_AXIS_OF = {letter: axis for axis, letter in enumerate(AXES)}


def start_point(control: Control) -> Vector:
    """Where the program believes it is: with cutter compensation the programmed point, not the offset one."""
    state = control.state
    return state.comp_programmed if state.side and not state.comp_first else state.current


def end_point(words: Words, control: Control, *, start: Vector | None = None) -> Vector:
    """The programmed end in the active work system; axes without a word stay.

    `start` is the point to go on from, if that is not the current one.
    """
    state = control.state
    values = words.values
    start = start_point(control) if start is None else start
    if words.g.get(0) == 530:
        return _in_machine_coordinates(words, control)
    if words.has_polar():
        return _polar(words, control, start)
    ends = list(start)
    for letter, value in values.items():
        axis = _AXIS_OF.get(letter)
        if axis is not None:
            ends[axis] = start[axis] + value if state.incremental else value
    return tuple(ends)  # type: ignore[return-value]


def _in_machine_coordinates(words: Words, control: Control) -> Vector:
    """G53: the words are axis positions, so tool offset, work offset, G92 and rotation are taken out."""
    if words.has_polar():
        raise Fault("GS185", "polar words cannot be used with G53", at="g53")
    state = control.state
    axes = control.axes()
    wanted = [words.values.get(letter, axes[axis]) for axis, letter in enumerate(AXES)]
    end = control.point_of(subtract(tuple(wanted), control.length))  # type: ignore[arg-type]
    # as on the control, the tool's offset in A, B and C is left out of it
    turned = [
        words.values[letter] - state.origin[axis] - state.g92[axis] if letter in words.values else state.current[axis]
        for axis, letter in ((3, "a"), (4, "b"), (5, "c"))
    ]
    return (*end[:3], *turned, *end[6:])  # type: ignore[return-value]


def _polar(words: Words, control: Control, start: Vector) -> Vector:
    """@ radius and ^ angle about the program's origin."""
    state = control.state
    radius, angle = words.get("@"), words.get("^")
    here = math.hypot(start[0], start[1])
    if state.incremental:
        if here == 0.0:
            at = "@" if radius is not None else "^"
            raise Fault("GS185", "at the origin there is no angle and no radius to add to", at=at, hint="say G90")
        bearing = math.degrees(atan2(start[1], start[0])) + (angle or 0.0)
        distance = here + (radius or 0.0)
    else:
        if here == 0.0 and angle is None:
            raise Fault("GS185", "at the origin the angle ^ has to be given", at="@")
        bearing = math.degrees(atan2(start[1], start[0])) if angle is None else angle
        distance = here if radius is None else radius
    sign = 1.0 if state.incremental else 0.0
    rest = [
        words.values.get(letter, 0.0 if sign else start[axis]) + sign * start[axis] for axis, letter in enumerate(AXES)
    ]
    x, y = distance * cos(math.radians(bearing)), distance * sin(math.radians(bearing))
    return (x, y, *rest[2:])  # type: ignore[return-value]
