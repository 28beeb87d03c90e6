"""Rigid bodies in the form that the search for meetings needs: convex bodies, in trees of balls around them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct, row_numbers
from gcodesim.arithmetic.elementary import atan2
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.checks.forest_kernels import Forest
from gcodesim.checks.gap_kernels import Convexes
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Box, Hulls, Mesh, Placed, Sphere, Triangles, outline_of

_CONVEX: Final = 1e-9  # of its size a mesh may be dented and still be convex
_MOST_PRODUCTS: Final = 20_000_000  # of faces and points, to find out whether a mesh is convex


def convexes_of(placed: Placed) -> Convexes:
    """A solid as convex bodies, exactly: round ones are round, a dented mesh becomes its triangles."""
    solid, X = placed.solid, placed.X
    match solid:
        case Box(lower=lower, upper=upper):
            return _hull(X.apply(np.array(list(product(*zip(lower, upper, strict=True))))))
        case Sphere(radius=radius):
            return _hull(X.p[None].copy(), grown=radius)
        case Hulls(hulls=hulls):
            return _joined([_hull(X.apply(hull.corners)) for hull in hulls])
        case Mesh():
            points = X.apply(solid.triangles.points)
            if is_convex(solid.triangles):
                return _hull(points[distinct(solid.triangles.faces)])
            return _hulls(points[solid.triangles.faces])
    outline = outline_of(solid)
    axis = X.rotate(np.array([0.0, 0.0, 1.0]))
    parts = [outline] if _bulges(outline) else [outline[i : i + 2] for i in range(len(outline) - 1)]
    return _joined([_turned(part, X.p, axis) for part in parts])


def _hull(corners: Array, grown: float = 0.0) -> Convexes:
    """The hull of corners (k, 3), grown by a length [m]."""
    return _hulls(corners[None])._replace(grown=np.array([grown]))


def _hulls(corners: Array) -> Convexes:
    """Hulls of corners (n, k, 3) each."""
    n, k = corners.shape[:2]
    return Convexes(
        k * np.arange(n),
        np.full(n, k),
        np.zeros(n, dtype=np.int64),
        np.zeros(n),
        0.5 * (corners.min(axis=1) + corners.max(axis=1)),
        np.tile([0.0, 0.0, 1.0], (n, 1)),
        np.ascontiguousarray(corners.reshape(-1, 3), dtype=float),
    )


def _turned(circles: Array, origin: Array, axis: Array) -> Convexes:
    """A convex body of revolution from circles (k, 2), radius and height along `axis` (3,) from `origin` (3,) on."""
    points = np.zeros((len(circles), 3))
    points[:, :2] = circles
    one, none = np.ones(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
    return Convexes(none, len(circles) * one, one, np.zeros(1), origin[None].copy(), axis[None].copy(), points)


def _joined(parts: Sequence[Convexes]) -> Convexes:
    """Convex bodies one after the other."""
    rows = np.cumsum([0, *(len(part.points) for part in parts)])
    first = [part.first + row for part, row in zip(parts, rows, strict=False)]
    return Convexes(np.concatenate(first), *(np.concatenate(columns) for columns in list(zip(*parts, strict=True))[1:]))


def balls_of(bodies: Convexes) -> tuple[Array, Array]:
    """Centres (k, 3) and radii (k,) of balls around convex bodies."""
    points, first, origin = bodies.points, bodies.first, bodies.origin
    at = np.repeat(np.arange(len(first)), bodies.many)
    flat = norms(points - origin[at])
    height = points[:, 1]
    middle = 0.5 * (np.minimum.reduceat(height, first) + np.maximum.reduceat(height, first))
    turned = np.sqrt(points[:, 0] * points[:, 0] + np.square(height - middle[at]))
    is_round = bodies.round == 1
    radius = np.maximum.reduceat(np.where(is_round[at], turned, flat), first) + bodies.grown
    return np.where(is_round[:, None], origin + middle[:, None] * bodies.axis, origin), radius


def sides_of(bodies: Convexes, centre: Array) -> Array:
    """Half sides (k, 3) of boxes around convex bodies along the axes of their frame, about `centre` (k, 3)."""
    at = np.repeat(np.arange(len(bodies.first)), bodies.many)
    axis, points = bodies.axis[at], bodies.points
    spread = points[:, :1] * np.sqrt(np.maximum(1.0 - axis * axis, 0.0))
    on_axis = np.abs(bodies.origin[at] + points[:, 1:2] * axis - centre[at]) + spread
    away = np.where((bodies.round == 1)[at, None], on_axis, np.abs(points - centre[at]))
    sides: Array = np.maximum.reduceat(away, bodies.first, axis=0) + bodies.grown[:, None]
    return sides


def sizes_of(bodies: Convexes, radius: Array) -> Array:
    """Radius, width and thickness (k, 3) [m] of convex bodies in balls of `radius` (k,): how deep they can be at most.

    Two bodies are parted along any direction by half of what they measure in it, both together. A triangle measures
    nothing across its plane, which is its thickness, and in all directions across its longest edge no more than the
    height over it, which is its width; other bodies no more than their ball.
    """
    sizes = np.column_stack([radius, 2.0 * radius, 2.0 * radius])
    flat = np.flatnonzero((bodies.many == 3) & (bodies.round == 0))
    corners = bodies.points[bodies.first[flat, None] + np.arange(3)]
    edges = np.roll(corners, -1, axis=1) - corners
    longest = norms(edges.reshape(-1, 3)).reshape(-1, 3).max(axis=1, initial=0.0)
    doubled = norms(np.cross(edges[:, 0], edges[:, 1]))
    height = np.divide(doubled, longest, out=np.zeros(len(flat)), where=longest > 0.0)
    grown = 2.0 * bodies.grown[flat]
    sizes[flat, 1], sizes[flat, 2] = height + grown, grown
    return sizes


def bounds_of(bodies: Convexes, X: Pose) -> tuple[Array, Array]:
    """Least and greatest corner of all of some convex bodies whose frame stands at `X`."""
    at = np.repeat(np.arange(len(bodies.first)), bodies.many)
    is_round, grown = (bodies.round == 1)[at], bodies.grown[at, None]
    corners = X.apply(bodies.points[~is_round])
    low, high = [corners - grown[~is_round]], [corners + grown[~is_round]]
    if is_round.any():
        circles, axis = bodies.points[is_round], X.rotate(bodies.axis[at][is_round])
        middle = X.apply(bodies.origin[at][is_round]) + circles[:, 1:2] * axis
        spread = circles[:, :1] * np.sqrt(np.maximum(1.0 - axis * axis, 0.0)) + grown[is_round]
        low.append(middle - spread)
        high.append(middle + spread)
    return np.concatenate(low).min(axis=0), np.concatenate(high).max(axis=0)


def _bulges(outline: Array) -> bool:
    """Whether a body of revolution by points (k, 2), radius and height from the top down, is convex."""
    steps = np.diff(outline, axis=0)
    if (steps[:, 1] > 0.0).any():
        return False
    turns = steps[1:, 0] * steps[:-1, 1] - steps[1:, 1] * steps[:-1, 0]
    return bool((turns >= -1e-15).all())


def is_closed(mesh: Triangles) -> bool:
    """Whether each edge of a mesh belongs to two triangles, once in each direction; corners at one place are one."""
    faces = row_numbers(mesh.points)[mesh.faces]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    key, back = edges[:, 0] * len(mesh.points) + edges[:, 1], edges[:, 1] * len(mesh.points) + edges[:, 0]
    return bool(np.array_equal(np.sort(key), np.sort(back)))


def is_convex(mesh: Triangles) -> bool:
    """Whether a mesh is closed and no point of it lies in front of one of its triangles."""
    points, faces = mesh.points, mesh.faces
    if len(points) * len(faces) > _MOST_PRODUCTS or not is_closed(mesh):
        return False
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = norms(normal)
    real = size > 0.0
    normal = normal[real] / size[real, None]
    off = dots(normal, a[real])
    room = _CONVEX * float(np.ptp(points, axis=0).max())
    return all(bool((dots(n[None], points) <= at + room).all()) for n, at in zip(normal, off, strict=True))


@frozen(slots=False, eq=False)
class RigidBody:
    """A body called `name`, made of `solids` in the frame of joint `carrier` (-1: the base) of a machine."""

    name: str
    solids: tuple[Placed, ...]
    carrier: int = -1

    @cached_property
    def convexes(self) -> Convexes:
        """Its convex bodies, in the frame of its carrier."""
        return _joined([convexes_of(placed) for placed in self.solids])

    @cached_property
    def balls(self) -> tuple[Array, Array]:
        """Centres (k, 3) and radii (k,) of balls around its convex bodies."""
        return balls_of(self.convexes)

    @cached_property
    def sides(self) -> Array:
        """Half sides (k, 3) of boxes about the same centres."""
        return sides_of(self.convexes, self.balls[0])

    @cached_property
    def sizes(self) -> Array:
        """How deep they can be at most (k, 3); see `sizes_of`."""
        return sizes_of(self.convexes, self.balls[1])

    @cached_property
    def dents(self) -> tuple[DentedMesh, ...]:
        """Its meshes that are not convex."""
        return tuple(
            DentedMesh(placed.solid.triangles, placed.X)
            for placed in self.solids
            if isinstance(placed.solid, Mesh) and not is_convex(placed.solid.triangles)
        )

    @cached_property
    def insides(self) -> Array:
        """Points (k, 3) of it, one at least of each piece that hangs together."""
        bodies = self.convexes
        middle = np.add.reduceat(bodies.points, bodies.first, axis=0) / bodies.many[:, None]
        return np.where((bodies.round == 1)[:, None], bodies.origin + middle[:, 1:2] * bodies.axis, middle)


@frozen(slots=False, kw_only=False, eq=False)
class DentedMesh:
    """A mesh that is not convex, with its frame at `X`: what is inside of a closed one touches no triangle."""

    triangles: Triangles
    X: Pose

    @cached_property
    def corners(self) -> Array:
        """Of its triangles (t, 3, 3)."""
        corners: Array = self.X.apply(self.triangles.points)[self.triangles.faces]
        return corners

    @cached_property
    def is_closed(self) -> bool:
        """See `is_closed`; not asked for before a point is near, since that takes a while for millions of triangles."""
        return is_closed(self.triangles)

    @cached_property
    def _box(self) -> tuple[Array, Array]:
        return self.corners.min(axis=(0, 1)), self.corners.max(axis=(0, 1))

    def holds_one_of(self, points: Array) -> bool:
        """Whether one of some points (k, 3) is inside."""
        low, high = self._box
        near = points[np.all((points > low) & (points < high), axis=1)]
        return bool(len(near)) and self.is_closed and bool(is_within(near, self.corners).any())


def is_within(points: Array, skin: Array) -> NDArray[np.bool_]:
    """Which of the points (k, 3) are inside a closed mesh of corners (t, 3, 3).

    By the solid angle under which its triangles are seen (van Oosterom and Strackee 1983, IEEE Trans. Biomedical
    Engineering 30, 125): 4 pi inside, 0 outside.
    """
    low, high = skin.min(axis=(0, 1)), skin.max(axis=(0, 1))
    found: NDArray[np.bool_] = np.all((points > low) & (points < high), axis=1)
    for k in np.flatnonzero(found):
        a, b, c = (skin[:, i] - points[k] for i in range(3))
        la, lb, lc = norms(a), norms(b), norms(c)
        above = dots(a, np.cross(b, c))
        below = la * lb * lc + dots(a, b) * lc + dots(b, c) * la + dots(c, a) * lb
        found[k] = 2.0 * float(np.sum(atan2(above, below))) > 2.0 * math.pi
    return found


@frozen(kw_only=False, eq=False)
class Woods:
    """Convex bodies and trees of several rigid bodies: `root` (b,), the deepest tree, and how far each reaches.

    `far` (b,) [m] is from the frame of the carrier to the farthest point. `body` (k,) is whose each convex body is.
    """

    convexes: Convexes
    forest: Forest
    root: NDArray[np.int64]
    deepest: int
    far: Array
    body: NDArray[np.int64]

    @staticmethod
    def of(bodies: Sequence[RigidBody]) -> Woods:
        """Trees of bodies, each of which has at least one solid."""
        many = np.array([len(body.convexes.first) for body in bodies], dtype=np.int64)
        forest, root = _forest_of(bodies, many)
        far = norms(forest.centre[root]) + forest.radius[root]
        deepest = (int(many.max()) - 1).bit_length() + 1  # halves of halves
        owner = np.repeat(np.arange(len(bodies)), many)
        return Woods(_joined([body.convexes for body in bodies]), forest, root, deepest, far, owner)


def _forest_of(bodies: Sequence[RigidBody], many: NDArray[np.int64]) -> tuple[Forest, NDArray[np.int64]]:
    """A tree over the balls of each body, of which it has `many` (b,), and the root (b,) of each."""
    from gcodesim.checks.forest_kernels import gather, plant

    at, size = (np.concatenate(column) for column in zip(*(body.balls for body in bodies), strict=True))
    sides = np.concatenate([body.sides for body in bodies])
    nodes = int((2 * many - 1).sum())
    left, right, leaves = (np.zeros(nodes, dtype=np.int64) for _ in range(3))
    balls = np.zeros((nodes, 3)), np.zeros(nodes), np.zeros((nodes, 3))
    forest = Forest(*balls, left, right, leaves, np.zeros((nodes, 3)))
    root = np.zeros(len(many), dtype=np.int64)
    plant(at, size, sides, np.ascontiguousarray(at.T), many, forest, root)
    leaf = np.flatnonzero(forest.left < 0)
    forest.most[leaf] = np.concatenate([body.sizes for body in bodies])[forest.convex[leaf]]
    gather(forest)
    return forest, root
