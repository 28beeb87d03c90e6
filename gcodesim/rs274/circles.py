"""An arc in the active plane, and simple geometry that arcs, corners and cutter compensation share."""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.arithmetic.scalars import atan2
from gcodesim.frozen import frozen
from gcodesim.units import DEG

Point = tuple[float, float]

_FULL_CIRCLE_ANGLE = 1e-6 * DEG  # ends nearer than this about the centre make a full circle


class Arc(NamedTuple):
    """An arc in the active plane; `turns` is positive for counterclockwise, and counts full circles begun."""

    centre: tuple[float, float]
    turns: int


@frozen(kw_only=False)
class Line:
    """A line without ends; `direction` has length 1."""

    point: Point
    direction: Point


@frozen(kw_only=False)
class PlaneCircle:
    centre: Point
    radius: float


def apart(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance by the plain square root, which compiled code reproduces to the last bit (unlike `math.dist`)."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    return math.sqrt(dx * dx + dy * dy)


def sweep_of(start: tuple[float, float], end: tuple[float, float], shape: Arc) -> float:
    """Signed swept angle [rad], full turns included; coinciding ends are a full turn."""
    (cx, cy), turns = shape
    u, v = (start[0] - cx, start[1] - cy), (end[0] - cx, end[1] - cy)
    angle = atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    if turns > 0:
        return (angle + 2.0 * math.pi if angle <= _FULL_CIRCLE_ANGLE else angle) + 2.0 * math.pi * (turns - 1)
    return (angle - 2.0 * math.pi if angle >= -_FULL_CIRCLE_ANGLE else angle) + 2.0 * math.pi * (turns + 1)


def meet(a: Line | PlaneCircle, b: Line | PlaneCircle) -> list[Point]:
    """Points that two lines or circles have in common: none, one or two; of a line and a circle along the line."""
    if isinstance(a, Line) and isinstance(b, Line):
        cross = a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0]
        if abs(cross) < 1e-12:
            return []
        dx, dy = b.point[0] - a.point[0], b.point[1] - a.point[1]
        along = (dx * b.direction[1] - dy * b.direction[0]) / cross
        return [(a.point[0] + along * a.direction[0], a.point[1] + along * a.direction[1])]
    if isinstance(a, PlaneCircle) and isinstance(b, PlaneCircle):
        return _circles_meet(a, b)
    line, circle = (a, b) if isinstance(a, Line) else (b, a)
    assert isinstance(line, Line) and isinstance(circle, PlaneCircle)
    dx, dy = line.point[0] - circle.centre[0], line.point[1] - circle.centre[1]
    along = dx * line.direction[0] + dy * line.direction[1]
    inside = along * along - (dx * dx + dy * dy - circle.radius * circle.radius)
    if inside < 0.0:
        return []
    root = math.sqrt(inside)
    return [
        (line.point[0] + t * line.direction[0], line.point[1] + t * line.direction[1])
        for t in (-along - root, -along + root)
    ]


def _circles_meet(a: PlaneCircle, b: PlaneCircle) -> list[Point]:
    distance = apart(a.centre, b.centre)
    if distance == 0.0:
        return []
    along = (distance * distance + a.radius * a.radius - b.radius * b.radius) / (2.0 * distance)
    square = a.radius * a.radius - along * along
    if square < 0.0:
        return []
    height = math.sqrt(square)
    ux, uy = (b.centre[0] - a.centre[0]) / distance, (b.centre[1] - a.centre[1]) / distance
    foot = (a.centre[0] + along * ux, a.centre[1] + along * uy)
    return [(foot[0] - height * uy, foot[1] + height * ux), (foot[0] + height * uy, foot[1] - height * ux)]
