"""Cutter compensation as Fanuc has it (cutter compensation C): corners by intersection, start-up and cancel A or B.

At a corner `op` the programmed path turns by `turn`, positive where the tool goes
round outside. With unit normals n towards the tool, directions d and radius r:

| corner | where the tool goes |
| --- | --- |
| inside | to where both offset paths meet |
| outside, up to 90 deg | along the tangents to where they meet: op + r (n1 + n2) / (1 + n1 n2) |
| outside, beyond | over op + r (n1 + d1) and op + r (n2 - d2): each tangent is extended by the radius |

The move that starts the compensation ends, by type A and at inside corners,
at right angles to the beginning of the next one (op + r n2); by type B it goes
round outside corners like any other. The same holds for the end: by type A the
last move ends at op + r n1, by type B it goes round the corner with the move that leaves.

The other side without a G40 between (G42 in G41): the move before ends where both
offset paths cross, and where they do not, at op + r n2; an arc ends beside its own
end, and a straight move goes over. The same side said once more makes the move before end at op + r n1.

A corner needs the move behind it among the blocks that the control reads ahead
(cell key `compensation_blocks`, parameter 19625). Of N blocks N - 2 may have no
move in the plane; behind more of them the move before has ended at op + r n1, and
the next one goes from there straight to its own end.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from gcodesim.rs274.circles import Arc, Line, PlaneCircle, Point, apart, meet, sweep_of
from gcodesim.rs274.compensation import (
    PLANE,
    STRAIGHT_ON,
    Held,
    NextMove,
    beside,
    emit,
    flush,
    held_moves,
    held_path,
    intersection,
    is_in_plane,
    is_on,
    left,
    pause,
    right,
    settle,
    turn_outward,
    with_plane,
)
from gcodesim.rs274.compensation import leave as leave_as_it_is
from gcodesim.rs274.fanuc import corner_circle, interference
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.fanuc.control import FanucControl

_TANGENT: Final = 1e-6  # [rad] flatter corners are none
_MEETS_WITHIN: Final = 2.0  # radii times the angle of a flat inside corner: its tangents meet after half of that
_REVERSED: Final = 1e-3  # [rad] from a full reversal, on either side: counts as outside
_SIDES: Final = {410: 1, 420: -1}


class FanucCorners:
    """`compensation.CornerRule` of this dialect."""

    def __init__(self, control: FanucControl) -> None:
        self._fanuc = control

    def enters(self, control: Control, end: Vector, length: float, *, rapid: bool) -> bool:
        """A move across the plane starts nothing; one in it does, however short."""
        state = self._fanuc.state
        if length == 0.0:
            if rapid:
                control.rapid(end)
            else:
                control.line(end)
            state.comp_emitted = state.current
            return False
        state.comp_starting = True
        return True

    def refuse_arc(self, code: int) -> None:
        name = f"G{code // 10}"
        hint = "lead in with G0 or G1"
        raise Fault("GS151", "an arc cannot start the compensation", at=name.lower(), hint=hint)

    def join(self, control: Control, to: NextMove) -> None:
        """Join the held move with the next one."""
        fanuc = self._fanuc
        state = fanuc.state
        before = state.comp_endpoint
        turn = turn_of(state.comp_normal, to.normal, state.side)
        starting, state.comp_starting = state.comp_starting, False
        crossing, state.comp_crossing = state.comp_crossing, False
        reached: Point | None = None
        if state.comp_circle is not None:
            corner_circle.finish(fanuc, to, turn)
        elif not held_moves(control):
            self._without_corner(control, turn)
        elif crossing:
            _cross(control, to)
        elif starting and (turn <= _TANGENT or not fanuc.goes_round):
            flush(control, corner=to.offset_start)
        elif abs(turn) <= _TANGENT:
            flush(control, lenient=True)
        elif turn > 0.0:
            ends_at = to.offset_start if isinstance(to.path, PlaneCircle) else None
            reached = go_round(control, to.op, to.normal, turn, ends_at=ends_at, rapid=to.rapid)
        else:
            flush(control, corner=_inside(control, to, turn))
        interference.check(fanuc, to.op, before, reached or state.comp_endpoint)

    def _without_corner(self, control: Control, turn: float) -> None:
        """The move before has ended already: the next one goes from there straight to its own end."""
        state, why = self._fanuc.state, self._fanuc.state.comp_lost
        flush(control)
        state.comp_lost = ""
        if why and abs(turn) > _TANGENT:
            message = f"the corner before this block is not worked out: {why}"
            hint = "the tool has gone to the end of the move before, and goes straight on from there"
            control.warn("GS156", message, hint)


def change_side(control: FanucControl, code: int, radius: float) -> bool:
    """G41 or G42 in the compensation, with a radius of either sign; false where it begins only now."""
    state = control.state
    if not state.side or state.comp_first:
        state.side = 0
        return False
    at = f"g{code // 10}"
    if abs(radius) != state.comp_radius:
        hint = "say G40 before, and then the new offset"
        raise Fault("GS153", "the offset cannot change while cutter compensation is on", at=at, hint=hint)
    side = _SIDES[code] if radius >= 0.0 else -_SIDES[code]
    if side == state.side:
        if held_moves(control):
            pause(control)
            state.comp_lost = f"{at.upper()} is said once more"
    elif state.comp_starting:
        hint = "put a move on the first side between them"
        raise Fault("GS153", "the side cannot change right behind the block that starts", at=at, hint=hint)
    else:
        state.side, state.comp_crossing = side, True
    return True


def look_ahead(control: FanucControl) -> None:
    """After a block: without a move in the plane for too long the held move ends at right angles to itself."""
    state = control.state
    if not state.side or state.comp_first or state.corner is not None:
        return
    if any(type(event) is Held and is_in_plane(event) for event in control.out):
        state.comp_idle = 0
        return
    state.comp_idle += 1
    if state.comp_idle > control.blocks_ahead - 2 and held_moves(control):
        state.comp_lost = (
            f"{state.comp_idle} blocks without a move in the plane stand before it,"
            f" and the control reads {control.blocks_ahead} blocks"
        )
        pause(control)


def _cross(control: Control, to: NextMove) -> None:
    """The tool goes over to the other side of the contour."""
    state = control.state
    point = _crossing(control, to)
    waiting = held_moves(control)[0]
    if point is not None or waiting.kind != "arc":
        flush(control, corner=point or to.offset_start)
        return
    held_end = state.current
    flush(control)
    emit(control, _straight_to(control, held_end, to.offset_start, rapid=to.rapid))


def _crossing(control: Control, to: NextMove) -> Point | None:
    """Where the offset path of the held move meets that of the next one: nearest to the corner, and not backwards."""
    state = control.state
    first, second, _ = PLANE[state.plane]
    move, before = held_moves(control)[0], state.comp_endpoint
    end = beside((to.goal[first], to.goal[second]), to.normal, state.comp_radius)
    near = []
    for point in meet(held_path(control, move), to.path):
        if before is None:
            continue
        if move.kind == "arc":
            fits = abs(sweep_of(before, point, Arc(move.centre, move.turns))) <= abs(move.sweep)
        else:
            fits = _along(before, point, move.direction) > 0.0
        if isinstance(to.path, Line):
            fits = fits and _along(point, end, to.path.direction) > 0.0
        if fits:
            near.append(point)
    return min(near, key=lambda point: apart(point, to.op), default=None)


def _along(start: Point, end: Point, direction: Point) -> float:
    return (end[0] - start[0]) * direction[0] + (end[1] - start[1]) * direction[1]


def turn_of(before: Point, after: Point, side: int) -> float:
    """Angle [rad] from the old normal to the new one, positive where the corner is outside; -pi to pi."""
    turn = turn_outward(before, after, side)
    return turn - 2.0 * math.pi if turn > math.pi + _REVERSED else turn


def _inside(control: Control, to: NextMove, turn: float) -> Point | None:
    """Where the offset paths of an inside corner meet."""
    state = control.state
    waiting = held_moves(control)
    if isinstance(to.path, Line) and (not waiting or waiting[0].kind != "arc"):
        return _where_tangents_meet(to.op, state.comp_normal, to.normal, state.comp_radius)
    try:
        point = intersection(control, to)
    except Fault:
        if turn < -STRAIGHT_ON:
            raise
        return None  # arcs that all but touch need not meet after rounding, or meet far from where they touch
    flat = turn >= -STRAIGHT_ON
    far = flat and apart(point, to.offset_start) > _MEETS_WITHIN * state.comp_radius * -turn
    return None if far else point


def _where_tangents_meet(op: Point, before: Point, after: Point, radius: float) -> Point:
    size = radius / (1.0 + before[0] * after[0] + before[1] * after[1])
    return op[0] + size * (before[0] + after[0]), op[1] + size * (before[1] + after[1])


def go_round(
    control: Control, op: Point, normal: Point, turn: float, *, ends_at: Point | None, rapid: bool
) -> Point | None:
    """Let the held move end where the outside corner begins, and go round it by straight moves; where it ended.

    They have the feed of the block behind the corner. `ends_at` is where an arc begins that follows.
    """
    state = control.state
    side, radius, before = state.side, state.comp_radius, state.comp_normal
    if turn <= 0.5 * math.pi:
        points = [_where_tangents_meet(op, before, normal, radius)]
    else:
        ahead = right(before) if side > 0 else left(before)
        back = left(normal) if side > 0 else right(normal)
        points = [
            beside(beside(op, before, radius), ahead, radius),
            beside(beside(op, normal, radius), back, radius),
        ]
    held_end = state.current
    waiting = held_moves(control)
    if waiting and waiting[0].kind != "arc":
        flush(control, corner=points.pop(0))
    else:
        flush(control, lenient=ends_at is not None)
    reached = state.comp_endpoint
    for point in [*points, *([] if ends_at is None else [ends_at])]:
        emit(control, _straight_to(control, held_end, point, rapid=rapid))
    return reached


def _straight_to(control: Control, at: Vector, point: Point, *, rapid: bool) -> Held:
    """A move in the plane with the feed of the block at hand, which has one of its own behind it."""
    feed, unit = (0.0, "m/s") if rapid else control.feed(linear=True)
    return Held(
        span=control.span,
        kind="rapid" if rapid else "line",
        end=with_plane(at, control, point),
        feed=feed,
        feed_unit=unit,  # type: ignore[arg-type]
        block=control.block_number,
        word="G0" if rapid else "G1",
    )


def leave(control: FanucControl, end: Vector | None, *, rapid: bool) -> None:
    """G40. `end` is where the block goes that says it; by type B the tool goes round the corner between them."""
    state = control.state
    settle(control)
    if end is not None and control.goes_round and is_on(control) and not state.comp_first:
        first, second, _ = PLANE[state.plane]
        op = (state.comp_programmed[first], state.comp_programmed[second])
        goal = (end[first], end[second])
        length = apart(op, goal)
        if length > 0.0 and held_moves(control):
            direction = ((goal[0] - op[0]) / length, (goal[1] - op[1]) / length)
            normal = left(direction) if state.side > 0 else right(direction)
            turn = turn_of(state.comp_normal, normal, state.side)
            if turn > _TANGENT:
                before, control.out[:] = list(control.out), []
                go_round(control, op, normal, turn, ends_at=None, rapid=rapid)
                control.out[:0] = before
    state.comp_starting = state.comp_crossing = False
    state.comp_corners, state.comp_idle, state.comp_lost, state.comp_circle = (), 0, "", None
    leave_as_it_is(control)


__all__ = ["FanucCorners", "change_side", "leave", "look_ahead"]
