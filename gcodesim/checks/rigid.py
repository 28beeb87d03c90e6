"""Rigid bodies in the form that the search for meetings needs: convex bodies, in trees of balls around them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import atan2
from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.checks.gap_kernels import Convexes
from gcodesim.checks.meeting_kernels import Forest
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.solids import Box, Hulls, Mesh, Placed, Sphere, Triangles, outline_of

_CONVEX: Final = 1e-9  # of its size a mesh may be dented and still be convex
_MOST_PRODUCTS: Final = 20_000_000  # of faces and points, to find out whether a mesh is convex


@frozen(kw_only=False, eq=False)
class Convex:
    """One convex body: corners (k, 3), or circles (k, 2) of radius and height about the Z of a frame; see `Convexes`.

    `origin` and `axis` (3,) are those of the circles, None for corners. All of it is grown by `grown` [m].
    """

    points: Array
    origin: Array | None = None
    axis: Array | None = None
    grown: float = 0.0

    @property
    def ball(self) -> tuple[Array, float]:
        """Centre (3,) and radius of a ball around it."""
        if self.origin is None or self.axis is None:
            centre = 0.5 * (self.points.min(axis=0) + self.points.max(axis=0))
            return centre, float(norms(self.points - centre).max()) + self.grown
        radius, height = self.points.T
        middle = 0.5 * float(height.min() + height.max())
        size = float(np.sqrt(radius * radius + np.square(height - middle)).max())
        return self.origin + middle * self.axis, size + self.grown


def convexes_of(placed: Placed) -> Iterator[Convex]:
    """A solid as convex bodies, exactly: round ones are round, a dented mesh becomes its triangles."""
    solid, X = placed.solid, placed.X
    match solid:
        case Box(lower=lower, upper=upper):
            yield Convex(X.apply(np.array(list(product(*zip(lower, upper, strict=True))))))
            return
        case Sphere(radius=radius):
            yield Convex(X.p[None].copy(), grown=radius)
            return
        case Hulls(hulls=hulls):
            for hull in hulls:
                yield Convex(X.apply(hull.corners))
            return
        case Mesh():
            points = X.apply(solid.triangles.points)
            if is_convex(solid.triangles):
                yield Convex(points[distinct(solid.triangles.faces)])
            else:
                for corners in points[solid.triangles.faces]:
                    yield Convex(corners)
            return
    outline = outline_of(solid)
    axis = X.rotate(np.array([0.0, 0.0, 1.0]))
    parts = [outline] if _bulges(outline) else [outline[i : i + 2] for i in range(len(outline) - 1)]
    for part in parts:
        yield Convex(part, origin=X.p, axis=axis)


def _bulges(outline: Array) -> bool:
    """Whether a body of revolution by points (k, 2), radius and height from the top down, is convex."""
    steps = np.diff(outline, axis=0)
    if (steps[:, 1] > 0.0).any():
        return False
    turns = steps[1:, 0] * steps[:-1, 1] - steps[1:, 1] * steps[:-1, 0]
    return bool((turns >= -1e-15).all())


def is_closed(mesh: Triangles) -> bool:
    """Whether each edge of a mesh belongs to two triangles, once in each direction; corners at one place are one."""
    _, same = np.unique(mesh.points, axis=0, return_inverse=True)
    faces = same.reshape(-1)[mesh.faces].astype(np.int64)
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
    def convexes(self) -> tuple[Convex, ...]:
        """Its convex bodies, in the frame of its carrier."""
        return tuple(convex for placed in self.solids for convex in convexes_of(placed))

    @cached_property
    def skins(self) -> tuple[Array, ...]:
        """Its closed meshes that are not convex, as corners (t, 3, 3): what is inside touches no triangle."""
        found = []
        for placed in self.solids:
            if isinstance(placed.solid, Mesh) and not is_convex(placed.solid.triangles):
                triangles = placed.solid.triangles
                if is_closed(triangles):
                    found.append(placed.X.apply(triangles.points)[triangles.faces])
        return tuple(found)

    @property
    def insides(self) -> Array:
        """A point (k, 3) of each of its convex bodies."""
        return np.array([_point_of(convex) for convex in self.convexes]).reshape(-1, 3)


def _point_of(convex: Convex) -> Array:
    if convex.origin is None or convex.axis is None:
        point: Array = convex.points.mean(axis=0)
        return point
    middle: Array = convex.origin + float(convex.points[:, 1].mean()) * convex.axis
    return middle


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
        all_of = [convex for body in bodies for convex in body.convexes]
        builder = _Builder([convex.ball for convex in all_of])
        roots, deepest, first = [], 0, 0
        for body in bodies:
            members = np.arange(first, first + len(body.convexes))
            first += len(members)
            roots.append(builder.tree(members))
            deepest = max(deepest, builder.depth)
        forest = builder.forest()
        root = np.array(roots, dtype=np.int64)
        far = norms(forest.centre[root]) + forest.radius[root]
        owner = np.repeat(np.arange(len(bodies)), [len(body.convexes) for body in bodies])
        return Woods(_columns(all_of), forest, root, deepest, far, owner)


class _Builder:
    """Builds trees of balls."""

    def __init__(self, balls: Iterable[tuple[Array, float]]) -> None:
        pairs = list(balls)
        self._at = np.array([at for at, _ in pairs]).reshape(-1, 3)
        self._size = np.array([size for _, size in pairs])
        self._rows: list[tuple[Array, float, int, int, int]] = []
        self.depth = 0

    def tree(self, members: NDArray[np.intp]) -> int:
        """The root of a tree of these convex bodies."""
        self.depth = 0
        return self._node(members, 1)

    def _node(self, members: NDArray[np.intp], depth: int) -> int:
        self.depth = max(self.depth, depth)
        here = len(self._rows)
        at, size = self._at[members], self._size[members]
        if len(members) == 1:
            self._rows.append((at[0], float(size[0]), -1, -1, int(members[0])))
            return here
        low, high = (at - size[:, None]).min(axis=0), (at + size[:, None]).max(axis=0)
        centre = 0.5 * (low + high)
        self._rows.append((centre, float((norms(at - centre) + size).max()), -1, -1, -1))
        order = members[np.argsort(at[:, int(np.argmax(np.ptp(at, axis=0)))], kind="stable")]
        half = len(order) // 2
        left, right = self._node(order[:half], depth + 1), self._node(order[half:], depth + 1)
        self._rows[here] = (*self._rows[here][:2], left, right, -1)
        return here

    def forest(self) -> Forest:
        """All trees."""
        return Forest(
            np.array([row[0] for row in self._rows]).reshape(-1, 3),
            np.array([row[1] for row in self._rows]),
            *(np.array([row[k] for row in self._rows], dtype=np.int64) for k in (2, 3, 4)),
        )


def _columns(convexes: Sequence[Convex]) -> Convexes:
    counts = [len(convex.points) for convex in convexes]
    points = np.zeros((sum(counts), 3))
    first = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    for at, convex in zip(first, convexes, strict=False):
        points[at : at + len(convex.points), : convex.points.shape[1]] = convex.points
    middle = [convex.ball[0] if convex.origin is None else convex.origin for convex in convexes]
    up = np.array([0.0, 0.0, 1.0])
    return Convexes(
        first[:-1].copy(),
        np.array(counts, dtype=np.int64),
        np.array([convex.origin is not None for convex in convexes], dtype=np.int64),
        np.array([convex.grown for convex in convexes]),
        np.array(middle, dtype=float).reshape(-1, 3),
        np.array([up if convex.axis is None else convex.axis for convex in convexes]).reshape(-1, 3),
        points,
    )
