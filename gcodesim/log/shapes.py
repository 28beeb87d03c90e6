"""What can be drawn: solids of simple shape, meshes, and lines."""

from __future__ import annotations

from dataclasses import field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.log.mesh_kernels import number_used, take_used
from gcodesim.solids import Box, Cone, Cylinder, Sphere

Array = NDArray[np.float64]
Color = tuple[float, float, float, float]

STEEL: Final[Color] = (0.62, 0.64, 0.67, 1.0)


def _origin() -> Array:
    return np.zeros(3)


def _upright() -> Array:
    return np.array([0.0, 0.0, 0.0, 1.0])


@frozen(eq=False)
class DrawnSolid:
    """A simple solid, its middle at `p` (3,) [m] with quaternion `q` (4,) x y z w in the frame of its entity."""

    solid: Box | Cylinder | Cone | Sphere
    p: Array = field(default_factory=_origin)
    q: Array = field(default_factory=_upright)
    color: Color = STEEL


@frozen(eq=False)
class DrawnMesh:
    """Points (n, 3) [m] and triangles (m, 3) of point indices, counter-clockwise seen from outside, placed likewise.

    A `tight` mesh is known to have no point that no triangle uses, and no triangle that points outside.
    """

    points: Array
    triangles: NDArray[np.integer]
    tight: bool = False
    p: Array = field(default_factory=_origin)
    q: Array = field(default_factory=_upright)
    color: Color = STEEL

    def compact(self) -> DrawnMesh:
        """The same without points that no triangle uses, such as those of a tile's other mesh, if they are many.

        ValueError when a triangle points outside.
        """
        if self.tight:
            return self
        triangles = np.require(self.triangles, np.int32, ["C", "W"]).reshape(-1, 3)
        number = np.empty(len(self.points), dtype=np.int32)
        used = number_used(triangles, number)
        if used < 0:
            raise ValueError("a triangle points outside its mesh")
        if used > 0.9 * len(number):
            return self
        kept, renumbered = np.empty((used, 3)), np.empty_like(triangles)
        take_used(np.require(self.points, np.float64, ["C", "W"]), triangles, number, kept, renumbered)
        return replace(self, points=kept, triangles=renumbered)

    def coarser(self, size: float) -> DrawnMesh:
        """Points in one cube of edge `size` [m] become one; triangles that collapse are left out."""
        cell = np.floor((self.points - self.points.min(axis=0)) / size).astype(np.int64)
        sides = cell.max(axis=0) + 1
        key = (cell[:, 0] * sides[1] + cell[:, 1]) * sides[2] + cell[:, 2]
        _, first, group = np.unique(key, return_index=True, return_inverse=True)
        triangles = group.reshape(-1)[self.triangles]
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (c != a)]
        return replace(self, points=self.points[first], triangles=triangles, tight=False).compact()


DrawnShape = DrawnSolid | DrawnMesh


@frozen(eq=False)
class Entity:
    """A named group of shapes that moves with its `frame`."""

    id: str
    frame: str
    shapes: tuple[DrawnShape, ...]


@frozen(kw_only=False, eq=False)
class Polylines:
    """Points (n, 3) [m]; a new line begins at each index of `starts` (k,), the first of which is 0."""

    points: Array
    starts: NDArray[np.integer]

    @staticmethod
    def none() -> Polylines:
        return Polylines(np.zeros((0, 3)), np.zeros(0, dtype=np.int64))

    def segments(self) -> NDArray[np.int64]:
        """Index pairs (m, 2) of the segments."""
        last = np.zeros(len(self.points), dtype=bool)
        if len(self.points):
            last[-1] = True
            last[np.asarray(self.starts[1:], dtype=np.int64) - 1] = True
        first = np.flatnonzero(~last)
        return np.stack([first, first + 1], axis=1)

    def longest(self, most: int) -> Polylines:
        """The `most` longest lines, in their order."""
        borders = np.append(np.asarray(self.starts, dtype=np.int64), len(self.points))
        if len(borders) - 1 <= most:
            return self
        length = np.add.reduceat(self._jumps(), borders[:-1])
        chosen = np.sort(np.argsort(-length, kind="stable")[:most])
        kept = np.concatenate([np.arange(borders[i], borders[i + 1]) for i in chosen])
        counts = borders[chosen + 1] - borders[chosen]
        return Polylines(self.points[kept], np.cumsum(counts) - counts)

    def thinned(self, most: int) -> Polylines:
        """At most `most` points: the ends of lines stay, between them one point for each step of path length.

        When ends alone would take more than half of them, short lines are left out.
        """
        if len(self.points) <= most:
            return self
        lines = self.longest(max(most // 4, 1))
        is_start = np.zeros(len(lines.points), dtype=bool)
        is_start[lines.starts] = True
        ends = is_start | np.roll(is_start, -1)  # the point before a start is an end, and so is the last of all
        way = np.cumsum(lines._jumps())
        room = max(most - int(ends.sum()) - 1, 1)
        bucket = np.floor(way * (room / way[-1])) if way[-1] > 0.0 else np.zeros(len(way))
        kept = ends | (np.diff(bucket, prepend=0.0) > 0.0)
        return Polylines(lines.points[kept], np.flatnonzero(is_start[kept]))

    def _jumps(self) -> Array:
        """Distance (n,) from the point before; 0 where a line begins."""
        jumps = np.zeros(len(self.points))
        jumps[1:] = norms(np.diff(self.points, axis=0))
        jumps[np.asarray(self.starts, dtype=np.int64)] = 0.0
        return jumps


@frozen(eq=False)
class DrawnLine:
    """A line through points (n, 3) [m] of the world that somebody draws; `id` is its own."""

    id: str
    points: Array
    color: Color


@frozen(eq=False)
class PathPart:
    """Lines of the planned path that lie ahead until a time [ns]."""

    lines: Polylines
    until_ns: int
