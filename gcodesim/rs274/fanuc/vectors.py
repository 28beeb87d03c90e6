"""G43.5: the direction of the tool as a vector I J K, from tip to holder, in the work system or the tilted plane."""

from __future__ import annotations

from gcodesim.rs274 import tool_point
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.words import Words
from gcodesim.units import DEG

BY_VECTOR = 435
_LETTERS = "ijk"
_SMALL = 1e-9


def resolve(words: Words, control: FanucControl) -> None:
    """Put A, B and C in place of I, J and K; a block without them keeps the attitude."""
    state, values = control.state, words.values
    given = [values.pop(letter, None) for letter in _LETTERS]
    if turned := next((letter for letter in "abc" if letter in values), None):
        hint = "I J K is the direction of the tool; rotary words belong to G43.4"
        raise Fault("GS106", f"{turned.upper()} cannot be commanded under G43.5", at=turned, hint=hint)
    if all(value is None for value in given):
        return
    vector = (given[0] or 0.0, given[1] or 0.0, given[2] or 0.0)
    at = next(letter for letter, value in zip(_LETTERS, given, strict=True) if value is not None)
    if sum(value * value for value in vector) < _SMALL:
        raise Fault("GS106", "I J K of zero is no direction", at=at)
    law = control.settings.tool_point
    if law is None:
        if not control.settings.has_cell:
            control.skip("I J K", words.block.place_of(at))
        elif vector[0] or vector[1] or vector[2] < 0.0:
            raise Fault(
                "GS915",
                "I J K is not simulated here: no rotary axis of the machine has a place",
                at=at,
                hint="give its rotary axes a point (`at:`); without it the moves would be others than on the control",
            )
        return
    own = vector if state.tilt is None else state.tilt.direction(vector)
    direction = tool_point.direction_for(law, control, own)
    here = control.si_axes(control.axes())
    ways = law.attitudes(direction, here)
    if not ways:
        letters = " and ".join(law.letters)
        raise Fault("GS106", f"{letters} cannot bring the tool along this vector", at=at)
    way = tool_point.nearest(ways, here, tool_point.tilting_axis(law))
    for axis in (3, 4, 5):
        read = state.current[axis] + (way[axis] - here[axis]) / DEG
        values["abc"[axis - 3]] = read - state.current[axis] if state.incremental else read
