"""Shapes survive the way through a scene message."""

import numpy as np
import pytest

from gcodesim.log import DrawnMesh, DrawnSolid, Entity, Polylines
from gcodesim.log.scene import entities_update, path_update, polyline_update
from gcodesim.log.schema import message_class
from gcodesim.playback import drawing_of
from gcodesim.playback.skins import merged, skin_of
from gcodesim.solids import Box, Cone, Cylinder, Sphere

TURNED = np.array([0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5)])
PLACE = {"p": np.array([0.5, -0.25, 1.0]), "q": TURNED, "color": (0.25, 0.5, 0.75, 1.0)}
SHAPES = (
    DrawnSolid(solid=Box.about_origin((0.5, 0.25, 0.125)), **PLACE),
    DrawnSolid(solid=Cylinder.about_origin(0.125, 0.5), **PLACE),
    DrawnSolid(solid=Cone(bottom_radius=0.25, top_radius=0.125, bottom=-0.25, top=0.25), **PLACE),
    DrawnSolid(solid=Sphere(radius=0.25), **PLACE),
)
TRIANGLE = DrawnMesh(
    points=np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), triangles=np.array([[0, 1, 2]]), **PLACE
)


def decoded(data):
    return drawing_of(message_class("foxglove.SceneUpdate").FromString(data))


@pytest.mark.parametrize("shape", [*SHAPES, TRIANGLE], ids=lambda shape: type(shape).__name__)
def test_a_shape_comes_back(shape):
    (drawing,) = decoded(entities_update(7, [Entity(id="e", frame="arm/link", shapes=(shape,))]))
    (back,) = drawing.shapes

    assert (drawing.id, drawing.frame, type(back)) == ("e", "arm/link", type(shape))
    assert getattr(back, "solid", None) == getattr(shape, "solid", None)
    for field in set(type(shape).__dataclass_fields__) - {"solid"}:
        assert np.allclose(getattr(back, field), getattr(shape, field), atol=1e-6), field


# polygons inscribed in circles, with a wide allowance on the side of the smaller one
@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (SHAPES[0], 0.5 * 0.25 * 0.125),
        (SHAPES[1], np.pi * 0.125**2 * 0.5),
        (SHAPES[2], np.pi * 0.5 / 3 * (0.25**2 + 0.25 * 0.125 + 0.125**2)),
        (SHAPES[3], 4 / 3 * np.pi * 0.25**3),
    ],
)
def test_solids_are_closed_face_outwards_and_have_the_right_size(shape, volume):
    import trimesh

    solid = skin_of(shape)
    mesh = trimesh.Trimesh(solid.points, solid.triangles)

    assert mesh.is_watertight and 0.98 * volume < mesh.volume <= volume * (1 + 1e-9)
    assert np.allclose(mesh.bounds.mean(axis=0), shape.p, atol=1e-3)


def test_a_solid_is_turned_with_its_pose():
    solid = skin_of(SHAPES[0])

    assert np.allclose(np.ptp(solid.points, axis=0), [0.25, 0.5, 0.125])  # x and y have changed places


def test_merged_solids_keep_their_triangles():
    points, triangles = merged([skin_of(TRIANGLE), skin_of(SHAPES[0])])

    assert len(points) == 3 + 8 and triangles[0].tolist() == [0, 1, 2] and triangles[1:].min() == 3
    assert [len(part) for part in merged([])] == [0, 0]


def test_lines_of_a_path_are_segments():
    feed = Polylines(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [5, 5, 0], [6, 5, 0]]), np.array([0, 3]))
    drawings = decoded(path_update(0, "world", feed, Polylines.none()))
    (lines,) = drawings[0].lines

    assert lines.points[lines.segments].tolist() == [
        [[0, 0, 0], [1, 0, 0]],
        [[1, 0, 0], [1, 1, 0]],
        [[5, 5, 0], [6, 5, 0]],
    ]
    (strip,) = decoded(polyline_update(0, "block", "world", feed.points[:3]))[0].lines
    assert strip.segments.tolist() == [[0, 1], [1, 2]]


def test_nothing_shown_is_nothing_drawn():
    assert decoded(polyline_update(0, "block", "world", np.zeros((1, 3)))) == ()


def test_points_are_those_of_the_message_whatever_is_zero():
    from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
    from foxglove_schemas_protobuf.TriangleListPrimitive_pb2 import TriangleListPrimitive

    from gcodesim.playback.scenes import _points

    rng = np.random.default_rng(5)
    for kind in (LinePrimitive, TriangleListPrimitive):
        for n in (0, 1, 7, 200):
            truth = np.where(rng.random((n, 3)) < 0.3, 0.0, rng.normal(size=(n, 3)))
            message = kind(points=[{"x": x, "y": y, "z": z} for x, y, z in truth.tolist()], indices=[0, 2, 1])
            message.color.a = 1.0
            message.pose.position.x = 0.0 if n == 7 else 2.5
            message.pose.orientation.w = 1.0
            if kind is LinePrimitive:
                message.type, message.thickness, message.scale_invariant = LinePrimitive.LINE_LIST, 2.0, True
            assert np.array_equal(_points(message, "points"), truth)
