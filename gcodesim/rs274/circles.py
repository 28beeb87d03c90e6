"""An arc in the active plane, and the small geometry that arcs and cutter compensation share."""

from __future__ import annotations

import math
from typing import NamedTuple

from gcodesim.units import DEG

_FULL_CIRCLE_ANGLE = 1e-6 * DEG  # ends nearer than this about the centre make a full circle


class Arc(NamedTuple):
    """An arc in the active plane; `turns` is positive for counterclockwise, and counts full circles begun."""

    centre: tuple[float, float]
    turns: int


def apart(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance by the plain square root, which compiled code has to the same last bit (`math.dist` it has not)."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    return math.sqrt(dx * dx + dy * dy)


def sweep_of(start: tuple[float, float], end: tuple[float, float], shape: Arc) -> float:
    """Signed swept angle [rad], full turns included; coinciding ends are a full turn."""
    (cx, cy), turns = shape
    u, v = (start[0] - cx, start[1] - cy), (end[0] - cx, end[1] - cy)
    angle = math.atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1])
    if turns > 0:
        return (angle + 2.0 * math.pi if angle <= _FULL_CIRCLE_ANGLE else angle) + 2.0 * math.pi * (turns - 1)
    return (angle - 2.0 * math.pi if angle >= -_FULL_CIRCLE_ANGLE else angle) + 2.0 * math.pi * (turns + 1)
