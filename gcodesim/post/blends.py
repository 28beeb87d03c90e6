"""How far before each point a robot may leave the line to it, so that it keeps to the path that was checked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.post.moves import ArmPlace, Remark, RobotMove, RobotStep, RobotSwitch
from gcodesim.post.straight import half_sine, turn_between


@frozen(eq=False)
class CutCorner:
    """What holds at the end of a move that goes on: `zone` [m] is where the corner that was checked begins, None where
    the path goes straight on; `tolerance` [m] is how far it may be cut."""

    zone: float | None
    tolerance: float


@frozen(eq=False)
class Passing(RobotStep):
    """A move at whose end the robot goes on, round a `corner`."""

    move: RobotMove
    corner: CutCorner


def rounded(steps: Sequence[RobotStep], start: ArmPlace) -> Iterator[RobotStep]:
    """The same steps, with a `blend` for every move that passes its end.

    A control rounds a corner by a parabola that begins and ends in the distance d from it and cuts it by
    d sin(turn / 2) / 2.
    """
    at = start
    for number, step in enumerate(steps):
        if isinstance(step, Passing):
            after = _next_move(steps, number)
            blend = 0.0 if after is None else _zone(at, step.move, after, step.corner)
            yield replace(step.move, blend=blend)
            at = step.move.to
            continue
        yield step
        if isinstance(step, RobotMove):
            at = step.to


def _next_move(steps: Sequence[RobotStep], number: int) -> RobotMove | None:
    """The move after step `number`; None where the robot has to stand before it."""
    for after in range(number + 1, len(steps)):
        step = steps[after]
        if isinstance(step, (RobotMove, Passing)):
            return step if isinstance(step, RobotMove) else step.move
        if not (isinstance(step, Remark) or (isinstance(step, RobotSwitch) and step.with_motion)):
            return None
    return None


def _zone(start: ArmPlace, move: RobotMove, after: RobotMove, corner: CutCorner) -> float:
    before, beyond = _stretch(start, move), _stretch(move.to, after)
    room = 0.5 * min(before.length, beyond.length)
    if corner.zone is not None:
        return min(room, corner.zone)
    half = half_sine(turn_between(before.end, beyond.begin))
    zone = room if half <= 0.0 else min(room, 2.0 * corner.tolerance / half)
    for bend in (before.bend, beyond.bend):
        if bend > 0.0:
            zone = min(zone, math.sqrt(8.0 * corner.tolerance / bend))
    return zone


@frozen(eq=False)
class _Stretch:
    """The way of the tip in a move: directions (3,) at both ends, its length [m] and bend [1/m]."""

    begin: Array
    end: Array
    length: float
    bend: float


def _stretch(start: ArmPlace, move: RobotMove) -> _Stretch:
    p, q = start.X_BT.p, move.to.X_BT.p
    if move.via is None:
        return _Stretch(begin=q - p, end=q - p, length=norm(q - p), bend=0.0)
    first, second = move.via.X_BT.p - p, q - move.via.X_BT.p
    across = np.cross(first, second)
    area = norm(across)
    if area == 0.0:
        return _Stretch(begin=q - p, end=q - p, length=norm(q - p), bend=0.0)
    radius = norm(first) * norm(second) * norm(q - p) / (2.0 * area)
    axis = across / area
    # the tangent at the end of a chord of half the arc leans by as much as the next chord turns, halved
    lean = 0.5 * turn_between(first, second)
    return _Stretch(
        begin=_turned(first, axis, -lean),
        end=_turned(second, axis, lean),
        length=2.0 * radius * 2.0 * lean,
        bend=1.0 / radius,
    )


def _turned(v: Array, axis: Array, angle: float) -> Array:
    """A direction (3,) across `axis`, turned about it."""
    half = half_sine(angle)
    sine = 2.0 * half * math.sqrt(max(0.0, 1.0 - half * half))
    turned: Array = (1.0 - 2.0 * half * half) * v + sine * np.cross(axis, v)
    return turned
