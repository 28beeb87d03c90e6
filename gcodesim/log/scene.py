"""Shapes and lines as `foxglove.SceneUpdate` messages.

The viewer shows after a jump only the last message of each topic. So every
message here is complete: it begins with a deletion of all entities and repeats
what is there. Points are rounded to 2⁻²⁰ m, under a micrometre, which leaves
zero bits that compress.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.log.template import Piece, double_slot, nested, stamp_slot
from gcodesim.log.wire import chunk, double, packed_fixed32, stamp, text, unsigned, vectors

Array = NDArray[np.float64]
Color = tuple[float, float, float, float]

GRID: Final = 2.0**-20
MOST_LINE_POINTS: Final = 100_000  # 29 bytes each and 8 for two indices: below the 4 MB that a viewer should decode
STEEL: Final[Color] = (0.62, 0.64, 0.67, 1.0)
FEED_COLOR: Final[Color] = (0.10, 0.55, 0.85, 0.75)
RAPID_COLOR: Final[Color] = (0.90, 0.45, 0.10, 0.40)
BLOCK_COLOR: Final[Color] = (1.00, 0.85, 0.10, 1.0)
BLOCK_PIXELS: Final = 4.0
FORCE_COLOR: Final[Color] = (0.90, 0.10, 0.15, 1.0)
FORCE_SCALE: Final = 1e-3  # [m/N]

LINE_STRIP, LINE_LIST = 0, 2
_DELETE_ALL: Final = 1
# field numbers of foxglove.SceneEntity
_ARROWS, _CUBES, _SPHERES, _CYLINDERS, _LINES, _TRIANGLES = 7, 8, 9, 10, 11, 12


def _origin() -> Array:
    return np.zeros(3)


def _upright() -> Array:
    return np.array([0.0, 0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shape:
    """A solid at position `p` (3,) [m] with quaternion `q` (4,) x y z w in the frame of its entity."""

    p: Array = field(default_factory=_origin)
    q: Array = field(default_factory=_upright)
    color: Color = STEEL


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Box(Shape):
    """Edge lengths along x, y, z [m], centred."""

    size: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cylinder(Shape):
    """Along z, centred; lengths [m]."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cone(Shape):
    """A frustum along z, centred, with the radius at its lower and upper end; lengths [m]."""

    bottom_radius: float
    top_radius: float
    length: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Capsule(Shape):
    """A cylinder along z of `length` between the centres of two half balls; lengths [m]."""

    radius: float
    length: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sphere(Shape):
    """Centred; radius [m]."""

    radius: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mesh(Shape):
    """Points (n, 3) [m] and triangles (m, 3) of point indices, counter-clockwise seen from outside."""

    points: Array
    triangles: NDArray[np.integer]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Entity:
    """A named group of shapes that stays with its `frame`."""

    id: str
    frame: str
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Polylines:
    """Points (n, 3) [m]; a new line begins at each index of `starts` (k,), the first of which is 0."""

    points: Array
    starts: NDArray[np.integer]

    @staticmethod
    def none() -> Polylines:
        return Polylines(np.zeros((0, 3)), np.zeros(0, dtype=np.int64))

    @staticmethod
    def from_segments(points: Array, drawn: NDArray[np.bool_]) -> Polylines:
        """The segments i → i + 1 of one long line (n, 3) where `drawn` (n - 1,) is true."""
        drawn = np.asarray(drawn, dtype=bool)
        ends = np.concatenate([[False], drawn])
        begins = np.concatenate([drawn, [False]])
        used = begins | ends
        starts = np.flatnonzero((begins & ~ends)[used])
        return Polylines(points[used], starts)

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

    def thinned(self, most: int = MOST_LINE_POINTS) -> Polylines:
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
        jumps[1:] = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        jumps[np.asarray(self.starts, dtype=np.int64)] = 0.0
        return jumps


def rounded(points: Array) -> Array:
    """Points on the grid of 2⁻²⁰ m. ValueError when a number is not finite."""
    points = np.asarray(points, dtype=float)
    if not np.isfinite(points).all():
        raise ValueError("a point to draw is not finite")
    return np.rint(points * (1.0 / GRID)) * GRID + 0.0


@lru_cache(maxsize=256)
def _color(number: int, color: Color) -> bytes:
    return chunk(number, b"".join(double(i + 1, value) for i, value in enumerate(color)))


def _numbers(number: int, values: Iterable[float]) -> bytes:
    """A message of doubles in fields 1, 2, …"""
    return chunk(number, b"".join(double(i + 1, float(value)) for i, value in enumerate(values)))


def _pose(p: Sequence[float] | Array, q: Sequence[float] | Array) -> bytes:
    return chunk(1, _numbers(1, p) + _numbers(2, q))


_IDENTITY: Final = _pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def _shape(shape: Shape) -> bytes:
    """The primitive fields of a SceneEntity that draw `shape`."""
    pose = _pose(shape.p, shape.q)
    match shape:
        case Box(size=size):
            return chunk(_CUBES, pose + _numbers(2, size) + _color(3, shape.color))
        case Sphere(radius=radius):
            return _sphere(pose, radius, shape.color)
        case Cylinder(radius=radius, length=length):
            return _frustum(pose, radius, radius, length, shape.color)
        case Cone(bottom_radius=bottom, top_radius=top, length=length):
            return _frustum(pose, bottom, top, length, shape.color)
        case Capsule(radius=radius, length=length):
            x, y, z, w = (float(c) for c in shape.q)
            half = np.array([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]) * (length / 2)
            balls = (_sphere(_pose(shape.p + side * half, shape.q), radius, shape.color) for side in (-1.0, 1.0))
            return _frustum(pose, radius, radius, length, shape.color) + b"".join(balls)
        case Mesh(points=points, triangles=triangles):
            indices = np.asarray(triangles).reshape(-1)
            if len(indices) and not (indices.min() >= 0 and indices.max() < len(points)):
                raise ValueError("a triangle points outside its mesh")
            body = pose + vectors(2, rounded(points)) + _color(3, shape.color) + packed_fixed32(5, indices)
            return chunk(_TRIANGLES, body)
    raise TypeError(f"no such shape: {type(shape).__name__}")


def _sphere(pose: bytes, radius: float, color: Color) -> bytes:
    return chunk(_SPHERES, pose + _numbers(2, (2 * radius,) * 3) + _color(3, color))


def _frustum(pose: bytes, bottom: float, top: float, length: float, color: Color) -> bytes:
    widest = max(bottom, top)
    scales = (bottom / widest, top / widest) if widest > 0.0 else (0.0, 0.0)
    size = _numbers(2, (2 * widest, 2 * widest, length))
    return chunk(_CYLINDERS, pose + size + double(3, scales[0]) + double(4, scales[1]) + _color(5, color))


def _entity(t_ns: int, id: str, frame: str, primitives: bytes) -> bytes:
    locked = unsigned(5, 1)  # it moves with its frame, not only when a message comes
    return chunk(2, stamp(1, t_ns) + text(2, frame) + text(3, id) + locked + primitives)


def _delete_all(t_ns: int) -> bytes:
    return chunk(1, stamp(1, t_ns) + unsigned(2, _DELETE_ALL))


def entities_update(t_ns: int, entities: Sequence[Entity]) -> bytes:
    """A SceneUpdate that shows `entities` and nothing else. ValueError on an id that comes twice."""
    if len({entity.id for entity in entities}) < len(entities):
        raise ValueError("two entities of one message share an id")
    return _delete_all(t_ns) + b"".join(
        _entity(t_ns, entity.id, entity.frame, b"".join(map(_shape, entity.shapes))) for entity in entities
    )


def _line(kind: int, points: Array, color: Color, pixels: float, segments: NDArray[np.integer] | None = None) -> bytes:
    """A line of constant width on the screen; `segments` index the points of a LINE_LIST."""
    indices = b"" if segments is None else packed_fixed32(8, segments.reshape(-1))
    head = unsigned(1, kind) + _IDENTITY + double(3, pixels) + unsigned(4, 1)
    return chunk(_LINES, head + vectors(5, rounded(points)) + _color(6, color) + indices)


def path_update(t_ns: int, frame: str, feed: Polylines, rapid: Polylines) -> bytes:
    """The whole planned path in `frame`: one line list for feed, one for rapids; very long paths are drawn coarser."""
    rapid = rapid.thinned(max(MOST_LINE_POINTS - len(feed.points), MOST_LINE_POINTS // 4))
    feed = feed.thinned(MOST_LINE_POINTS - len(rapid.points))
    update = _delete_all(t_ns)
    for id, lines, color, pixels in (("feed", feed, FEED_COLOR, 2.0), ("rapid", rapid, RAPID_COLOR, 1.0)):
        if len(lines.points):
            update += _entity(t_ns, id, frame, _line(LINE_LIST, lines.points, color, pixels, lines.segments()))
    return update


def polyline_update(t_ns: int, id: str, frame: str, points: Array, color: Color = BLOCK_COLOR) -> bytes:
    """One polyline (n, 3) in `frame`; nothing is shown of fewer than two points."""
    if len(points) < 2:
        return _delete_all(t_ns)
    return _delete_all(t_ns) + _entity(t_ns, id, frame, _line(LINE_STRIP, points, color, BLOCK_PIXELS))


def block_piece(count: int, frame: str) -> Piece:
    """What `polyline_update` makes for a block of `count` points, with slots for time and `points` (n, 3 count)."""
    points = [nested(5, *(double_slot(k + 1, "points", 3 * i + k) for k in range(3))) for i in range(count)]
    head = Piece(unsigned(1, LINE_STRIP) + _IDENTITY + double(3, BLOCK_PIXELS) + unsigned(4, 1))
    line = nested(_LINES, head, *points, Piece(_color(6, BLOCK_COLOR)))
    deletion = nested(1, stamp_slot(1), Piece(unsigned(2, _DELETE_ALL)))
    names = Piece(text(2, frame) + text(3, "block") + unsigned(5, 1))
    return deletion + nested(2, stamp_slot(1), names, line)


def force_update(t_ns: int, frame: str, tip: Array, force: Array) -> bytes:
    """An arrow from `tip` (3,) [m] along `force` (3,) [N], 1 mm per N; nothing is shown of no force."""
    magnitude = float(np.linalg.norm(force))
    if not np.isfinite(magnitude):
        raise ValueError("a force to draw is not finite")
    if magnitude <= 0.0:
        return _delete_all(t_ns)
    length = magnitude * FORCE_SCALE
    head = min(0.3 * length, 0.015)
    arrow = _pose(rounded(tip), _along_x(force / magnitude)) + double(2, length - head) + double(3, 0.004)
    arrow += double(4, head) + double(5, 0.010) + _color(6, FORCE_COLOR)
    return _delete_all(t_ns) + _entity(t_ns, "force", frame, chunk(_ARROWS, arrow))


def _along_x(direction: Array) -> Array:
    """The quaternion of the shortest turn from +x to a unit vector."""
    x, y, z = (float(c) for c in direction)
    if x < -1.0 + 1e-12:
        return np.array([0.0, 0.0, 1.0, 0.0])
    q = np.array([0.0, -z, y, 1.0 + x])  # (x axis) × direction, and 1 + their cosine
    unit: Array = q / np.linalg.norm(q)
    return unit
