"""The path of every row as points, for drawing."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import applied, dots, norms
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.log import PathPart, Polylines
from gcodesim.motion.tool_path import ARC, Commanded
from gcodesim.shop import Shop
from gcodesim.units import DEG, NS_PER_SECOND

if TYPE_CHECKING:
    from gcodesim.planning import Plan

PATH_PARTS = 100
"""The planned path fades in so many steps of time as it is done."""

_ARC_STEP = 5.0 * DEG
_MOST_ARC_POINTS = 360


@frozen(kw_only=False, eq=False)
class Ways:
    """Points (p, 3) [m] in W of the tip along all rows; row i has those from `starts[i]` to `starts[i + 1]`.

    Where linear axes carry the table it is as if they stood at zero; see `Frames.path_frame`.
    """

    points: Array
    starts: NDArray[np.int64]

    @staticmethod
    def of(plan: Plan, shop: Shop, first: int = 0) -> Ways:
        """The paths of all rows, or of the rows from `first` on."""
        path = plan.path
        start, end, sweep = path.start[first:], path.end[first:], path.sweep[first:]
        count = len(start)
        if not count:
            return Ways(np.zeros((0, 3)), np.zeros(1, dtype=np.int64))
        arc = path.kind[first:] == ARC
        points_of = np.full(count, 2, dtype=np.int64)
        points_of[arc] = np.clip(np.ceil(np.abs(sweep[arc]) / _ARC_STEP) + 1, 3, _MOST_ARC_POINTS)
        starts = np.concatenate([[0], np.cumsum(points_of)])
        row = np.repeat(np.arange(count), points_of)
        u = (np.arange(starts[-1]) - starts[row]) / (points_of[row] - 1)
        points = start[row, :3] + u[:, None] * (end[row, :3] - start[row, :3])
        bent = arc[row]
        if bent.any():
            center, normal = path.center[first:], path.normal[first:]
            points[bent] = _on_arcs(start, end, center, normal, sweep, row[bent], u[bent])
        return Ways(shop.X_WB.apply(points + _shifts(plan, shop, first)[row]), starts)

    def followed_by(self, other: Ways) -> Ways:
        """These paths, then those of further rows."""
        starts = np.concatenate([self.starts, self.starts[-1] + other.starts[1:]])
        return Ways(np.concatenate([self.points, other.points]), starts)

    def polylines(self, rows: NDArray[np.bool_]) -> Polylines:
        """The paths of the rows (n,) that are true, each a line of its own."""
        counts = np.diff(self.starts)
        chosen = np.repeat(rows, counts)
        starts = np.cumsum(counts[rows]) - counts[rows]
        return Polylines(self.points[chosen], starts)

    def ahead(self, plan: Plan, rows: NDArray[np.bool_]) -> tuple[PathPart, ...]:
        """The paths of the rows (n,) that are true, in parts that are done one after another."""
        ends = plan.trajectory.row_end[rows]
        if not len(ends):
            return ()
        lines = self.polylines(rows)
        share = np.minimum((ends / max(float(ends[-1]), 1e-9) * PATH_PARTS).astype(np.int64), PATH_PARTS - 1)
        firsts = np.flatnonzero(np.diff(share, prepend=-1))
        points = np.append(lines.starts, len(lines.points))
        return tuple(
            PathPart(
                lines=Polylines(lines.points[points[a] : points[b]], lines.starts[a:b] - points[a]),
                until_ns=round(float(ends[b - 1]) * NS_PER_SECOND),
            )
            for a, b in pairwise([*firsts.tolist(), len(ends)])
        )


def _on_arcs(start: Array, end: Array, center: Array, normal: Array, sweep: Array, row: Array, u: Array) -> Array:
    """Points (k, 3) at shares `u` (k,) of arcs or helices `row` (k,)."""
    p0, p1, c, n = start[row, :3], end[row, :3], center[row], normal[row]

    def across(v: Array) -> Array:
        left: Array = v - dots(v, n)[:, None] * n
        return left

    r0, r1 = across(p0 - c), across(p1 - c)
    length0, length1 = norms(r0), norms(r1)
    radial = r0 / np.maximum(length0, 1e-12)[:, None]
    angle = u * sweep[row]
    radius = length0 + u * (length1 - length0)
    flat = radius[:, None] * (cos(angle)[:, None] * radial + sin(angle)[:, None] * np.cross(n, radial))
    height0 = dots(p0 - c, n)
    height1 = dots(p1 - c, n)
    points: Array = c + flat + (height0 + u * (height1 - height0))[:, None] * n
    return points


def _shifts(plan: Plan, shop: Shop, first: int) -> Array:
    """From the controlled point to the tip (n, 3) in B, in the middle of every row from `first` on: tool length

    believed and true.

    Where a linear axis carries the table, this is the tip as seen from the table at zero.
    """
    trajectory = plan.trajectory
    middle: Array = 0.5 * (trajectory.row_start[first:] + trajectory.row_end[first:])
    samples = trajectory.sample(middle)
    rows = np.arange(first, first + len(middle))
    q = plan.joints(samples)
    shift: Array = plan.tip(q, rows)[:, :3, 3] - samples.position[:, :3]
    if shop.mover.shifts_work:
        shift -= shop.kinematics.table_travel(q)
    held = np.array([s.control == Commanded.POINT for s in plan.path.states])[plan.path.state[first:]]
    if held.any():  # the tip as seen from the work, in whose frame such rows are
        X_BC, tip = shop.kinematics.table(q[held]), plan.tip(q[held], rows[held])[:, :3, 3]
        seen = applied(X_BC[:, :3, :3].swapaxes(1, 2), tip - X_BC[:, :3, 3])
        shift[held] = seen - samples.position[held, :3]
    return shift
