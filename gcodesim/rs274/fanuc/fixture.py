"""Rotary table dynamic fixture offset: G54.2 Pn, and G54.2 P0.

The work system has its zero on the axis of the table; the stored offset leads from there to the zero of the work,
measured while the table stands at the stored angles. It turns along with the table, the axes of the work system do
not:

    zero of the work = work system + R(angles) R(stored angles)⁻¹ (stored offset)

Angles are those at the end of a block, so a block that turns the table alone takes the tool along.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcodesim.rs274.dialects.fanuc import FIXTURES, WORK_FIXTURE
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import ZERO, Vector, add, scaled
from gcodesim.rs274.words import Words, place_of

if TYPE_CHECKING:
    from gcodesim.rs274.fanuc.control import FanucControl

_STILL = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_HINT = "give the rotary axes of the table a point (`at:`); without it the moves would be others than on the control"


def switch(words: Words, control: FanucControl) -> None:
    """G54.2 Pn; P0 ends it. The axes stay; what the program reads changes."""
    if words.g.get(WORK_FIXTURE) is None:
        return
    state = control.state
    words.need("p", "GS105", "G54.2", "P is the number of the fixture offset, P0 ends it")
    number = words.whole("p", "G54.2")
    assert number is not None
    del words.values["p"]
    if not 0 <= number <= len(FIXTURES):
        last = len(FIXTURES)
        raise Fault("GS106", f"G54.2 P{number}: P runs from 0 to {last}", at="p", value=number, limit=last)
    if state.side:
        raise Fault("GS150", "G54.2 is refused in cutter compensation", at="g54.2", hint="say G40 first")
    if number and (state.tilt is not None or state.point_control):
        refuse(control, "G54.2", in_force=True)
    law = control.settings.tool_point
    if number and law is None and not control.settings.has_cell:
        control.skip("G54.2", place_of(words.block, "g54.2"))
    elif number and (law is None or law.carried((1.0, 0.0, 0.0), _STILL, _STILL) is None):
        message = "G54.2 is not simulated here: no rotary axis of the table has a place"
        raise Fault("GS915", message, at="g54.2", hint=_HINT)
    control.reframe(fixture=number)


def refuse(control: FanucControl, who: str, *, in_force: bool = False) -> None:
    """`who` and G54.2 cannot be at once: both take the work system along with the table."""
    if in_force or control.state.fixture:
        message = "G54.2 and the control of the tip, or a tilted plane, cannot be in force at once"
        hint = "G54.2 P0 ends it; G49 and G69 end the others"
        raise Fault("GS106", message, at=who.lower(), hint=hint)


def shifted(control: FanucControl, tip: Vector, sign: float) -> Vector:
    """`tip` with the offset in force added, or taken off; its A, B, C say how the table stands."""
    number, law = control.state.fixture, control.settings.tool_point
    if not number or law is None:
        return tip
    stored = control.stored(FIXTURES[number - 1])
    vector = (*stored[:3], *ZERO[3:])
    before = (*ZERO[:3], *stored[3:6], *ZERO[6:])
    axes = [control.si_axes(v) for v in (vector, before, tip)]
    x, y, z = axes[0][:3]
    moved = law.carried((x, y, z), axes[1], axes[2])
    assert moved is not None
    unit = control.state.unit
    return add(tip, scaled((moved[0], moved[1], moved[2], *ZERO[3:]), sign / unit))
