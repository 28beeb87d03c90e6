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
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from gcodesim.rs274.circles import Line, PlaneCircle, Point, apart
from gcodesim.rs274.compensation import (
    PLANE,
    STRAIGHT_ON,
    Held,
    NextMove,
    beside,
    emit,
    flush,
    held_moves,
    intersection,
    is_on,
    left,
    right,
    settle,
    turn_outward,
    with_plane,
)
from gcodesim.rs274.compensation import leave as leave_as_it_is
from gcodesim.rs274.fault import Fault
from gcodesim.rs274.state import Vector

if TYPE_CHECKING:
    from gcodesim.rs274.control import Control
    from gcodesim.rs274.fanuc.control import FanucControl

_TANGENT: Final = 1e-6  # [rad] flatter corners are none
_REVERSED: Final = 1e-3  # [rad] from a full reversal, on either side: counts as outside


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
        state = self._fanuc.state
        turn = turn_of(state.comp_normal, to.normal, state.side)
        starting, state.comp_starting = state.comp_starting, False
        if starting and (turn <= _TANGENT or not self._fanuc.goes_round):
            flush(control, corner=to.offset_start)
        elif abs(turn) <= _TANGENT:
            flush(control, lenient=True)
        elif turn > 0.0:
            ends_at = to.offset_start if isinstance(to.path, PlaneCircle) else None
            go_round(control, to.op, to.normal, turn, ends_at=ends_at, rapid=to.rapid)
        elif not any(type(event) is Held for event in state.held):
            flush(control)  # after a stop nothing waits, and an inside corner is left as it is
        else:
            flush(control, corner=_inside(control, to, turn))


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
        return intersection(control, to)
    except Fault:
        if turn < -STRAIGHT_ON:
            raise
        return None  # arcs that all but touch need not meet after rounding


def _where_tangents_meet(op: Point, before: Point, after: Point, radius: float) -> Point:
    size = radius / (1.0 + before[0] * after[0] + before[1] * after[1])
    return op[0] + size * (before[0] + after[0]), op[1] + size * (before[1] + after[1])


def go_round(control: Control, op: Point, normal: Point, turn: float, *, ends_at: Point | None, rapid: bool) -> None:
    """Let the held move end where the outside corner begins, and go round it by straight moves.

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
    feed, unit = (0.0, "m/s") if rapid else control.feed(linear=True)
    for point in [*points, *([] if ends_at is None else [ends_at])]:
        piece = Held(
            span=control.span,
            kind="rapid" if rapid else "line",
            end=with_plane(held_end, control, point),
            feed=feed,
            feed_unit=unit,  # type: ignore[arg-type]
            block=control.block_number,
            word="G0" if rapid else "G1",
        )
        emit(control, piece)


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
    state.comp_starting = False
    leave_as_it_is(control)


__all__ = ["FanucCorners", "leave"]
