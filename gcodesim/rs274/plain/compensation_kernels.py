"""Moves beside the programmed path: `rs274/compensation.py` in compiled form, step by step the same.

Here one move in the plane waits for the next one. Where anything else waits, or
a corner is a fault, the line is left.
"""

from __future__ import annotations

import math

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.compiled import kernel
from gcodesim.rs274.plain.arc_kernels import apart, plane_axes, sweep_of
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.control_kernels import put, put_arc, speed
from gcodesim.rs274.plain.layout_kernels import (
    ARC_CENTRE,
    ARC_TURNS,
    CORNER,
    CURRENT,
    EMITTED,
    ENDPOINT,
    HAS_ENDPOINT,
    HELD_CENTRE,
    HELD_DIRECTION,
    HELD_END,
    HELD_FEED,
    HELD_KIND,
    HELD_PLACE,
    HELD_ROTARY,
    HELD_SWEEP,
    HELD_TURNS,
    JOIN,
    NEXT_DIRECTION,
    NEXT_END,
    NEXT_NORMAL,
    NEXT_START,
    NORMAL,
    PLACE,
    PLANE,
    RADIUS,
    SIDE,
    TARGET,
    UNIT,
)

# as in compensation.py
_STRAIGHT_ON = 0.05
_SWEEP_SLACK = 0.0254 * 1e-3

# how the move that waits meets the one at hand
_ON, _AROUND, _INSIDE = 0, 1, 2


@kernel
def meets(numbers: Column, modes: Column, motion: int) -> bool:
    """Find out how the move that waits and the move to the target meet; False when they do not, or the line is left."""
    first, second, _ = plane_axes(modes[PLANE])
    side, radius = modes[SIDE], numbers[RADIUS]
    x, y = numbers[CURRENT + first], numbers[CURRENT + second]
    to_x, to_y = numbers[TARGET + first], numbers[TARGET + second]
    turns, path_radius = 0, 0.0
    if motion >= 20:
        cx, cy, turns = numbers[ARC_CENTRE], numbers[ARC_CENTRE + 1], modes[ARC_TURNS]
        arc_radius = apart(to_x, to_y, cx, cy)
        inside = (turns > 0) == (side > 0)
        if inside and arc_radius <= radius:
            return False
        sign = -1.0 if inside else 1.0
        out_x, out_y = _towards(cx, cy, to_x, to_y, sign)
        in_x, in_y = _towards(cx, cy, x, y, sign)
        path_radius = arc_radius + sign * radius
        along_x, along_y = 0.0, 0.0
    else:
        length = apart(x, y, to_x, to_y)
        if length == 0.0:
            return False
        along_x, along_y = (to_x - x) / length, (to_y - y) / length
        out_x, out_y = (-along_y, along_x) if side > 0 else (along_y, -along_x)
        in_x, in_y = out_x, out_y
    numbers[NEXT_START], numbers[NEXT_START + 1] = x + radius * in_x, y + radius * in_y
    numbers[NEXT_END], numbers[NEXT_END + 1] = to_x + radius * out_x, to_y + radius * out_y
    numbers[NEXT_DIRECTION], numbers[NEXT_DIRECTION + 1] = along_x, along_y
    numbers[NEXT_NORMAL], numbers[NEXT_NORMAL + 1] = out_x, out_y
    turn = _turn_outward(numbers[NORMAL], numbers[NORMAL + 1], in_x, in_y, side)
    corner_x, corner_y = numbers[HELD_END + first], numbers[HELD_END + second]
    if -_STRAIGHT_ON <= turn <= _STRAIGHT_ON:
        modes[JOIN] = _ON
    elif _STRAIGHT_ON < turn <= _outside_limit(turns if turns != 0 else modes[HELD_TURNS], side):
        modes[JOIN] = _AROUND
    else:
        modes[JOIN] = _INSIDE
        found, corner_x, corner_y = _intersection(numbers, modes, corner_x, corner_y, x, y, path_radius)
        if not found:
            return False
    numbers[CORNER], numbers[CORNER + 1] = corner_x, corner_y
    return _runs_forward(numbers, modes, corner_x, corner_y)


@kernel
def go_beside(
    numbers: Column, modes: Column, moves: Column, facts: Column, shapes: Column, kind: int, linear: bool
) -> None:
    """Emit the move that waits and the moves round the corner; from now on the move to the target waits."""
    first, second, _ = plane_axes(modes[PLANE])
    corner_x, corner_y = numbers[CURRENT + first], numbers[CURRENT + second]
    for axis in range(6):
        numbers[CURRENT + axis] = numbers[TARGET + axis]
    numbers[HELD_END + first], numbers[HELD_END + second] = numbers[CORNER], numbers[CORNER + 1]
    held = modes[HELD_KIND]
    if held > 1:
        _arc(numbers, modes, shapes, HELD_CENTRE, modes[HELD_TURNS])
    _emit(numbers, modes, moves, facts, held, numbers[HELD_FEED], modes[HELD_ROTARY] != 0, HELD_PLACE)
    if modes[JOIN] == _AROUND:
        for axis in range(3, 6):
            numbers[HELD_END + axis] = numbers[CURRENT + axis]
        numbers[HELD_END + first], numbers[HELD_END + second] = numbers[NEXT_START], numbers[NEXT_START + 1]
        if kind == 0:
            _emit(numbers, modes, moves, facts, 0, 0.0, False, PLACE)
        else:
            turns = -1 if modes[SIDE] > 0 else 1
            numbers[HELD_CENTRE], numbers[HELD_CENTRE + 1] = corner_x, corner_y
            _arc(numbers, modes, shapes, HELD_CENTRE, turns)
            _emit(numbers, modes, moves, facts, 2 if turns < 0 else 3, speed(numbers, modes, True), False, PLACE)
    _wait(numbers, modes, kind, linear)


@kernel
def _arc(numbers: Column, modes: Column, shapes: Column, centre: int, turns: int) -> None:
    """The shape of an arc from where the tool stands to the end of the move that waits."""
    first, second, across = plane_axes(modes[PLANE])
    sweep = sweep_of(
        numbers[EMITTED + first],
        numbers[EMITTED + second],
        numbers[HELD_END + first],
        numbers[HELD_END + second],
        numbers[centre],
        numbers[centre + 1],
        turns,
    )
    put_arc(numbers, modes, shapes, centre, numbers[HELD_END + across], sweep, turns)


@kernel
def _emit(
    numbers: Column, modes: Column, moves: Column, facts: Column, kind: int, feed: float, rotary: bool, place: int
) -> None:
    """The row of a move to the end of the one that waits."""
    first, second, _ = plane_axes(modes[PLANE])
    for axis in range(6):
        numbers[TARGET + axis] = numbers[EMITTED + axis] = numbers[HELD_END + axis]
    numbers[ENDPOINT], numbers[ENDPOINT + 1] = numbers[HELD_END + first], numbers[HELD_END + second]
    modes[HAS_ENDPOINT] = 1
    put(numbers, modes, moves, facts, kind, kind, feed, rotary, place)


@kernel
def _wait(numbers: Column, modes: Column, kind: int, linear: bool) -> None:
    """The move to the current point is the one that waits."""
    first, second, _ = plane_axes(modes[PLANE])
    for axis in range(6):
        numbers[HELD_END + axis] = numbers[CURRENT + axis]
    numbers[HELD_END + first], numbers[HELD_END + second] = numbers[NEXT_END], numbers[NEXT_END + 1]
    turns, sweep = 0, 0.0
    if kind > 1:
        turns = modes[ARC_TURNS]
        sweep = sweep_of(
            numbers[NEXT_START],
            numbers[NEXT_START + 1],
            numbers[NEXT_END],
            numbers[NEXT_END + 1],
            numbers[ARC_CENTRE],
            numbers[ARC_CENTRE + 1],
            turns,
        )
        numbers[HELD_CENTRE], numbers[HELD_CENTRE + 1] = numbers[ARC_CENTRE], numbers[ARC_CENTRE + 1]
    numbers[HELD_DIRECTION], numbers[HELD_DIRECTION + 1] = numbers[NEXT_DIRECTION], numbers[NEXT_DIRECTION + 1]
    numbers[NORMAL], numbers[NORMAL + 1] = numbers[NEXT_NORMAL], numbers[NEXT_NORMAL + 1]
    numbers[HELD_SWEEP] = sweep
    numbers[HELD_FEED] = speed(numbers, modes, linear) if kind > 0 else 0.0
    modes[HELD_KIND], modes[HELD_TURNS], modes[HELD_ROTARY] = kind, turns, kind > 0 and not linear
    for each in range(5):
        modes[HELD_PLACE + each] = modes[PLACE + each]


@kernel
def _towards(cx: float, cy: float, x: float, y: float, sign: float) -> tuple[float, float]:
    """Unit vector from the centre through a point, times `sign`."""
    length = apart(cx, cy, x, y)
    return sign * (x - cx) / length, sign * (y - cy) / length


@kernel
def _turn_outward(bx: float, by: float, ax: float, ay: float, side: int) -> float:
    """Angle [rad] from the normal `b` to the normal `a`, positive where the corner is outside."""
    angle = atan2(bx * ay - by * ax, bx * ax + by * ay)
    turn = -angle if side > 0 else angle
    return turn + 2.0 * math.pi if turn < -math.pi / 2.0 else turn


@kernel
def _outside_limit(turns: int, side: int) -> float:
    """Up to which turn a corner counts as outside; `turns` of the arc that takes part, 0 for none."""
    around = turns != 0 and (turns > 0) != (side > 0)
    return math.pi - _STRAIGHT_ON if around else math.pi + _STRAIGHT_ON


@kernel
def _runs_forward(numbers: Column, modes: Column, x: float, y: float) -> bool:
    """Whether the move that waits still runs forward when it ends at x, y."""
    if not modes[HAS_ENDPOINT]:
        return True
    from_x, from_y = numbers[ENDPOINT], numbers[ENDPOINT + 1]
    if modes[HELD_KIND] > 1:
        cx, cy = numbers[HELD_CENTRE], numbers[HELD_CENTRE + 1]
        sweep = sweep_of(from_x, from_y, x, y, cx, cy, modes[HELD_TURNS])
        most: float = abs(numbers[HELD_SWEEP]) + _SWEEP_SLACK / numbers[UNIT]
        return abs(sweep) <= most
    along: float = numbers[HELD_DIRECTION] * (x - from_x) + numbers[HELD_DIRECTION + 1] * (y - from_y)
    return along >= 0.0


@kernel
def _intersection(
    numbers: Column, modes: Column, end_x: float, end_y: float, x: float, y: float, next_radius: float
) -> tuple[bool, float, float]:
    """Where the two offset paths meet; of two points, the one that a control takes; `next_radius` is 0 for a line.

    The path at hand leaves the programmed corner `x`, `y`.
    """
    dx, dy = numbers[HELD_DIRECTION], numbers[HELD_DIRECTION + 1]
    cx, cy = numbers[HELD_CENTRE], numbers[HELD_CENTRE + 1]
    start_x, start_y = numbers[NEXT_START], numbers[NEXT_START + 1]
    next_dx, next_dy = numbers[NEXT_DIRECTION], numbers[NEXT_DIRECTION + 1]
    next_cx, next_cy = numbers[ARC_CENTRE], numbers[ARC_CENTRE + 1]
    side, held_turns, turns = modes[SIDE], modes[HELD_TURNS], modes[ARC_TURNS]
    inside_held, inside_next = (held_turns > 0) == (side > 0), (turns > 0) == (side > 0)
    tool = numbers[RADIUS]
    off_x, off_y = 0.0, 0.0
    if modes[HELD_KIND] < 2:
        if next_radius == 0.0:
            cross = dx * next_dy - dy * next_dx
            if abs(cross) < 1e-12:
                return False, 0.0, 0.0
            along = ((start_x - end_x) * next_dy - (start_y - end_y) * next_dx) / cross
            return True, end_x + along * dx, end_y + along * dy
        off_x, off_y = _off_by(next_cx, next_cy, x, y, next_radius + (tool if inside_next else -tool))
        found, ax, ay, bx, by = _line_meets_circle(end_x, end_y, dx, dy, next_cx - off_x, next_cy - off_y, next_radius)
    else:
        radius = apart(cx, cy, end_x, end_y)
        if next_radius == 0.0:
            over_x, over_y = _off_by(cx, cy, x, y, radius + (tool if inside_held else -tool))
            start_x, start_y = start_x + over_x, start_y + over_y
            found, ax, ay, bx, by = _line_meets_circle(start_x, start_y, next_dx, next_dy, cx, cy, radius)
        else:
            found, ax, ay, bx, by = _circles_meet(cx, cy, radius, next_cx, next_cy, next_radius)
    if not found:
        return False, 0.0, 0.0
    ax, ay, bx, by = ax + off_x, ay + off_y, bx + off_x, by + off_y
    if modes[HELD_KIND] < 2:
        b_is_further = bx * dx + by * dy > ax * dx + ay * dy
        a_is_further = bx * dx + by * dy < ax * dx + ay * dy
        takes_b = b_is_further if inside_next else a_is_further
    elif next_radius == 0.0:
        b_is_further = bx * next_dx + by * next_dy > ax * next_dx + ay * next_dy
        a_is_further = bx * next_dx + by * next_dy < ax * next_dx + ay * next_dy
        takes_b = a_is_further if inside_held else b_is_further
    else:
        takes_b = inside_held != (turns > 0)
    if takes_b:
        return True, bx, by
    return True, ax, ay


@kernel
def _off_by(cx: float, cy: float, x: float, y: float, radius: float) -> tuple[float, float]:
    """How far the centre is beyond the point that lies `radius` from `x`, `y` towards it."""
    part = 1.0 - radius / apart(x, y, cx, cy)
    return (cx - x) * part, (cy - y) * part


@kernel
def _line_meets_circle(
    x: float, y: float, dx: float, dy: float, cx: float, cy: float, radius: float
) -> tuple[bool, float, float, float, float]:
    from_x, from_y = x - cx, y - cy
    along = from_x * dx + from_y * dy
    inside = along * along - (from_x * from_x + from_y * from_y - radius * radius)
    if inside < 0.0:
        return False, 0.0, 0.0, 0.0, 0.0
    root = math.sqrt(inside)
    a, b = -along - root, -along + root
    return True, x + a * dx, y + a * dy, x + b * dx, y + b * dy


@kernel
def _circles_meet(
    ax: float, ay: float, a: float, bx: float, by: float, b: float
) -> tuple[bool, float, float, float, float]:
    distance = apart(ax, ay, bx, by)
    if distance == 0.0:
        return False, 0.0, 0.0, 0.0, 0.0
    along = (distance * distance + a * a - b * b) / (2.0 * distance)
    square = a * a - along * along
    if square < 0.0:
        return False, 0.0, 0.0, 0.0, 0.0
    height = math.sqrt(square)
    ux, uy = (bx - ax) / distance, (by - ay) / distance
    x, y = ax + along * ux, ay + along * uy
    return True, x - height * uy, y + height * ux, x + height * uy, y - height * ux
