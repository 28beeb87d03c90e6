"""Shapes and lines as `foxglove.SceneUpdate` messages.

After a jump, the viewer shows only the last message of each topic. So every
message here is complete: it begins with a deletion of all entities and repeats
everything that is there. Points are rounded to 2⁻²⁰ m, less than a micrometre, which leaves
zero bits that compress.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.log.byte_strings import ByteStrings
from gcodesim.log.mesh_kernels import put_points, round_points
from gcodesim.log.shapes import Array, Color, DrawnLine, DrawnMesh, DrawnShape, Entity, PathPart, Polylines
from gcodesim.log.template import Template, TemplatePiece, double_slot, nested, stamp_slot
from gcodesim.log.wire import BYTES, Part, chunk, double, doubles, packed_fixed32, stamp, tag, text, unsigned, wrap
from gcodesim.solids import Box, Cone, Cylinder, Sphere

GRID: Final = 2.0**-20
POINT_BYTES: Final = 29  # of a point in a repeated field
MOST_LINE_POINTS: Final = 100_000  # 29 bytes each and 8 for two indices: below the 4 MB that a viewer should decode
FEED_COLOR: Final[Color] = (0.10, 0.55, 0.85, 0.75)
DONE_COLOR: Final[Color] = (0.10, 0.45, 0.70, 0.15)
"""Of feeds that are done: a densely machined part stays visible."""
RAPID_COLOR: Final[Color] = (0.90, 0.45, 0.10, 0.40)
BLOCK_COLOR: Final[Color] = (1.00, 0.85, 0.10, 1.0)
BLOCK_PIXELS: Final = 4.0
FORCE_COLOR: Final[Color] = (0.90, 0.10, 0.15, 1.0)
FORCE_SCALE: Final = 1e-3  # [m/N]

MOST_MESSAGE_BYTES: Final = 4 << 20  # a viewer decodes whole messages
FINEST_PART: Final = 1024.0  # of a mesh's extent: where coarser drawing begins

LINE_STRIP, LINE_LIST = 0, 2
_DELETE_ALL: Final = 1
# field numbers of foxglove.SceneEntity
_ARROWS, _CUBES, _SPHERES, _CYLINDERS, _LINES, _TRIANGLES = 7, 8, 9, 10, 11, 12


def rounded(points: Array) -> Array:
    """Points on the grid of 2⁻²⁰ m. ValueError when a number is not finite."""
    steps: Array = np.asarray(points, dtype=float) * (1.0 / GRID)
    if not np.isfinite(steps).all():
        raise ValueError("a point to draw is not finite")
    np.rint(steps, out=steps)
    steps *= GRID
    steps += 0.0  # turns -0.0 into 0.0
    return steps


def _points(number: int, points: Array) -> memoryview:
    """A repeated field of points (n, 3) on the grid of 2⁻²⁰ m. ValueError when a number is not finite."""
    steps = np.empty((len(points), 3))
    if not round_points(np.require(points, np.float64, ["C", "W"]), GRID, steps):
        raise ValueError("a point to draw is not finite")
    data = np.empty(POINT_BYTES * len(points), dtype=np.uint8)
    put_points(steps.view(np.uint8), tag(number, BYTES)[0], data)
    return data.data


@lru_cache(maxsize=256)
def _color(number: int, color: Color) -> bytes:
    return chunk(number, doubles(*color))


def _numbers(number: int, values: Iterable[float]) -> bytes:
    """A message of doubles in fields 1, 2, …"""
    return chunk(number, doubles(*values))


def _pose(p: Sequence[float] | Array, q: Sequence[float] | Array) -> bytes:
    return chunk(1, _numbers(1, p) + _numbers(2, q))


_IDENTITY: Final = _pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def _shape(shape: DrawnShape) -> list[Part]:
    """The primitive fields of a SceneEntity that draw `shape`, in parts: a mesh is copied no more than it has to be."""
    pose = _pose(shape.p, shape.q)
    if isinstance(shape, DrawnMesh):
        indices = packed_fixed32(5, shape.triangles.reshape(-1))
        return wrap(_TRIANGLES, [pose, _points(2, shape.points), _color(3, shape.color), *indices])
    match shape.solid:
        case Box(size=size):
            return [chunk(_CUBES, pose + _numbers(2, size) + _color(3, shape.color))]
        case Sphere(radius=radius):
            return [_sphere(pose, radius, shape.color)]
        case Cylinder(radius=radius, length=length):
            return [_frustum(pose, radius, radius, length, shape.color)]
        case Cone(bottom_radius=bottom, top_radius=top, length=length):
            return [_frustum(pose, bottom, top, length, shape.color)]


def _sphere(pose: bytes, radius: float, color: Color) -> bytes:
    return chunk(_SPHERES, pose + _numbers(2, (2 * radius,) * 3) + _color(3, color))


def _frustum(pose: bytes, bottom: float, top: float, length: float, color: Color) -> bytes:
    widest = max(bottom, top)
    scales = (bottom / widest, top / widest) if widest > 0.0 else (0.0, 0.0)
    size = _numbers(2, (2 * widest, 2 * widest, length))
    return chunk(_CYLINDERS, pose + size + double(3, scales[0]) + double(4, scales[1]) + _color(5, color))


def _entity(t_ns: int, id: str, frame: str, primitives: Sequence[Part], lifetime_ns: int = 0) -> list[Part]:
    """An entity that the viewer takes away after a lifetime, if it has one."""
    locked = unsigned(5, 1)  # it moves with its frame, not only when a message arrives
    lifetime = stamp(4, lifetime_ns) if lifetime_ns else b""  # a Duration is written like a Timestamp
    return wrap(2, (stamp(1, t_ns) + text(2, frame) + text(3, id) + lifetime + locked, *primitives))


def _delete_all(t_ns: int) -> bytes:
    return chunk(1, stamp(1, t_ns) + unsigned(2, _DELETE_ALL))


def entities_update(t_ns: int, entities: Sequence[Entity]) -> bytes:
    """A SceneUpdate that shows `entities` and nothing else; above 4 MB its meshes are drawn coarser.

    ValueError on an id that comes twice, on a triangle outside its mesh and
    when the entities take more than 4 MB without their meshes.
    """
    if len({entity.id for entity in entities}) < len(entities):
        raise ValueError("two entities of one message share an id")
    drawn = [replace(entity, shapes=tuple(map(_compact, entity.shapes))) for entity in entities]
    update = _entities(t_ns, drawn)
    if len(update) <= MOST_MESSAGE_BYTES:
        return update
    size = max(_extent(shape) for entity in entities for shape in entity.shapes) / FINEST_PART
    for _ in range(12):
        drawn = [replace(entity, shapes=tuple(_coarser(shape, size) for shape in entity.shapes)) for entity in drawn]
        update = _entities(t_ns, drawn)
        if len(update) <= MOST_MESSAGE_BYTES:
            return update
        size *= 2.0
    raise ValueError(f"a scene takes {len(update)} bytes; {MOST_MESSAGE_BYTES} are possible")


def _compact(shape: DrawnShape) -> DrawnShape:
    return shape.compact() if isinstance(shape, DrawnMesh) else shape


def _coarser(shape: DrawnShape, size: float) -> DrawnShape:
    return shape.coarser(size) if isinstance(shape, DrawnMesh) and len(shape.points) else shape


def _extent(shape: DrawnShape) -> float:
    """The longest side of a mesh [m]."""
    return float(np.ptp(shape.points, axis=0).max()) if isinstance(shape, DrawnMesh) and len(shape.points) else 0.0


def _entities(t_ns: int, entities: Sequence[Entity]) -> bytes:
    parts: list[Part] = [_delete_all(t_ns)]
    for entity in entities:
        parts += _entity(t_ns, entity.id, entity.frame, [part for shape in entity.shapes for part in _shape(shape)])
    return b"".join(parts)


def _line(kind: int, points: Array, color: Color, pixels: float, segments: NDArray[np.integer] | None = None) -> bytes:
    """A line of constant width on the screen; `segments` index the points of a LINE_LIST."""
    indices = [] if segments is None else packed_fixed32(8, segments.reshape(-1))
    head = unsigned(1, kind) + _IDENTITY + double(3, pixels) + unsigned(4, 1)
    return b"".join(wrap(_LINES, [head, _points(5, points), _color(6, color), *indices]))


def path_update(t_ns: int, frame: str, feed: Polylines, rapid: Polylines, ahead: Sequence[PathPart] = ()) -> bytes:
    """The whole planned path in `frame`: one line list for feed, one for rapids; very long paths are drawn coarser.

    `ahead` are the feeds once more in parts. Each is drawn strongly until its time has come, then the viewer takes it
    away, and what is left is faint.
    """
    most = MOST_LINE_POINTS // 2 if ahead else MOST_LINE_POINTS
    rapid = rapid.thinned(max(most - len(feed.points), most // 4))
    feed = feed.thinned(most - len(rapid.points))
    look = (DONE_COLOR, 1.0) if ahead else (FEED_COLOR, 2.0)
    drawn = [("feed", feed, *look, 0), ("rapid", rapid, RAPID_COLOR, 1.0, 0)]
    count = sum(len(part.lines.points) for part in ahead)
    for number, part in enumerate(ahead):
        if part.until_ns <= t_ns:
            continue
        lines = part.lines.thinned(max(most * len(part.lines.points) // max(count, 1), 2))
        drawn.append((f"ahead {number}", lines, FEED_COLOR, 2.0, part.until_ns - t_ns))
    parts: list[Part] = [_delete_all(t_ns)]
    for id, lines, color, pixels, lifetime_ns in drawn:
        if len(lines.points):
            line = _line(LINE_LIST, lines.points, color, pixels, lines.segments())
            parts += _entity(t_ns, id, frame, [line], lifetime_ns)
    return b"".join(parts)


def polyline_update(t_ns: int, id: str, frame: str, points: Array, color: Color = BLOCK_COLOR) -> bytes:
    """One polyline (n, 3) in `frame`; nothing is shown of fewer than two points."""
    if len(points) < 2:
        return _delete_all(t_ns)
    line = _line(LINE_STRIP, points, color, BLOCK_PIXELS)
    return b"".join([_delete_all(t_ns), *_entity(t_ns, id, frame, [line])])


def lines_update(t_ns: int, lines: Sequence[DrawnLine]) -> bytes:
    """All lines in the world, and nothing else; long ones are drawn coarser."""
    parts: list[Part] = [_delete_all(t_ns)]
    most = MOST_LINE_POINTS // max(len(lines), 1)
    for line in lines:
        points = line.points[:: -(-len(line.points) // most)] if len(line.points) > most else line.points
        parts += _entity(t_ns, line.id, "world", [_line(LINE_STRIP, points, line.color, BLOCK_PIXELS)])
    return b"".join(parts)


def block_piece(count: int, frame: str) -> TemplatePiece:
    """What `polyline_update` makes for a block of `count` points, with slots for time and `points` (n, 3 count)."""
    points = [nested(5, *(double_slot(k + 1, "points", 3 * i + k) for k in range(3))) for i in range(count)]
    head = TemplatePiece(unsigned(1, LINE_STRIP) + _IDENTITY + double(3, BLOCK_PIXELS) + unsigned(4, 1))
    line = nested(_LINES, head, *points, TemplatePiece(_color(6, BLOCK_COLOR)))
    deletion = nested(1, stamp_slot(1), TemplatePiece(unsigned(2, _DELETE_ALL)))
    names = TemplatePiece(text(2, frame) + text(3, "block") + unsigned(5, 1))
    return deletion + nested(2, stamp_slot(1), names, line)


def force_updates(t_ns: NDArray[np.int64], frame: str, tip: Array, force: Array) -> ByteStrings:
    """Arrows from `tip` (n, 3) [m] along `force` (n, 3) [N], 1 mm per N, at n times; nothing is shown of no force."""
    magnitude = norms(force)
    if not np.isfinite(magnitude).all():
        raise ValueError("a force to draw is not finite")
    shown = np.flatnonzero(magnitude > 0.0)
    length = magnitude[shown, None] * FORCE_SCALE
    head = np.minimum(0.3 * length, 0.015)
    pose = np.concatenate([rounded(tip[shown]), _along_x(force[shown] / magnitude[shown, None])], axis=1)
    arrows = _arrow_template(frame).fill(t_ns[shown], np.concatenate([pose, length - head, head], axis=1))
    bare = np.flatnonzero(magnitude <= 0.0)
    none = ByteStrings.of(_delete_all(t) for t in t_ns[bare].tolist())
    return ByteStrings.mixed([(shown, ByteStrings.rows(arrows)), (bare, none)])


@lru_cache(maxsize=16)
def _arrow_template(frame: str) -> Template:
    """A SceneUpdate that shows one arrow, with slots for time, `pose` (n, 7), length of `shaft` and `head` (n, 1)."""
    place = nested(1, *(double_slot(k + 1, "pose", k) for k in range(3)))
    turn = nested(2, *(double_slot(k + 1, "pose", 3 + k) for k in range(4)))
    shaft, head = double_slot(2, "shaft"), double_slot(4, "head")
    thick, broad = TemplatePiece(double(3, 0.004)), TemplatePiece(double(5, 0.010) + _color(6, FORCE_COLOR))
    arrow = nested(_ARROWS, nested(1, place, turn), shaft, thick, head, broad)
    deletion = nested(1, stamp_slot(1), TemplatePiece(unsigned(2, _DELETE_ALL)))
    names = TemplatePiece(text(2, frame) + text(3, "force") + unsigned(5, 1))
    return Template(deletion + nested(2, stamp_slot(1), names, arrow))


def _along_x(direction: Array) -> Array:
    """Quaternions (n, 4) of the shortest turns from +x to unit vectors (n, 3)."""
    x, y, z = direction.T
    q = np.stack([np.zeros_like(x), -z, y, 1.0 + x], axis=1)  # (x axis) × direction, and 1 + their cosine
    q[x < -1.0 + 1e-12] = (0.0, 0.0, 1.0, 0.0)
    unit: Array = q / norms(q)[:, None]
    return unit
