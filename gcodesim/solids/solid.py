"""The solids, each in a frame of its own; a `Placed` one has that frame at `X` of something else. Lengths [m]."""

from __future__ import annotations

from dataclasses import field
from functools import cached_property
from math import pi

import numpy as np

from gcodesim.arithmetic.matrices import dots
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids.hull import Hull
from gcodesim.solids.mesh_file import MeshFile, Triangles

Point = tuple[float, float, float]
Bounds = tuple[Point, Point]


@frozen
class Box:
    """A box between two corners."""

    lower: Point
    upper: Point

    @staticmethod
    def about_origin(size: Point) -> Box:
        """A box of edge lengths `size` with its middle at the origin."""
        x, y, z = (0.5 * side for side in size)
        return Box(lower=(-x, -y, -z), upper=(x, y, z))

    @property
    def size(self) -> Point:
        return (self.upper[0] - self.lower[0], self.upper[1] - self.lower[1], self.upper[2] - self.lower[2])

    @property
    def middle(self) -> Array:
        """(3,)"""
        middle: Array = 0.5 * (np.array(self.lower) + np.array(self.upper))
        return middle

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        return self.lower, self.upper

    @property
    def volume(self) -> float:
        """[m³]"""
        x, y, z = self.size
        return x * y * z


@frozen
class Cylinder:
    """A cylinder about Z, from height `bottom` to `top`."""

    radius: float
    bottom: float
    top: float

    @staticmethod
    def about_origin(radius: float, length: float) -> Cylinder:
        """A cylinder with its middle at the origin."""
        return Cylinder(radius=radius, bottom=-0.5 * length, top=0.5 * length)

    @property
    def length(self) -> float:
        return self.top - self.bottom

    @property
    def middle(self) -> Array:
        """(3,)"""
        return np.array([0.0, 0.0, 0.5 * (self.bottom + self.top)])

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        r = self.radius
        return (-r, -r, self.bottom), (r, r, self.top)

    @property
    def volume(self) -> float:
        """[m³]"""
        return _frustum(self.radius, self.radius, self.length)


@frozen
class Cone:
    """A frustum about Z, from height `bottom` to `top`, with a radius at either end."""

    bottom_radius: float
    top_radius: float
    bottom: float
    top: float

    @property
    def length(self) -> float:
        return self.top - self.bottom

    @property
    def middle(self) -> Array:
        """Half-way between the ends (3,); the centre of mass lies nearer to the wide one."""
        return np.array([0.0, 0.0, 0.5 * (self.bottom + self.top)])

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        r = max(self.bottom_radius, self.top_radius)
        return (-r, -r, self.bottom), (r, r, self.top)

    @property
    def volume(self) -> float:
        """[m³]"""
        return _frustum(self.top_radius, self.bottom_radius, self.length)


@frozen
class Sphere:
    """A ball about the origin."""

    radius: float

    @property
    def middle(self) -> Array:
        """(3,)"""
        return np.zeros(3)

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        r = self.radius
        return (-r, -r, -r), (r, r, r)

    @property
    def volume(self) -> float:
        """[m³]"""
        return 4.0 / 3.0 * pi * (self.radius * self.radius * self.radius)


@frozen
class Revolution:
    """A body of revolution about Z: straight lines between points (radius, height), from the top down."""

    outline: tuple[tuple[float, float], ...]

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        r = max(radius for radius, _ in self.outline)
        heights = [height for _, height in self.outline]
        return (-r, -r, min(heights)), (r, r, max(heights))

    @property
    def volume(self) -> float:
        """[m³]"""
        pieces = zip(self.outline[:-1], self.outline[1:], strict=True)
        return sum(_frustum(a, b, above - below) for (a, above), (b, below) in pieces)


@frozen(slots=False)
class Mesh:
    """Triangles, either given or from a file that is read when somebody asks for them."""

    source: MeshFile | Triangles

    @staticmethod
    def of(points: Array, faces: Array) -> Mesh:
        """Triangles `faces` (t, 3), counter-clockwise seen from outside, over `points` (v, 3)."""
        return Mesh(source=Triangles(points=np.asarray(points, dtype=float), faces=np.asarray(faces, dtype=np.int32)))

    @cached_property
    def triangles(self) -> Triangles:
        """ValueError when the file cannot be read."""
        return self.source if isinstance(self.source, Triangles) else self.source.read()

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        points = self.triangles.points
        (x, y, z), (u, v, w) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        return (x, y, z), (u, v, w)

    @property
    def volume(self) -> float:
        """[m³] of a closed mesh."""
        a, b, c = (self.triangles.points[self.triangles.faces[:, k]] for k in range(3))
        return float(dots(a, np.cross(b, c)).sum() / 6.0)


@frozen
class Hulls:
    """Convex bodies that represent one solid."""

    hulls: tuple[Hull, ...]

    @property
    def bounds(self) -> Bounds:
        """Least and greatest corner."""
        corners = np.concatenate([hull.corners for hull in self.hulls])
        (x, y, z), (u, v, w) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return (x, y, z), (u, v, w)


Solid = Box | Cylinder | Cone | Sphere | Revolution | Mesh | Hulls


@frozen(kw_only=False, eq=False)
class Placed:
    """A solid whose frame stands at `X` of a body."""

    solid: Solid
    X: Pose = field(default_factory=Pose.identity)

    def at(self, X: Pose) -> Placed:
        """The same solid seen from something else, in which its body stands at `X`."""
        return Placed(self.solid, X @ self.X)

    @property
    def X_middle(self) -> Pose:
        """The middle of a simple solid, with the axes of its frame."""
        assert isinstance(self.solid, Box | Cylinder | Cone | Sphere)
        middle = self.solid.middle
        return Pose(self.X.apply(middle), self.X.R) if middle.any() else self.X


def _frustum(a: float, b: float, length: float) -> float:
    """Volume [m³] between circles of radius `a` and `b`."""
    return pi * length * (a * a + a * b + b * b) / 3.0
