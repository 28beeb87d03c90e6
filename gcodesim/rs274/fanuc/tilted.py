"""Tilted working planes: G68.2 in its forms, G53.1, and G69.

The axes of the plane are columns of a rotation; its zero is a point of the work system:

    point of the work = zero + R (point of the plane)

G53.1 turns the tool upright to the plane. From there on the control holds the tip, so that the tool's length counts
along the tool and the work may stand turned on its table.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.arithmetic.scalars import cos_sin
from gcodesim.frozen import frozen
from gcodesim.rs274 import tool_point
from gcodesim.rs274.fanuc import fixture
from gcodesim.rs274.fanuc.control import FanucControl
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector, subtract
from gcodesim.rs274.tilt import Rows, Tilt
from gcodesim.rs274.words import Words, place_of
from gcodesim.units import DEG

_SMALL = 1e-6  # of a length or a sine: shorter vectors have no direction
_CLOSE = tool_point.CLOSE
PLANE = 682  # G68.2
_FORMS = {0: "Euler angles", 1: "roll, pitch and yaw", 2: "three points", 3: "two vectors", 4: "projected angles"}
_LAST = {2: 3, 3: 2}  # the Q with which a form that takes several blocks is complete


class Point(NamedTuple):
    """A point or a direction; program units, or none."""

    x: float
    y: float
    z: float


@frozen(kw_only=False)
class Begun:
    """A plane of which some blocks are read: its form P and what each Q gave."""

    form: int
    given: tuple[tuple[int, tuple[float | None, ...]], ...]


def switch(words: Words, control: FanucControl) -> None:
    """G68.2; it takes its words out of the block."""
    if control.state.side:
        raise Fault("GS150", "G68.2 is refused in cutter compensation", at="g68.2", hint="say G40 first")
    if control.state.turn is not None:
        raise Fault("GS106", "G68.2 is refused while G68 turns the system", at="g68.2", hint="say G69 first")
    fixture.refuse(control, "G68.2")
    form = words.whole("p", "G68.2") or 0
    words.values.pop("p", None)
    if form not in _FORMS:
        known = ", ".join(f"P{number} {name}" for number, name in _FORMS.items())
        raise Fault("GS106", f"G68.2 P{form} is no form of a plane", at="p", hint=f"known are {known}")
    step = words.whole("q", "G68.2")
    words.values.pop("q", None)
    numbers = tuple(words.values.pop(letter, None) for letter in "xyzijkr")
    if form in _LAST:
        tilt = _gathered(form, step, numbers, control)
        if tilt is None:
            return
    else:
        tilt = Tilt(_point(numbers[:3]), _turned(form, step, _point(numbers[3:6])))
        control.state.plane_begun = None
    off(control)
    control.reframe(tilt=tilt)


def off(control: FanucControl) -> None:
    """The plane in force ends; the axes stay."""
    state = control.state
    if state.upright and state.length_mode not in tool_point.CENTRE_POINT:
        tool_point.switch(control, on=False)
    state.upright = False
    if state.tilt is not None:
        control.reframe(tilt=None)


def turn_tool(words: Words, control: FanucControl) -> None:
    """G53.1: rotary axes turn until the tool stands upright on the plane; the linear ones stay."""
    state = control.state
    if state.tilt is None:
        raise Fault("GS105", "G53.1 without a plane", at="g53.1", hint="say G68.2 before")
    if state.side:
        raise Fault("GS150", "G53.1 is refused in cutter compensation", at="g53.1", hint="say G40 first")
    choice = words.whole("p", "G53.1") or 0
    words.values.pop("p", None)
    if choice not in (0, 1, 2):
        raise Fault("GS106", f"G53.1 P{choice}: P is 0, 1 or 2", at="p", value=choice, limit=2)
    law = control.settings.tool_point
    normal = state.tilt.direction(Point(0.0, 0.0, 1.0))
    direction = control.leant(normal)
    if law is not None:
        tool_point.switch(control, on=False)
        _turn(control, law, tool_point.direction_for(law, control, normal), choice)
    elif not control.settings.has_cell:
        control.skip("G53.1", place_of(words.block, "g53.1"))
    elif abs(direction[0]) > _SMALL or abs(direction[1]) > _SMALL or direction[2] < 0.0:
        raise Fault(
            "GS915",
            "G53.1 is not simulated here: no rotary axis of the machine has a place",
            at="g53.1",
            hint="give its rotary axes a point (`at:`); without it the moves would be others than on the control",
        )
    state.upright = True
    tool_point.switch(control, on=True)


def _turn(control: FanucControl, law: tool_point.ToolPointLaw, direction: tuple[float, ...], choice: int) -> None:
    axes = control.axes()
    here = control.si_axes(axes)
    ways = law.attitudes((direction[0], direction[1], direction[2]), here)
    tilting = tool_point.tilting_axis(law)

    if choice:
        sign = 1.0 if choice == 1 else -1.0
        ways = [way for way in ways if sign * way[tilting] >= -_CLOSE]
    if not ways:
        letters = " and ".join(law.letters)
        wanted = f" with P{choice}" if choice else ""
        raise Fault(
            "GS106",
            f"{letters} cannot bring the tool upright to the plane{wanted}",
            at="g53.1",
            hint=f"the tool would point along X{direction[0]:.4f} Y{direction[1]:.4f} Z{direction[2]:.4f} of the work",
        )
    a, b, c = (angle / DEG for angle in tool_point.nearest(ways, here, tilting)[3:])
    goal: Vector = (*axes[:3], a, b, c, *axes[6:])
    control.rapid(control.point_of(subtract(goal, control.length)), "G53.1")


# -- the forms


def _turned(form: int, order: int | None, angles: Point) -> Rows:
    """Axes of the plane by Euler angles (0), roll, pitch and yaw (1), or projected angles (4)."""
    if form == 0:
        return _product(_about(2, angles.x), _about(0, angles.y), _about(2, angles.z))
    if form == 1:
        digits = [int(digit) - 1 for digit in str(order or 123)]
        if sorted(digits) != [0, 1, 2]:
            raise Fault("GS106", f"G68.2 P1 Q{order}: Q is an order of the axes 1, 2, 3", at="q", hint="such as Q123")
        first, second, third = (_about(axis, angles[axis]) for axis in digits)
        return _product(third, second, first)
    # in the plane X turned about Y by I, and Y turned about X by J, then the plane by K about its own normal
    (ci, si), (cj, sj) = cos_sin(angles.x * DEG), cos_sin(angles.y * DEG)
    along, beside = Point(ci, 0.0, -si), Point(0.0, cj, sj)
    normal = _unit(_cross(along, beside), "I and J leave no plane")
    return _product(_columns(along, _cross(normal, along), normal), _about(2, angles.z))


def _gathered(form: int, step: int | None, numbers: tuple[float | None, ...], control: FanucControl) -> Tilt | None:
    """The plane of a form that takes several blocks; None until the last of them is read."""
    last, begun = _LAST[form], control.state.plane_begun
    if step is None or not 0 <= step <= last or (form == 3 and step == 0):
        raise Fault("GS106", f"G68.2 P{form} needs Q, up to {last}", at="g68.2", hint="Q tells what the block gives")
    earlier = begun.given if begun is not None and begun.form == form and step > begun.given[-1][0] else ()
    given = (*earlier, (step, numbers))
    control.state.plane_begun = Begun(form, given)
    if step < last:
        return None
    control.state.plane_begun = None
    known = dict(given)
    if missing := [f"Q{number}" for number in range(1, last + 1) if number not in known]:
        raise Fault("GS105", f"G68.2 P{form} lacks its block with {missing[0]}", at="g68.2", hint="blocks go by Q")
    return _of_points(known) if form == 2 else _of_vectors(known)


def _of_points(known: dict[int, tuple[float | None, ...]]) -> Tilt:
    """Q1 lies at zero, Q2 on X, Q3 on the side of Y; Q0 shifts the zero in the plane, R turns it about the normal."""
    first, second, third = (_point(known[number][:3]) for number in (1, 2, 3))
    along = _unit(_minus(second, first), "the first two points are the same")
    normal = _unit(_cross(along, _minus(third, first)), "the three points lie on one line")
    rows = _columns(along, _cross(normal, along), normal)
    shift = known.get(0, ())
    zero = Tilt(first, rows).point(_point(shift[:3]) if shift else Point(0.0, 0.0, 0.0))
    turn = shift[6] if shift and shift[6] is not None else 0.0
    return Tilt(Point(*zero), _product(rows, _about(2, turn)) if turn else rows)


def _of_vectors(known: dict[int, tuple[float | None, ...]]) -> Tilt:
    """Q1 gives the zero and the direction of X, Q2 that of Z; an X that is not upright to Z is laid into the plane."""
    normal = _unit(_point(known[2][3:6]), "Q2 gives no direction of Z")
    across = _unit(_cross(normal, _point(known[1][3:6])), "X and Z point the same way")
    return Tilt(_point(known[1][:3]), _columns(_cross(across, normal), across, normal))


def _point(values: tuple[float | None, ...]) -> Point:
    return Point(*(value or 0.0 for value in values))


def _minus(a: Point, b: Point) -> Point:
    return Point(a.x - b.x, a.y - b.y, a.z - b.z)


def _cross(a: Point, b: Point) -> Point:
    return Point(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)


def _unit(v: Point, otherwise: str) -> Point:
    size = math.sqrt(v.x * v.x + v.y * v.y + v.z * v.z)
    if size < _SMALL:
        raise Fault("GS106", f"G68.2 gives no plane: {otherwise}", at="g68.2")
    return Point(v.x / size, v.y / size, v.z / size)


def _columns(x: Point, y: Point, z: Point) -> Rows:
    return ((x.x, y.x, z.x), (x.y, y.y, z.y), (x.z, y.z, z.z))


def _about(axis: int, degrees: float) -> Rows:
    """A turn about X, Y or Z."""
    cosine, sine = cos_sin(degrees * DEG)
    if axis == 0:
        return ((1.0, 0.0, 0.0), (0.0, cosine, -sine), (0.0, sine, cosine))
    if axis == 1:
        return ((cosine, 0.0, sine), (0.0, 1.0, 0.0), (-sine, 0.0, cosine))
    return ((cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0))


def _product(first: Rows, *others: Rows) -> Rows:
    for other in others:
        first = tuple(  # type: ignore[assignment]
            tuple(sum(row[k] * other[k][column] for k in range(3)) for column in range(3)) for row in first
        )
    return first
