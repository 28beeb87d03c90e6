"""The arc that rounds a corner between two lines or arcs of one plane; scalars in and out.

All in the plane of the corner: its point at the origin, X along the incoming
tangent, Y to the side to which the path turns. A curve has a radius (0: a line)
and a side, +1 when it bends towards Y, -1 away from it.
"""

from __future__ import annotations

import math

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.arithmetic.sin_kernels import cos, cos_sin, sin, tan
from gcodesim.compiled import kernel


@kernel
def corner_center(turn: float, r1: float, side1: float, r2: float, side2: float, radius: float) -> tuple[float, float]:
    """Centre of the circle of `radius` on the inner side that touches both curves; NaN when there is none.

    It lies at `radius` from both: on the line or circle parallel to each. Of the
    crossings the one nearest to that of the two tangents counts.
    """
    x0, y0 = -radius * tan(0.5 * turn), radius
    if r1 == 0.0 and r2 == 0.0:
        return x0, y0
    c, s = cos_sin(turn)
    if r1 == 0.0 or r2 == 0.0:
        # circle of the arc against the parallel of the line: n.p = radius
        if r1 == 0.0:
            n0, n1 = 0.0, 1.0
            cx, cy, rho = -side2 * r2 * s, side2 * r2 * c, r2 - side2 * radius
        else:
            n0, n1 = -s, c
            cx, cy, rho = 0.0, side1 * r1, r1 - side1 * radius
        off = radius - (n0 * cx + n1 * cy)
        square = rho * rho - off * off
        if rho <= 0.0 or square < 0.0:
            return math.nan, math.nan
        fx, fy, dx, dy = cx + off * n0, cy + off * n1, -n1, n0
    else:
        ax, ay, rho1 = 0.0, side1 * r1, r1 - side1 * radius
        bx, by, rho2 = -side2 * r2 * s, side2 * r2 * c, r2 - side2 * radius
        gap = math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))
        if rho1 <= 0.0 or rho2 <= 0.0 or gap == 0.0:
            return math.nan, math.nan
        along = (gap * gap + rho1 * rho1 - rho2 * rho2) / (2.0 * gap)
        square = rho1 * rho1 - along * along
        if square < 0.0:
            return math.nan, math.nan
        ex, ey = (bx - ax) / gap, (by - ay) / gap
        fx, fy, dx, dy = ax + along * ex, ay + along * ey, -ey, ex
    h = math.sqrt(square)
    # of the points f + h d and f − h d, the one nearer to that of the tangents
    if h * ((fx - x0) * dx + (fy - y0) * dy) > 0.0:
        h = -h
    return fx + h * dx, fy + h * dy


@kernel
def way_from_corner(x: float, y: float, angle: float, r: float, side: float) -> float:
    """Length along a curve that leaves the origin at `angle`, from there to the foot of point (x, y); signed."""
    c, s = cos_sin(angle)
    along, across = c * x + s * y, c * y - s * x
    if r == 0.0:
        return along
    # seen from the centre of the arc, at (0, side r) in its own axes
    return r * atan2(along, side * (side * r - across))


@kernel
def corner_radius(half: float, tolerance: float, way1: float, way2: float) -> float:
    """Radius of the arc that misses the corner of two lines by `tolerance`; between them is the angle 2 `half` [rad].

    R = P s / (1 - s) with s = sin(half); it begins and ends at most `way1` and `way2` from the corner.
    """
    s, way = sin(half), min(way1, way2)
    if s < 1.0:
        way = min(way, cos(half) * tolerance / (1.0 - s))
    return way * tan(half)


@kernel
def part_for_corner(r: float, side: float, angle: float, half: float) -> tuple[float, float, float]:
    """What a corner may take of an arc of radius `r` that has `angle` [rad] to give.

    Of an arc that bends into the corner it is the angle 2 `half` of its tangents that limits it, and its secant stands
    for it. Gives the greatest angle [rad], the way along tangent or secant, and by how much that narrows `half`.
    """
    if side > 0.0:
        most = min(angle, half)
        return most, sin(0.25 * most) * r, 0.25 * most
    most = min(angle, 0.5 * math.pi)
    return most, most * r, 0.0
