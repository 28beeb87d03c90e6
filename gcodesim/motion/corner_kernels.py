"""The arc that rounds a corner between two lines or arcs of one plane; scalars in and out.

All in the plane of the corner: its point at the origin, X along the incoming
tangent, Y to the side to which the path turns. A curve has a radius (0: a line)
and a side, +1 when it bends towards Y, -1 away from it.
"""

from __future__ import annotations

import math

from gcodesim.arithmetic.atan_kernels import atan2
from gcodesim.arithmetic.sin_kernels import cos_sin, sin, tan
from gcodesim.compiled import kernel

HALVINGS = 40


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
def corner_radius(
    turn: float,
    r1: float,
    side1: float,
    r2: float,
    side2: float,
    tolerance: float,
    room1: float,
    room2: float,
    most: float,
) -> float:
    """The greatest radius up to `most` that misses the corner by `tolerance` at most and fits into its room."""
    if r1 == 0.0 and r2 == 0.0:
        half = 0.5 * (math.pi - turn)
        s = sin(half)
        radius = min(most, min(room1, room2) * tan(half))
        return min(radius, tolerance * s / (1.0 - s)) if s < 1.0 else radius
    low, high = 0.0, most
    for _ in range(HALVINGS):
        radius = 0.5 * (low + high)
        x, y = corner_center(turn, r1, side1, r2, side2, radius)
        fits = not math.isnan(x)
        if fits:
            trim1 = -way_from_corner(x, y, 0.0, r1, side1)
            trim2 = way_from_corner(x, y, turn, r2, side2)
            fits = math.sqrt(x * x + y * y) - radius <= tolerance and 0.0 <= trim1 <= room1 and 0.0 <= trim2 <= room2
        if fits:
            low = radius
        else:
            high = radius
    return low
