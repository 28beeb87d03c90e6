"""Cutter compensation: G41, G42, G41.1, G42.1, G40.

The path is offset to one side by the tool's radius. A move can be emitted only
when the next one is known, because an inside corner shortens it: such moves
wait as `Held` values, together with everything that comes after them.

Notation, in the active plane: `op` the programmed corner, `normal` the unit
vector from the programmed path to the offset one at the end of a move.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple, Protocol

from gcodesim import canon
from gcodesim.arithmetic.scalars import atan2
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.rs274.circles import Arc, Line, PlaneCircle, Point, apart, meet, sweep_of
from gcodesim.rs274.control import Control
from gcodesim.rs274.dialects.linuxcnc import COMPENSATION
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector, scaled
from gcodesim.rs274.words import Words
from gcodesim.units import MM

PLANE = {170: (0, 1, 2), 180: (2, 0, 1), 190: (1, 2, 0)}
STRAIGHT_ON = 0.05  # [rad] corners flatter than this are passed without an arc or an intersection
_SWEEP_SLACK_MM = 0.0254
_AT_ONCE = (canon.ToolSelect, canon.ToolNumber, canon.Message, canon.Print, canon.Log)  # not delayed by a held move
# lathe tools: where the controlled point lies from the centre of the nose, by orientation, in radii along X and Z
_NOSE_X = {1: -1.0, 2: -1.0, 6: -1.0, 3: 1.0, 4: 1.0, 8: 1.0}
_NOSE_Z = {2: -1.0, 3: -1.0, 7: -1.0, 1: 1.0, 4: 1.0, 5: 1.0}


@frozen
class Held(canon.Event):
    """A move whose end is not certain yet. `direction` is that of the programmed move, (0, 0) across the plane."""

    kind: str  # rapid, line, arc
    end: Vector
    direction: Point = (0.0, 0.0)
    centre: Point = (0.0, 0.0)
    turns: int = 0
    sweep: float = 0.0  # of the arc as offset, before it is shortened
    feed: float = 0.0
    feed_unit: canon.FeedUnit = "m/s"
    block: int = 0
    word: str = ""


class NextMove(NamedTuple):
    """What a corner needs of the move behind it, which leaves the programmed point `op` with `normal` for `goal`.

    Its offset path `path` begins at `offset_start`; `turns` are those of an arc, 0 of a line.
    """

    op: Point
    normal: Point
    offset_start: Point
    path: Line | PlaneCircle
    goal: Vector
    turns: int = 0
    rapid: bool = False


class CornerRule(Protocol):
    """How a control other than LinuxCNC enters the compensation and goes round corners."""

    def enters(self, control: Control, end: Vector, length: float, *, rapid: bool) -> bool:
        """Whether a first straight move of `length` in the plane begins the compensation; else it has been made."""

    def refuse_arc(self, code: int) -> None:
        """Raise a fault where the first move may not be an arc."""

    def join(self, control: Control, to: NextMove) -> None:
        """Join the held move with the next one; see `_corner`."""


def is_on(control: Control) -> bool:
    """Whether moves are offset; a tool of radius 0 runs on the programmed path itself."""
    return control.state.side != 0 and control.state.comp_radius > 0.0


def switch(words: Words, control: Control) -> None:
    """G40 to G42.1."""
    code = words.g.get(COMPENSATION)
    if code is None:
        return
    if code == 400:
        leave(control)
        return
    state = control.state
    at = f"g{code // 10}" if code % 10 == 0 else f"g{code / 10:g}"
    if state.plane == 190 and control.corner_rule is None:
        raise Fault("GS153", "cutter compensation works in the XY and XZ planes only", at=at, hint="say G17 or G18")
    if state.side:
        raise Fault("GS153", "cutter compensation is on already", at=at, hint="say G40 before changing side or tool")
    radius, orientation = _tool_of(words, control, dynamic=code % 10 == 1, at=at)
    state.side = 1 if code // 10 == 41 else -1
    if radius < 0.0:
        radius, state.side = -radius, -state.side
    state.comp_radius = radius
    state.comp_orientation = orientation
    state.comp_first = True
    state.comp_endpoint = None
    state.comp_emitted = state.current


def _tool_of(words: Words, control: Control, *, dynamic: bool, at: str) -> tuple[float, int]:
    """Radius in program units and lathe orientation."""
    state = control.state
    if dynamic:
        diameter = words.need("d", "GS153", at.upper(), "D is the diameter of the tool")
        orientation = words.whole("l", at.upper()) or 0
        if "l" in words.values and state.plane != 180:
            raise Fault("GS153", f"L of {at.upper()} is the orientation of a lathe tool: G18 only", at="l")
        if not 0 <= orientation <= 9:
            raise Fault("GS106", f"the orientation L{orientation} must be between 0 and 9", at="l")
        return diameter / 2.0, orientation
    number = words.whole("d", at.upper())
    if number is not None and number < 0:
        raise Fault("GS106", f"D is negative: {number}", at="d", value=number)
    entry = control.tool_entry(number, "d") if number else control.spindle_tool
    if state.plane != 180 and entry.orientation not in (0, 9):
        raise Fault("GS153", f"T{entry.number} is a lathe tool, which can be compensated in G18 only", at=at)
    return entry.diameter / 2.0 / state.unit, entry.orientation


def leave(control: Control) -> None:
    """G40 and the end of the program: waiting moves are emitted as they are."""
    state = control.state
    if not state.side:
        return
    settle(control)
    before, control.out[:] = list(control.out), []
    flush(control)
    control.out[:0] = before
    if not state.comp_first:
        state.current = state.comp_programmed
        state.comp_leaving = state.comp_radius > 0.0
    state.side, state.comp_first = 0, True


def pause(control: Control) -> None:
    """Before a stop: waiting moves are emitted as they are, and the compensation goes on afterwards."""
    if control.state.side:
        settle(control)
        before, control.out[:] = list(control.out), []  # the current block may have moved as well
        flush(control)
        control.out[:0] = before


def settle(control: Control) -> None:
    """After a block: whatever follows a held move waits with it."""
    state, out = control.state, control.out
    if state.held:
        at_once = [event for event in out if type(event) in _AT_ONCE]
        state.held = (*state.held, *(event for event in out if type(event) not in _AT_ONCE))
        out[:] = at_once
        return
    for index, event in enumerate(out):
        if type(event) is Held:
            state.held = tuple(out[index:])
            del out[index:]
            return


# -- moves


def straight(words: Words, control: Control, end: Vector, *, rapid: bool) -> None:
    """G0 or G1 with compensation."""
    from gcodesim.rs274.feeds import resolve_inverse_time, straight_length

    state = control.state
    first, second, _ = PLANE[state.plane]
    start = state.current if state.comp_first else state.comp_programmed
    if not rapid:
        resolve_inverse_time(words, control, straight_length(start, end))
    feed, unit = (0.0, "m/s") if rapid else control.feed(_moves_linear(start, end))
    op, goal = (start[first], start[second]), (end[first], end[second])
    length = apart(op, goal)
    move = Held(
        span=control.span,
        kind="rapid" if rapid else "line",
        end=end,
        feed=feed,
        feed_unit=unit,  # type: ignore[arg-type]
        block=control.block_number,
        word="G0" if rapid else "G1",
    )
    radius = state.comp_radius
    rule = control.corner_rule
    if state.comp_first:
        if rule is not None:
            if not rule.enters(control, end, length, rapid=rapid):
                return
        elif length <= radius:
            _too_short(length, radius, control)
    elif length == 0.0:
        at = state.current
        move = replace(move, end=with_plane(end, control, (at[first], at[second])))
        control.out.append(move)
        state.current, state.comp_programmed = move.end, end
        return
    direction = ((goal[0] - op[0]) / length, (goal[1] - op[1]) / length) if length else (0.0, 0.0)
    normal = left(direction) if state.side > 0 else right(direction)
    offset_start = beside(op, normal, radius)
    if not state.comp_first:
        join = _corner if rule is None else rule.join
        join(control, NextMove(op, normal, offset_start, Line(offset_start, direction), end, rapid=rapid))
    offset_end = with_plane(end, control, beside(goal, normal, radius))
    control.out.append(replace(move, end=offset_end, direction=direction))
    state.current, state.comp_programmed, state.comp_normal = offset_end, end, normal
    state.comp_first = False


def arc(words: Words, control: Control, end: Vector, code: int) -> None:
    """G2 or G3 with compensation."""
    from gcodesim.rs274.arcs import arc_of, helix_length
    from gcodesim.rs274.feeds import resolve_inverse_time

    state = control.state
    first, second, _ = PLANE[state.plane]
    start = state.current if state.comp_first else state.comp_programmed
    shape = arc_of(words, control, start, end, code)
    if state.feed_mode == 930:
        resolve_inverse_time(words, control, helix_length(control, start, end, shape))
    feed, unit = control.feed(linear=True)
    radius = state.comp_radius
    op, goal = (start[first], start[second]), (end[first], end[second])
    arc_radius = apart(goal, shape.centre)
    # the offset path lies inside a left-hand arc when compensating to the left
    inside = (shape.turns > 0) == (state.side > 0)
    if inside and arc_radius <= radius:
        unit_mm = state.unit / MM
        raise Fault(
            "GS152",
            f"the tool, radius {radius * unit_mm:.3f} mm, does not fit into the arc of {arc_radius * unit_mm:.3f} mm",
            hint="use a smaller tool or a larger arc",
            value=radius * unit_mm,
            limit=arc_radius * unit_mm,
            unit="mm",
        )
    sign = -1.0 if inside else 1.0
    out_normal = _towards(shape.centre, goal, sign)
    offset_end = beside(goal, out_normal, radius)
    centre = shape.centre
    rule = control.corner_rule
    if state.comp_first:
        if rule is not None:
            rule.refuse_arc(code)
        if apart(op, goal) <= radius:
            _too_short(apart(op, goal), radius, control)
        if radius:
            centre = _entry_centre(op, offset_end, out_normal)
        offset_start = op
    else:
        in_normal = _towards(shape.centre, op, sign)
        offset_start = beside(op, in_normal, radius)
        circle = PlaneCircle(shape.centre, arc_radius + sign * radius)
        join = _corner if rule is None else rule.join
        join(control, NextMove(op, in_normal, offset_start, circle, end, turns=shape.turns))
    control.out.append(
        Held(
            span=control.span,
            kind="arc",
            end=with_plane(end, control, offset_end),
            centre=centre,
            turns=shape.turns,
            sweep=sweep_of(offset_start, offset_end, Arc(centre, shape.turns)),
            feed=feed,
            feed_unit=unit,
            block=control.block_number,
            word=f"G{code // 10}",
        )
    )
    state.current, state.comp_programmed = with_plane(end, control, offset_end), end
    state.comp_normal = out_normal
    state.comp_first = False


def _entry_centre(start: Point, end: Point, normal: Point) -> Point:
    """Centre on the radial line through `end` that is as far from `start` as from `end`."""
    chord = (start[0] - end[0], start[1] - end[1])
    along = 2.0 * (chord[0] * normal[0] + chord[1] * normal[1])
    if along == 0.0:
        raise Fault("GS151", "an entry by this arc has no centre")
    distance = (chord[0] * chord[0] + chord[1] * chord[1]) / along
    return end[0] + normal[0] * distance, end[1] + normal[1] * distance


def _too_short(length: float, radius: float, control: Control) -> None:
    factor = control.state.unit / MM
    raise Fault(
        "GS151",
        f"the entry move is {length * factor:.3f} mm long; "
        f"it must be longer than the tool's radius, {radius * factor:.3f} mm",
        hint="begin further away, or use a smaller tool",
        value=length * factor,
        limit=radius * factor,
        unit="mm",
    )


# -- corners


def _corner(control: Control, to: NextMove) -> None:
    """Join the held move with the next one.

    As on the control, rotary axes reach their goal on the way round an outside corner.
    """
    state = control.state
    turn = turn_outward(state.comp_normal, to.normal, state.side)
    if -STRAIGHT_ON <= turn <= STRAIGHT_ON:
        flush(control, lenient=True)
    elif STRAIGHT_ON < turn <= _outside_limit(control, to.turns):
        held_end = state.current
        flush(control, lenient=to.turns != 0)
        end = (*with_plane(held_end, control, to.offset_start)[:3], *to.goal[3:])
        if to.rapid:
            emit(control, Held(span=control.span, kind="rapid", end=end, block=control.block_number, word="G0"))
        else:
            feed, unit = control.feed(linear=True)
            around = Held(
                span=control.span,
                kind="arc",
                end=end,
                centre=to.op,
                turns=-1 if state.side > 0 else 1,
                feed=feed,
                feed_unit=unit,
                block=control.block_number,
                word="G2" if state.side > 0 else "G3",
            )
            emit(control, around)
        state.comp_endpoint = to.offset_start
    elif not any(type(event) is Held for event in state.held):
        flush(control)  # after a stop nothing waits, and an inside corner stays as it is
    else:
        flush(control, corner=intersection(control, to))


def _outside_limit(control: Control, following_turns: int) -> float:
    """Up to which turn a corner counts as outside.

    A reversal does, unless an arc takes part that the tool runs round on its
    outside: there the two offset paths cross. The next move decides if it is an
    arc, else the held one.
    """
    side = control.state.side
    waiting = held_moves(control)
    turns = following_turns or (waiting[0].turns if waiting else 0)
    around = turns != 0 and (turns > 0) != (side > 0)
    return math.pi - STRAIGHT_ON if around else math.pi + STRAIGHT_ON


def is_in_plane(move: Held) -> bool:
    """Whether it moves in the plane at all."""
    return move.kind == "arc" or move.direction != (0.0, 0.0)


def held_moves(control: Control) -> list[Held]:
    return [event for event in control.state.held if type(event) is Held and is_in_plane(event)]


def _held_move(control: Control) -> Held:
    """The move in the plane that waits; those across the plane follow it.

    After a stop only moves across the plane may wait; then it is a move that ended here in the direction before it.
    """
    waiting = held_moves(control)
    if waiting:
        return waiting[0]
    state = control.state
    x, y = state.comp_normal
    return Held(span=control.span, kind="line", end=state.current, direction=(y, -x) if state.side > 0 else (-y, x))


def turn_outward(before: Point, after: Point, side: int) -> float:
    """Angle [rad] from the old normal to the new one, positive where the corner is outside; -pi/2 to 3 pi/2."""
    angle = atan2(before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1])
    turn = -angle if side > 0 else angle
    return turn + 2.0 * math.pi if turn < -math.pi / 2.0 else turn


def intersection(control: Control, to: NextMove) -> Point:
    """Where the held offset path meets the next one.

    As on the control, the centre of an arc that meets a line is taken to be as far from the corner as from the arc's
    other end, though it may be a little off; and of two points the one counts that the side of the tool calls for.
    """
    op, following, turns = to.op, to.path, to.turns
    state = control.state
    move = _held_move(control)
    held = held_path(control, move)
    inside_held, inside_next = (move.turns > 0) == (state.side > 0), (turns > 0) == (state.side > 0)
    shift = (0.0, 0.0)
    if isinstance(following, PlaneCircle) and isinstance(held, Line):
        radius = following.radius + (state.comp_radius if inside_next else -state.comp_radius)
        shift = _off_by(following.centre, op, radius)
        following = replace(following, centre=_minus(following.centre, shift))
    elif isinstance(following, Line) and isinstance(held, PlaneCircle):
        radius = held.radius + (state.comp_radius if inside_held else -state.comp_radius)
        off = _off_by(held.centre, op, radius)
        following = replace(following, point=(following.point[0] + off[0], following.point[1] + off[1]))
    found = [(x + shift[0], y + shift[1]) for x, y in meet(held, following)]
    if not found:
        raise Fault(
            "GS152", "the tool does not fit into this inside corner", hint="use a smaller tool or a larger corner"
        )
    if len(found) == 1:
        return found[0]
    first_point, second_point = found  # of two circles: as seen from the held one's centre to the other
    if isinstance(held, Line):
        return max(found, key=lambda point: _dot(point, held.direction) * (1.0 if inside_next else -1.0))
    if isinstance(following, Line):
        return max(found, key=lambda point: _dot(point, following.direction) * (-1.0 if inside_held else 1.0))
    return first_point if inside_held == (turns > 0) else second_point


def held_path(control: Control, move: Held) -> Line | PlaneCircle:
    """The offset path on which a held move runs."""
    first, second, _ = PLANE[control.state.plane]
    end = (move.end[first], move.end[second])
    return PlaneCircle(move.centre, apart(move.centre, end)) if move.kind == "arc" else Line(end, move.direction)


def _off_by(centre: Point, op: Point, radius: float) -> Point:
    """How far `centre` is beyond the point that lies `radius` from `op` towards it."""
    part = 1.0 - radius / apart(op, centre)
    return (centre[0] - op[0]) * part, (centre[1] - op[1]) * part


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1]


def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1]


def scale(control: Control, factor: float) -> None:
    """After a change of unit, waiting moves keep their meaning."""
    state = control.state
    state.held = tuple(_scaled(event, factor) if type(event) is Held else event for event in state.held)
    state.comp_emitted = scaled(state.comp_emitted, factor)
    if state.comp_endpoint is not None:
        state.comp_endpoint = (state.comp_endpoint[0] * factor, state.comp_endpoint[1] * factor)


def _scaled(move: Held, factor: float) -> Held:
    centre = (move.centre[0] * factor, move.centre[1] * factor)
    return replace(move, end=scaled(move.end, factor), centre=centre)


# -- emission


def flush(control: Control, corner: Point | None = None, *, lenient: bool = False) -> None:
    """Emit waiting moves, before the events of the current block; `corner` is where the held move must end.

    A held move that would run backwards is a fault; a control does not check this if the next one goes straight on or
    is an arc round an outside corner: then (`lenient`) it is a warning.
    """
    state = control.state
    held, state.held = state.held, ()
    later = [event for event in control.out if type(event) not in _AT_ONCE]
    control.out[:] = [event for event in control.out if type(event) in _AT_ONCE]
    for event in held:
        if type(event) is not Held:
            control.out.append(event)
            continue
        if corner is None and not is_in_plane(event):
            emit(control, event)
        else:
            first, second, _ = PLANE[state.plane]
            try:
                move = _shortened(control, event, corner or (event.end[first], event.end[second]))
            except Fault as fault:
                if not lenient:
                    raise
                control.warn(fault.code, fault.message + "; the control does not see it", fault.hint)
                move = event
            emit(control, move)
    control.out.extend(later)


def _shortened(control: Control, move: Held, corner: Point) -> Held:
    """`move` with its end at `corner`; a fault when it would have to run backwards."""
    state = control.state
    before = state.comp_endpoint
    if before is None:
        pass
    elif move.kind == "arc":
        sweep = sweep_of(before, corner, Arc(move.centre, move.turns))
        if abs(sweep) > abs(move.sweep) + _SWEEP_SLACK_MM * MM / state.unit:
            raise Fault(
                "GS152",
                "the arc is too short for the inside corner that follows: the tool would cut into the part",
                hint=f"the arc is in line {move.span.line}; use a smaller tool",
            )
    elif move.direction[0] * (corner[0] - before[0]) + move.direction[1] * (corner[1] - before[1]) < 0.0:
        raise Fault(
            "GS152",
            "the inside corner is closer than the tool's radius: the tool would cut into the part",
            hint=f"the move before is in line {move.span.line}; use a smaller tool",
        )
    return replace(move, end=with_plane(move.end, control, corner))


def emit(control: Control, move: Held) -> None:
    """The event of a held move, from where the tool really stands."""
    state = control.state
    start, end = state.comp_emitted, move.end
    span: Span = move.span
    at = control.si_axes(control.tip(_nose(end, control)))
    if move.kind == "rapid":
        control.out.append(canon.Rapid(span=span, end=at, block=move.block, word=move.word))
    elif move.kind == "line":
        control.out.append(
            canon.LinearFeed(
                span=span, end=at, block=move.block, word=move.word, feed=move.feed, feed_unit=move.feed_unit
            )
        )
    else:
        control.out.append(_arc_event(control, move, start, end, at))
    first, second, _ = PLANE[state.plane]
    state.comp_emitted = end
    state.comp_endpoint = (end[first], end[second])


def _arc_event(control: Control, move: Held, start: Vector, end: Vector, at: canon.Axes) -> canon.ArcFeed:
    state = control.state
    first, second, normal = PLANE[state.plane]
    middle = list(end)
    middle[first], middle[second] = move.centre
    sweep = sweep_of((start[first], start[second]), (end[first], end[second]), Arc(move.centre, move.turns))
    return canon.ArcFeed(
        span=move.span,
        end=at,
        block=move.block,
        word=move.word,
        center=control.si_point(_nose(tuple(middle), control)),  # type: ignore[arg-type]
        normal=control.normal(normal),
        ccw=move.turns > 0,
        turns=abs(move.turns),
        sweep=sweep,
        feed=move.feed,
        feed_unit=move.feed_unit,
    )


def _nose(point: Vector, control: Control) -> Vector:
    """From the centre of a lathe tool's nose to its controlled point."""
    state = control.state
    if state.plane != 180 or not state.comp_orientation:
        return point
    radius, way = state.comp_radius, state.comp_orientation
    return (
        point[0] + _NOSE_X.get(way, 0.0) * radius,
        point[1],
        point[2] + _NOSE_Z.get(way, 0.0) * radius,
        *point[3:],
    )


# -- small geometry


def _moves_linear(start: Vector, end: Vector) -> bool:
    return start[:3] != end[:3] or start[3:6] == end[3:6]


def left(direction: Point) -> Point:
    return -direction[1], direction[0]


def right(direction: Point) -> Point:
    return direction[1], -direction[0]


def beside(point: Point, normal: Point, radius: float) -> Point:
    return point[0] + radius * normal[0], point[1] + radius * normal[1]


def _towards(centre: Point, point: Point, sign: float) -> Point:
    """Unit vector from the centre through `point`, times `sign`."""
    length = apart(centre, point)
    return sign * (point[0] - centre[0]) / length, sign * (point[1] - centre[1]) / length


def with_plane(vector: Vector, control: Control, point: Point) -> Vector:
    first, second, _ = PLANE[control.state.plane]
    out = list(vector)
    out[first], out[second] = point
    return tuple(out)  # type: ignore[return-value]
