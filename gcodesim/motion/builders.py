"""Tool paths from points: lines, arcs, splines and boxes, with the signatures of PyBullet Industrial."""

from __future__ import annotations

import math
from collections.abc import Sequence
from math import pi, sqrt
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.arithmetic.elementary import acos, atan2, cos, sin
from gcodesim.arithmetic.matrices import applied, dot, multiplied, norms
from gcodesim.frames import Array, canonical_quaternion, rotation_from_quaternion
from gcodesim.given import number, numbers, quaternions
from gcodesim.motion.tool_path import ToolPath


def slerp(first: ArrayLike, last: ArrayLike, u: ArrayLike) -> Array:
    """Quaternions (n, 4), x y z w, at shares `u` (n,) of the shorter turn from `first` to `last` (Shoemake 1985)."""
    a, b = canonical_quaternion(np.asarray(first, dtype=float)), canonical_quaternion(np.asarray(last, dtype=float))
    return canonical_quaternion(turn_from(a, b, np.atleast_1d(np.asarray(u, dtype=float))))


def turn_from(a: Array, b: Array, u: Array) -> Array:
    """Quaternions (n, 4) at shares `u` (n,) of the shorter turn between unit quaternions, with the sign of `a`."""
    cosine = dot(a, b)
    if cosine < 0.0:
        b, cosine = -b, -cosine
    if cosine > 1.0 - 1e-12:
        return a + u[:, None] * (b - a)
    angle = acos(cosine)
    weights = np.stack([sin((1.0 - u) * angle), sin(u * angle)], axis=-1) / sin(angle)
    return multiplied(weights, np.stack([a, b]))


def linear_interpolation(
    start_point: ArrayLike,
    end_point: ArrayLike,
    samples: int,
    start_orientation: ArrayLike | None = None,
    end_orientation: ArrayLike | None = None,
) -> ToolPath:
    """A line of `samples` points from `start_point` to `end_point` (3,) [m]; orientations x y z w are turned evenly."""
    u = np.linspace(0.0, 1.0, _count(samples))
    start, end = _ends("the line", start_point, end_point)
    return ToolPath.from_points(start + u[:, None] * (end - start), _turned(u, start_orientation, end_orientation))


def circular_interpolation(
    start_point: ArrayLike,
    end_point: ArrayLike,
    radius: float,
    samples: int,
    axis: int = 2,
    clockwise: bool = True,
    start_orientation: ArrayLike | None = None,
    end_orientation: ArrayLike | None = None,
) -> ToolPath:
    """The shorter arc of `radius` [m] about coordinate axis `axis` from `start_point` to `end_point` (3,) [m].

    The points may differ along the axis (helix). ValueError when the radius
    does not reach, or start and end coincide in the plane.
    """
    start, end = _ends("the arc", start_point, end_point)
    radius = number(radius, "the radius of the arc", above=0.0)
    if axis not in (0, 1, 2):
        raise ValueError(f"the axis of the arc is 0, 1 or 2, for X, Y or Z; {axis!r} is given")
    i, j = (axis + 1) % 3, (axis + 2) % 3
    across = end[[i, j]] - start[[i, j]]
    gap = math.hypot(*across)
    if gap == 0.0:
        raise ValueError("start and end of the arc are the same point in its plane")
    if gap > 2.0 * radius * (1.0 + 1e-12):
        raise ValueError(f"radius {radius} m is too small for end points {gap} m apart")
    height = sqrt(max(radius * radius - 0.25 * gap * gap, 0.0))
    left = np.array([-across[1], across[0]]) / gap
    sign = -1.0 if clockwise else 1.0
    center = start[[i, j]] + 0.5 * across + sign * height * left
    first = atan2(*(start[[i, j]] - center)[::-1])
    sweep = (atan2(*(end[[i, j]] - center)[::-1]) - first) * sign % (2.0 * pi) * sign
    u = np.linspace(0.0, 1.0, _count(samples))
    points = start + u[:, None] * (end - start)
    points[:, i] = center[0] + radius * cos(first + u * sweep)
    points[:, j] = center[1] + radius * sin(first + u * sweep)
    points[0], points[-1] = start, end
    return ToolPath.from_points(points, _turned(u, start_orientation, end_orientation))


def spline_interpolation(
    points: Sequence[ArrayLike] | Array,
    samples: int,
    start_orientation: ArrayLike | None = None,
    end_orientation: ArrayLike | None = None,
    *,
    by: Literal["length", "number"] = "length",
) -> ToolPath:
    """`samples` points on the cubic spline through `points` (n, 3) [m], run by chord length.

    `by` number: between two points it takes the same share, however far they are apart. PyBullet Industrial passes
    points as columns; (3, n) with n other than 3 is taken as such.
    """
    through = numbers(points, (None, None), "a spline")
    if through.shape[1] != 3 and through.shape[0] == 3:
        through = through.T
    numbers(through, (None, 3), "a spline")
    if len(through) < 2:
        raise ValueError("a spline goes through two points or more")
    if by not in ("length", "number"):
        raise ValueError(f"a spline is run by `length` or by `number`; {by!r} is given")
    u = np.linspace(0.0, 1.0, _count(samples))
    return ToolPath.from_points(spline_points(through, u, by), _turned(u, start_orientation, end_orientation))


def spline_points(through: Array, u: Array, by: Literal["length", "number"]) -> Array:
    """Points (m, 3) [m] at shares `u` (m,) of the cubic spline through `through` (n, 3), n at least 2."""
    from scipy.interpolate import CubicSpline, make_interp_spline

    steps = norms(np.diff(through, axis=0)) if by == "length" else np.full(len(through) - 1, 1.0 / (len(through) - 1))
    way = np.concatenate([[0.0], np.cumsum(steps)])
    if len(through) < 4:
        return np.asarray(make_interp_spline(way, through, k=len(through) - 1)(u * way[-1]))
    return np.asarray(CubicSpline(way, through)(u * way[-1]))


def build_box_path(
    center_position: ArrayLike,
    dimensions: Sequence[float],
    angles: ArrayLike,
    radius: float,
    orientation: ArrayLike,
    samples: int,
) -> ToolPath:
    """A closed rectangle of `dimensions` (2,) [m] about `center_position` (3,) [m], corners rounded by `radius` [m].

    `angles` (4,) is the quaternion x y z w that turns the rectangle out of the
    XY plane, `orientation` (4,) that of the tool. Points are spread evenly over
    the length, counterclockwise, from the middle of the right side.
    """
    half = 0.5 * numbers(dimensions, (None,), "the size of a box")[:2]
    radius = number(radius, "the radius of the corners", least=0.0)
    if len(half) < 2:
        raise ValueError("the size of a box has two numbers")
    if radius > half.min():
        raise ValueError(f"corner radius {radius} m does not fit a box of {tuple(dimensions)} m")
    u = np.linspace(0.0, 1.0, _count(samples))
    flat = _round_rectangle(u, half, radius)
    R = rotation_from_quaternion(quaternions(angles, (4,), "the rotation of the box"))
    points = numbers(center_position, (3,), "the middle of the box") + applied(R, flat)
    held = quaternions(orientation, (4,), "the orientation of the tool")
    return ToolPath.from_points(points, np.tile(held, (len(u), 1)))


def _round_rectangle(u: Array, half: Array, radius: float) -> Array:
    """Points (n, 3) at shares `u` of the outline, counterclockwise from (half x, 0)."""
    straight = 2.0 * (half - radius)  # along x, along y
    quarter = 0.5 * pi * radius
    lengths = np.array([0.5 * straight[1]] + [quarter, straight[0], quarter, straight[1]] * 2)
    lengths[-1] *= 0.5
    ends = np.cumsum(lengths)
    way = np.minimum(u * ends[-1], ends[-1])
    part = np.minimum(np.searchsorted(ends, way, side="left"), len(ends) - 1)
    x, y = half - radius
    points = np.zeros((len(u), 3))
    starts = [
        ((half[0], 0.0), (0.0, 1.0)),
        ((x, y), 0.0),
        ((x, half[1]), (-1.0, 0.0)),
        ((-x, y), 0.5 * pi),
        ((-half[0], y), (0.0, -1.0)),
        ((-x, -y), pi),
        ((-x, -half[1]), (1.0, 0.0)),
        ((x, -y), 1.5 * pi),
        ((half[0], -y), (0.0, 1.0)),
    ]
    for k, (anchor, way_on) in enumerate(starts):
        here = part == k
        d = way[here] - (ends[k] - lengths[k])
        if isinstance(way_on, tuple):
            points[here, :2] = np.array(anchor) + d[:, None] * np.array(way_on)
        elif radius > 0.0:
            angle = way_on + d / radius
            points[here, :2] = np.array(anchor) + radius * np.stack([cos(angle), sin(angle)], axis=-1)
    return points


def _count(samples: int) -> int:
    if not isinstance(samples, (int, np.integer)):
        raise ValueError(f"the number of points is a whole number; {samples!r} is given")
    if samples < 2:
        raise ValueError("a path needs at least two points")
    return int(samples)


def _ends(what: str, start: ArrayLike, end: ArrayLike) -> tuple[Array, Array]:
    return numbers(start, (3,), f"the start of {what}"), numbers(end, (3,), f"the end of {what}")


def _turned(u: Array, start: ArrayLike | None, end: ArrayLike | None) -> Array | None:
    if start is None:
        return None
    first = quaternions(start, (4,), "the first orientation")
    return slerp(first, first if end is None else quaternions(end, (4,), "the last orientation"), u)
