"""G2 and G3: by centre or by radius, in three planes, as helices, with full turns."""

from __future__ import annotations

import math

from gcodesim import canon
from gcodesim.rs274 import compensation
from gcodesim.rs274.circles import Arc, apart, sweep_of
from gcodesim.rs274.control import Control
from gcodesim.rs274.ends import end_point
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.feeds import check_feed, resolve_inverse_time
from gcodesim.rs274.state import Vector
from gcodesim.rs274.words import Words
from gcodesim.units import INCH, MM

# plane -> first, second and normal axis; in G18 the first is Z
PLANE_AXES = {170: (0, 1, 2), 180: (2, 0, 1), 190: (1, 2, 0)}
_PLANE_NAMES = {170: "XY", 180: "XZ", 190: "YZ"}
_AXIS_NAMES = "XYZ"
_CENTRE_LETTERS = "ijk"
_MOST_TURNS = 10_000  # of one arc; more could not be planned in a moment

# LinuxCNC's: a mismatch of the radii below `_ALWAYS` passes, above `_NEVER` not, between up to 0.1 % of the radius
_RELATIVE_MISS = 1e-3
_ALWAYS_MM, _ALWAYS_INCH = 0.02 * math.sqrt(2.0), 0.002 * math.sqrt(2.0)
_NEVER_FACTOR = 100.0
_SMALLEST_RADIUS = 1.27e-6  # [m]; the same in both units


def arc(words: Words, control: Control, code: int) -> None:
    """G2 and G3."""
    who = f"G{code // 10}"
    check_feed(words, control, who)
    if control.state.comp_leaving:
        raise Fault(
            "GS151", "the move after G40 must be straight, not an arc", at=who.lower(), hint="lead out with G0 or G1"
        )
    end = end_point(words, control)
    if compensation.is_on(control):
        compensation.arc(words, control, end, code)
        return
    shape = arc_of(words, control, control.state.current, end, code)
    if control.state.feed_mode == 930:
        resolve_inverse_time(words, control, helix_length(control, control.state.current, end, shape))
    if control.dialect.dots_are_lines and _is_dot(control, shape):
        message = f"{who} has no radius: {control.dialect.name} goes straight to its end"
        control.warn("GS112", message, "write G1, or correct the centre")
        control.line(end, who)
    else:
        emit_arc(control, end, shape, who)


def _is_dot(control: Control, shape: Arc) -> bool:
    """Whether the centre lies on the start point."""
    first, second, _ = PLANE_AXES[control.state.plane]
    start = control.state.current
    return math.dist((start[first], start[second]), shape.centre) * control.state.unit < _SMALLEST_RADIUS


def arc_of(words: Words, control: Control, start: Vector, end: Vector, code: int) -> Arc:
    """Centre and turns of the arc that the words describe, from `start` to `end`."""
    who = f"G{code // 10}"
    plane = control.state.plane
    first, second, normal = PLANE_AXES[plane]
    centre_words = [letter for letter in _CENTRE_LETTERS if letter in words.values]
    turns = 1
    if "p" in words.values:
        whole = words.whole("p", who)
        assert whole is not None
        if whole < 1:
            raise Fault("GS106", f"{who} P{whole}: P counts turns, 1 or more", at="p", value=whole, limit=1)
        if whole > _MOST_TURNS:
            message = f"{who} P{whole} would be {whole} turns; an arc may have {_MOST_TURNS}"
            raise Fault("GS106", message, at="p", value=whole, limit=_MOST_TURNS)
        turns = whole
    signed_turns = turns if code == 30 else -turns
    a, b = _AXIS_NAMES[first], _AXIS_NAMES[second]
    named = [name.lower() in words.values for name in (a, b)]
    if "r" in words.values:
        if centre_words:
            raise Fault("GS110", f"{who} has both a radius R and a centre", at="r", hint="drop R, or I J K")
        if not any(named) and not words.has_polar():
            raise Fault(
                "GS110", f"{who} with R needs {a} or {b}", at="r", hint="an arc by radius needs another end point"
            )
        centre = _centre_by_radius(
            words.values["r"], (start[first], start[second]), (end[first], end[second]), signed_turns, control
        )
        return Arc(centre, signed_turns)
    if control.dialect.arcs_name_axes and not any(named):
        raise Fault(
            "GS110",
            f"{control.dialect.name} wants {a} or {b} in every arc, also in a full circle",
            at=who.lower() if who.lower() in words.names else None,
            hint="write the end point, even where it is the start point",
        )
    outside = _CENTRE_LETTERS[normal]
    if outside in words.values and not control.dialect.passes_over_far_centres:
        raise Fault(
            "GS110",
            f"{outside.upper()} lies outside the {_PLANE_NAMES[plane]} plane of this arc",
            at=outside,
            hint=f"use {_CENTRE_LETTERS[first].upper()} and {_CENTRE_LETTERS[second].upper()}, or change the plane",
        )
    if not centre_words:
        raise Fault(
            "GS110",
            f"{who} has neither a centre nor a radius",
            at=who.lower() if who.lower() in words.names else None,
            hint="add I J K or R",
            lacks="ijkr",
        )
    letters = (_CENTRE_LETTERS[first], _CENTRE_LETTERS[second])
    if control.state.centre_absolute:
        for letter in letters:
            if letter not in words.values:
                raise Fault(
                    "GS110",
                    f"{who} under G90.1 needs {letter.upper()}",
                    at=who.lower() if who.lower() in words.names else None,
                )
        centre = (words.values[letters[0]], words.values[letters[1]])
    else:
        centre = (start[first] + words.values.get(letters[0], 0.0), start[second] + words.values.get(letters[1], 0.0))
    _check_radii(words, control, (start[first], start[second]), (end[first], end[second]), centre, who)
    return Arc(centre, signed_turns)


def allowed_miss(control: Control) -> tuple[float, float]:
    """By how much the radii at both ends of an arc may differ [m]: so much always, and more than that never."""
    if control.dialect.arc_miss is None:
        always = _ALWAYS_INCH * INCH if control.state.unit == INCH else _ALWAYS_MM * MM
        return always, always * _NEVER_FACTOR
    always, most = control.dialect.arc_miss
    return MM * always, MM * most


def _check_radii(
    words: Words,
    control: Control,
    start: tuple[float, float],
    end: tuple[float, float],
    centre: tuple[float, float],
    who: str,
) -> None:
    unit = control.state.unit
    at_start, at_end = math.dist(start, centre) * unit, math.dist(end, centre) * unit
    at = next((letter for letter in "ijk" if letter in words.values), None)
    always, most = allowed_miss(control)
    radius = max(at_start, at_end) if control.dialect.arc_miss is None else at_start
    dot = control.dialect.dots_are_lines and at_start < _SMALLEST_RADIUS and at_end <= always
    if not dot and min(at_start, at_end) < _SMALLEST_RADIUS:
        which = "start" if at_start < _SMALLEST_RADIUS else "end"
        raise Fault("GS112", f"{who} has no radius: the centre lies on the {which} point", at=at)
    miss = abs(at_start - at_end)
    allowed = min(max(always, _RELATIVE_MISS * radius), most)
    if miss > allowed:
        raise Fault(
            "GS111",
            f"the arc ends off its own circle: radius {at_start / MM:.3f} mm at the start, "
            f"{at_end / MM:.3f} mm at the end, {miss / MM:.3f} mm apart; {allowed / MM:.3f} mm is allowed",
            hint=_radii_hint(control, start, end, centre),
            value=miss / MM,
            limit=allowed / MM,
            unit="mm",
        )


def _radii_hint(
    control: Control, start: tuple[float, float], end: tuple[float, float], centre: tuple[float, float]
) -> str:
    letters = "/".join(_CENTRE_LETTERS[axis].upper() for axis in PLANE_AXES[control.state.plane][:2])
    if not control.state.centre_absolute:
        offset = (centre[0] - start[0], centre[1] - start[1])
        if abs(math.dist(start, offset) - math.dist(end, offset)) < 1e-3 * max(math.dist(start, offset), 1e-9):
            return f"{letters} would fit as absolute centre: G90.1"
    return f"check {letters} and the end point; without G90.1 the centre counts from the start of the arc"


def _centre_by_radius(
    radius: float, start: tuple[float, float], end: tuple[float, float], turns: int, control: Control
) -> tuple[float, float]:
    unit = control.state.unit
    chord = apart(start, end)
    if chord == 0.0:
        raise Fault(
            "GS110",
            "an arc by radius must end at another point than it starts",
            at="r",
            hint="give a full circle by its centre",
        )
    size, half = abs(radius), chord / 2.0
    if (half - size) * unit > _SMALLEST_RADIUS:
        raise Fault(
            "GS112",
            f"the radius {size * unit / MM:.3f} mm is too small to reach the end point {chord * unit / MM:.3f} mm away",
            at="r",
            hint=f"R must be at least {half * unit / MM:.3f} mm",
            value=size * unit / MM,
            limit=half * unit / MM,
            unit="mm",
        )
    if half / size > 1.0 - 1e-12:
        return (start[0] + end[0]) / 2.0, (start[1] + end[1]) / 2.0
    height = math.sqrt(max(size * size - half * half, 0.0))
    # the centre lies to the left of the chord for a short counterclockwise arc
    left = (turns > 0) == (radius > 0)
    dx, dy = (end[0] - start[0]) / chord, (end[1] - start[1]) / chord
    sign = height if left else -height
    return (start[0] + end[0]) / 2.0 - dy * sign, (start[1] + end[1]) / 2.0 + dx * sign


def helix_length(control: Control, start: Vector, end: Vector, shape: Arc) -> float:
    """Length of the arc with its rise along the normal, in program units."""
    first, second, normal = PLANE_AXES[control.state.plane]
    a, b = (start[first], start[second]), (end[first], end[second])
    flat = abs(sweep_of(a, b, shape)) * apart(a, shape.centre)
    lift = end[normal] - start[normal]
    return math.sqrt(flat * flat + lift * lift)


def emit_arc(control: Control, end: Vector, shape: Arc, word: str) -> None:
    """The event of an arc from the current point to `end`."""
    state = control.state
    first, second, normal = PLANE_AXES[state.plane]
    start = state.current
    middle = [0.0] * 9
    middle[first], middle[second], middle[normal] = shape.centre[0], shape.centre[1], end[normal]
    feed, unit = control.feed(linear=True)
    control.out.append(
        canon.ArcFeed(
            span=control.span,
            end=control.si_axes(control.tip(end)),
            block=control.block_number,
            word=word,
            center=control.si_point(tuple(middle)),  # type: ignore[arg-type]
            normal=control.normal(normal),
            ccw=shape.turns > 0,
            turns=abs(shape.turns),
            sweep=sweep_of((start[first], start[second]), (end[first], end[second]), shape),
            feed=feed,
            feed_unit=unit,
        )
    )
    state.current = end
