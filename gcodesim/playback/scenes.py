"""Scenes of a log as shapes and lines again."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import applied
from gcodesim.frozen import frozen
from gcodesim.log import DrawnMesh, DrawnShape, DrawnSolid
from gcodesim.log.shapes import STEEL, Color
from gcodesim.solids import Box, Cone, Cylinder, Sphere

Array = NDArray[np.float64]

_FIXED64, _BYTES, _COORDINATE = 1, 2, 9  # wire types of protobuf; bytes of a double with its key


@frozen(eq=False)
class Lines:
    """Segments (s, 2) of point indices between points (n, 3) [m]; `pixels` wide on a screen."""

    points: Array
    segments: NDArray[np.int64]
    color: Color
    pixels: float


@frozen(eq=False)
class Drawing:
    """One entity of a scene, in its frame."""

    id: str
    frame: str
    shapes: tuple[DrawnShape, ...]
    lines: tuple[Lines, ...]


def drawing_of(update: Any) -> tuple[Drawing, ...]:
    """What a `foxglove.SceneUpdate` shows; it begins by deleting everything."""
    return tuple(
        Drawing(
            id=entity.id,
            frame=entity.frame_id,
            shapes=tuple(_shapes(entity)),
            lines=tuple(_lines(line) for line in entity.lines),
        )
        for entity in update.entities
    )


def _shapes(entity: Any) -> Iterator[DrawnShape]:
    for cube in entity.cubes:
        size = (cube.size.x, cube.size.y, cube.size.z)
        yield DrawnSolid(solid=Box.about_origin(size), **_place(cube))
    for ball in entity.spheres:
        yield DrawnSolid(solid=Sphere(radius=0.5 * ball.size.x), **_place(ball))
    for c in entity.cylinders:
        bottom, top = 0.5 * c.size.x * c.bottom_scale, 0.5 * c.size.x * c.top_scale
        if bottom == top:
            yield DrawnSolid(solid=Cylinder.about_origin(bottom, c.size.z), **_place(c))
        else:
            half = 0.5 * c.size.z
            cone = Cone(bottom_radius=bottom, top_radius=top, bottom=-half, top=half)
            yield DrawnSolid(solid=cone, **_place(c))
    for triangles in entity.triangles:
        if len(triangles.indices):
            indices = np.array(triangles.indices, dtype=np.int64).reshape(-1, 3)
            yield DrawnMesh(points=_points(triangles, "points"), triangles=indices, **_place(triangles))
    for model in entity.models:
        yield from _model(model)


def _model(model: Any) -> Iterator[DrawnShape]:
    """The meshes of an embedded file, such as a GLB."""
    import trimesh

    if not model.data:  # it names a file, which is not in the log
        return
    kind = {"model/gltf-binary": "glb", "model/stl": "stl", "model/obj": "obj"}.get(model.media_type, "glb")
    place = _place(model)
    scale = np.array([model.scale.x, model.scale.y, model.scale.z])
    for mesh in trimesh.load_scene(BytesIO(model.data), file_type=kind).dump():
        if not isinstance(mesh, trimesh.Trimesh):
            continue
        color = place["color"]
        if not model.override_color:
            own = getattr(mesh.visual, "main_color", None)
            own = mesh.visual.material.main_color if own is None and hasattr(mesh.visual, "material") else own
            color = STEEL if own is None else tuple(float(c) / 255.0 for c in own)
        points = np.asarray(mesh.vertices, dtype=float) * np.where(scale == 0.0, 1.0, scale)
        yield DrawnMesh(points=points, triangles=np.asarray(mesh.faces), p=place["p"], q=place["q"], color=color)


def _lines(line: Any) -> Lines:
    from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive

    points = _points(line, "points")
    index = np.array(line.indices, dtype=np.int64) if len(line.indices) else np.arange(len(points))
    if line.type == LinePrimitive.LINE_LIST:
        segments = index[: len(index) // 2 * 2].reshape(-1, 2)
    else:
        segments = np.stack([index[:-1], index[1:]], axis=1)
        if line.type == LinePrimitive.LINE_LOOP and len(index) > 2:
            segments = np.concatenate([segments, [[index[-1], index[0]]]])
    place = _place(line)
    from gcodesim.frames import rotation_from_quaternion

    moved = applied(rotation_from_quaternion(place["q"]), points) + place["p"]
    return Lines(points=moved, segments=segments, color=place["color"], pixels=line.thickness)


def _place(primitive: Any) -> dict[str, Any]:
    pose = primitive.pose
    q = np.array([pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w])
    color = primitive.color
    return {
        "p": np.array([pose.position.x, pose.position.y, pose.position.z]),
        "q": q if q.any() else np.array([0.0, 0.0, 0.0, 1.0]),
        "color": (color.r, color.g, color.b, color.a),
    }


def _points(message: Any, field: str) -> Array:
    """A repeated field of messages x, y, z as (n, 3): taken out of the bytes, as a log holds millions of them.

    Each is a key, a length of one byte, and up to three doubles with a key each; a coordinate that is 0 is left out.
    """
    count = len(getattr(message, field))
    if not count:
        return np.zeros((0, 3))
    key = message.DESCRIPTOR.fields_by_name[field].number << 3 | _BYTES
    data = message.SerializeToString()
    begin, at = [], 0
    while data[at] != key:  # fields are ordered by number, and only short ones come before: kind, pose, thickness
        at += 2 + data[at + 1] if data[at] & 7 == _BYTES else _COORDINATE if data[at] & 7 == _FIXED64 else 2
    for _ in range(count):
        begin.append(at)
        at += 2 + data[at + 1]
    data += bytes(_COORDINATE)
    held = np.frombuffer(data, dtype=np.uint8)
    doubles = np.ndarray(len(data) - 7, dtype="<f8", buffer=data, strides=(1,))  # one that begins at each byte
    place = np.array(begin, dtype=np.int64) + 2
    end = np.append(place[1:] - 2, at)
    points = np.zeros((count, 3))
    for axis in range(3):
        there = np.flatnonzero((place < end) & (held[place] == ((axis + 1) << 3 | _FIXED64)))
        points[there, axis] = doubles[place[there] + 1]
        place[there] += _COORDINATE
    return points
