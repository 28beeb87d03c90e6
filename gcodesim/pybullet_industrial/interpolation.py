"""Lines, arcs and splines as PyBullet Industrial makes them; what they share with `gcodesim`'s own is computed there.

Points are (3,) [m], quaternions x y z w. Of an arc, the first of the two axes that are left is the one with the smaller
number, so about axis 1 "clockwise" is seen from the other side than about 0 and 2.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.arithmetic.elementary import atan2, cos, sin
from gcodesim.arithmetic.matrices import norm, norms
from gcodesim.frames import Array
from gcodesim.motion import builders
from gcodesim.pybullet_industrial.toolpath import ToolPath


def slerp(start_quat: ArrayLike, end_quat: ArrayLike, t_vals: ArrayLike) -> Array:
    """Quaternions (n, 4) at shares `t_vals` (n,) of the shorter turn, with the sign of the start (Shoemake 1985).

    For a single share, a number, it is one quaternion (4,). Shares below 0 and above 1 turn on beyond the ends.
    """
    first, last = (np.asarray(quat, dtype=float) for quat in (start_quat, end_quat))
    shares = np.asarray(t_vals, dtype=float)
    turned = builders.turn_from(first / norm(first), last / norm(last), np.atleast_1d(shares))
    found = turned / norms(turned)[:, None]  # a turn so small that it is a straight line is a little short
    return found if shares.ndim else found[0]


def build_circular_path(
    center: ArrayLike, radius: float, min_angle: float, max_angle: float, step_num: int, clockwise: bool = True
) -> Array:
    """Points (2, step_num) about `center` (2,), from `min_angle` [rad] on by the difference of both, either way."""
    share = np.arange(step_num) / max(step_num - 1, 1)
    angle = min_angle + (-1.0 if clockwise else 1.0) * share * (max_angle - min_angle)
    return np.asarray(center, dtype=float)[:, None] + radius * np.stack([cos(angle), sin(angle)])


def linear_interpolation(
    start_point: ArrayLike,
    end_point: ArrayLike,
    samples: int,
    start_orientation: ArrayLike | None = None,
    end_orientation: ArrayLike | None = None,
) -> ToolPath:
    """A line of `samples` points; without `end_orientation` the tool keeps the first one."""
    path = ToolPath(np.linspace(np.asarray(start_point, float), np.asarray(end_point, float), num=samples).T.copy())
    return _turned(path, start_orientation, end_orientation)


def planar_circular_interpolation(
    start_point: ArrayLike, end_point: ArrayLike, radius: float, samples: int, clockwise: bool = True
) -> Array:
    """Points (2, samples) on the shorter arc between points (2,) [m].

    ValueError when they are one point, or as far apart as the diameter, or further.
    """
    start, end = np.asarray(start_point, dtype=float), np.asarray(end_point, dtype=float)
    across = end - start
    gap = math.hypot(*across)
    if radius <= 0.5 * gap:
        raise ValueError(f"the radius is {radius} m; between points {gap} m apart it has to be more than {0.5 * gap} m")
    if gap == 0.0:
        raise ValueError("an arc does not begin and end in the same point; its middle would be anywhere")
    left = np.array([-across[1], across[0]]) / gap
    height = math.sqrt(radius * radius - 0.25 * gap * gap)
    center = 0.5 * (start + end) + (-height if clockwise else height) * left
    first = float(atan2(*(start - center)[::-1]))
    sweep = 2.0 * float(atan2(0.5 * gap, height))
    return build_circular_path(center, radius, first, first + sweep, samples, clockwise)


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
    """The shorter arc of `radius` [m] about coordinate axis `axis`, along which the points may differ (helix)."""
    start, end = np.asarray(start_point, dtype=float), np.asarray(end_point, dtype=float)
    plane = [k for k in range(3) if k != axis]
    positions = np.empty((3, samples))
    positions[plane] = planar_circular_interpolation(start[plane], end[plane], radius, samples, clockwise)
    positions[axis] = np.linspace(start[axis], end[axis], samples)
    return _turned(ToolPath(positions), start_orientation, end_orientation)


def spline_interpolation(points: ArrayLike, samples: int) -> ToolPath:
    """`samples` points on the cubic spline through the columns of `points` (3, n), all stretches in equal time."""
    through = np.ascontiguousarray(np.asarray(points, dtype=float).T)
    if len(through) < 2:
        raise ValueError("a spline goes through two points or more")
    return ToolPath(builders.spline_points(through, np.linspace(0.0, 1.0, samples), "number").T.copy())


def _turned(path: ToolPath, start: ArrayLike | None, end: ArrayLike | None) -> ToolPath:
    if start is not None:
        path.orientations = slerp(start, start if end is None else end, np.linspace(0.0, 1.0, len(path))).T.copy()
    return path
