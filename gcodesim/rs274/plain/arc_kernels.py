"""Centre, turns and sweep of an arc from its words: `arcs.py` and `circles.py` compiled, step by step the same."""

from __future__ import annotations

import math

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.compiled import kernel
from gcodesim.rs274.plain.columns import Column
from gcodesim.rs274.plain.layout_kernels import ARC_ALWAYS, ARC_MOST, BY_START, UNIT

# as in arcs.py
_RELATIVE_MISS = 1e-3
_SMALLEST_RADIUS = 1.27e-6
_FULL_CIRCLE_ANGLE = 1e-6 * (math.pi / 180.0)

# anything closer than this to a limit is left to the grammar's lane, which measures by `math.dist`
_SURE = 1e-9


@kernel
def plane_axes(plane: int) -> tuple[int, int, int]:
    """First, second and normal axis of a plane: 170, 180 or 190."""
    if plane == 170:
        return 0, 1, 2
    if plane == 180:
        return 2, 0, 1
    return 1, 2, 0


@kernel
def apart(ax: float, ay: float, bx: float, by: float) -> float:
    """Distance of two points of the plane."""
    dx, dy = bx - ax, by - ay
    return math.sqrt(dx * dx + dy * dy)


@kernel
def radii_agree(
    ax: float, ay: float, bx: float, by: float, cx: float, cy: float, numbers: Column, modes: Column
) -> bool:
    """Whether an arc about `c` from `a` to `b` is accepted for sure, in program units."""
    unit, always, most = numbers[UNIT], numbers[ARC_ALWAYS], numbers[ARC_MOST]
    at_start, at_end = apart(ax, ay, cx, cy) * unit, apart(bx, by, cx, cy) * unit
    least = _SMALLEST_RADIUS * (1.0 + _SURE)
    if not (at_start > least and at_end > least):
        return False
    radius = at_start if modes[BY_START] else max(at_start, at_end)
    allowed = min(max(always, _RELATIVE_MISS * radius), most)
    agree: bool = abs(at_start - at_end) < allowed * (1.0 - 1e-6)
    return agree


@kernel
def centre_by_radius(
    radius: float, ax: float, ay: float, bx: float, by: float, turns: int, unit: float
) -> tuple[bool, float, float]:
    """Whether there is a centre, and the centre."""
    chord = apart(ax, ay, bx, by)
    size, half = abs(radius), chord / 2.0
    if chord == 0.0 or size == 0.0 or not (half - size) * unit < _SMALLEST_RADIUS * (1.0 - _SURE):
        return False, 0.0, 0.0
    if half / size > 1.0 - 1e-12:
        return True, (ax + bx) / 2.0, (ay + by) / 2.0
    height = math.sqrt(max(size * size - half * half, 0.0))
    left = (turns > 0) == (radius > 0.0)
    dx, dy = (bx - ax) / chord, (by - ay) / chord
    sign = height if left else -height
    return True, (ax + bx) / 2.0 - dy * sign, (ay + by) / 2.0 + dx * sign


@kernel
def sweep_of(ax: float, ay: float, bx: float, by: float, cx: float, cy: float, turns: int) -> float:
    """Signed swept angle [rad], full turns included."""
    ux, uy, vx, vy = ax - cx, ay - cy, bx - cx, by - cy
    angle = atan2(ux * vy - uy * vx, ux * vx + uy * vy)
    if turns > 0:
        if angle <= _FULL_CIRCLE_ANGLE:
            angle = angle + 2.0 * math.pi
        return angle + 2.0 * math.pi * (turns - 1)
    if angle >= -_FULL_CIRCLE_ANGLE:
        angle = angle - 2.0 * math.pi
    return angle + 2.0 * math.pi * (turns + 1)
