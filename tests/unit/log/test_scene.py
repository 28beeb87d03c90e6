"""Scene messages, read back with the viewer's own message classes."""

import numpy as np
import pytest
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from gcodesim.frames import rotation_from_quaternion
from gcodesim.log import DrawnMesh, DrawnSolid, Entity, PathPart, Polylines
from gcodesim.log.scene import GRID, entities_update, force_updates, path_update, polyline_update, rounded
from gcodesim.solids import Box, Cone, Cylinder, Sphere

T = 3_000_000_007
Q = np.array([0.5, -0.5, 0.5, 0.5])
P = np.array([0.1, 0.2, 0.3])


def read(data):
    return SceneUpdate.FromString(data)


def xyz(v):
    return [v.x, v.y, v.z]


def only(shape):
    (entity,) = read(entities_update(T, [Entity(id="a", frame="tool", shapes=(shape,))])).entities
    return entity


def test_an_update_replaces_all_that_was_there():
    update = read(entities_update(T, [Entity(id="a", frame="tool", shapes=(DrawnSolid(solid=Sphere(radius=1.0)),))]))

    assert [d.type for d in update.deletions] == [SceneEntityDeletion.ALL]
    (entity,) = update.entities
    assert (entity.id, entity.frame_id, entity.frame_locked) == ("a", "tool", True)
    assert entity.timestamp.seconds * 10**9 + entity.timestamp.nanos == T
    assert not read(entities_update(T, [])).entities


def test_a_box_has_its_pose_size_and_colour():
    (cube,) = only(DrawnSolid(solid=Box.about_origin((1.0, 2.0, 3.0)), p=P, q=Q, color=(0.1, 0.2, 0.3, 0.4))).cubes

    assert xyz(cube.size) == [1.0, 2.0, 3.0] and xyz(cube.pose.position) == [0.1, 0.2, 0.3]
    q = cube.pose.orientation
    assert [q.x, q.y, q.z, q.w] == Q.tolist()
    assert [cube.color.r, cube.color.g, cube.color.b, cube.color.a] == [0.1, 0.2, 0.3, 0.4]


def test_cylinder_and_cone_are_frusta_of_the_widest_radius():
    (cylinder,) = only(DrawnSolid(solid=Cylinder.about_origin(0.5, 2.0))).cylinders
    frustum = Cone(bottom_radius=0.25, top_radius=1.0, bottom=-1.0, top=1.0)
    (cone,) = only(DrawnSolid(solid=frustum)).cylinders

    assert (xyz(cylinder.size), cylinder.bottom_scale, cylinder.top_scale) == ([1.0, 1.0, 2.0], 1.0, 1.0)
    assert (xyz(cone.size), cone.bottom_scale, cone.top_scale) == ([2.0, 2.0, 2.0], 0.25, 1.0)
    assert cylinder.pose.HasField("position") and cylinder.pose.orientation.w == 1.0


def corners(mesh):
    """Triangle corners (m, 3, 3) as the viewer draws them."""
    points = np.array([xyz(p) for p in mesh.points])
    return points[np.array(mesh.indices).reshape(-1, 3)]


def test_a_mesh_keeps_its_triangles_within_half_a_grid_step():
    points = np.random.default_rng(5).normal(size=(20, 3))
    triangles = np.random.default_rng(6).integers(0, 20, (30, 3))
    (mesh,) = only(DrawnMesh(points=points, triangles=triangles)).triangles

    drawn = corners(mesh)
    assert np.abs(drawn - points[triangles]).max() <= GRID / 2
    assert (drawn / GRID == np.rint(drawn / GRID)).all()


def test_points_that_no_triangle_uses_are_not_sent():
    points = np.random.default_rng(5).normal(size=(100, 3))
    triangles = np.array([[5, 90, 17], [17, 90, 3]])
    (mesh,) = only(DrawnMesh(points=points, triangles=triangles)).triangles

    assert len(mesh.points) == 4
    assert np.abs(corners(mesh) - points[triangles]).max() <= GRID / 2


def test_a_mesh_too_large_for_a_message_is_drawn_coarser():
    """A ball of 800,000 triangles would take 21 MB."""
    n = 632
    u, v = np.meshgrid(np.linspace(0.02, np.pi - 0.02, n), np.linspace(0, 2 * np.pi, n), indexing="ij")
    points = np.stack([np.sin(u) * np.cos(v), np.sin(u) * np.sin(v), np.cos(u)], axis=-1).reshape(-1, 3)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).reshape(-1)
    triangles = np.concatenate([np.stack([i, i + n, i + 1], 1), np.stack([i + 1, i + n, i + n + 1], 1)])
    box = DrawnSolid(solid=Box.about_origin((1.0, 1.0, 1.0)))
    ball = DrawnMesh(points=points, triangles=triangles)
    data = entities_update(T, [Entity(id="a", frame="tool", shapes=(ball, box))])

    assert 1 << 19 < len(data) < 4 << 20
    (entity,) = read(data).entities
    drawn = corners(entity.triangles[0])
    assert np.allclose(np.linalg.norm(drawn, axis=2), 1.0, atol=1e-5)  # its points are still on the ball
    area = 0.5 * np.linalg.norm(np.cross(drawn[:, 1] - drawn[:, 0], drawn[:, 2] - drawn[:, 0]), axis=1).sum()
    assert area == pytest.approx(4 * np.pi * np.cos(0.02), rel=0.02)
    assert len(entity.cubes) == 1


def test_what_cannot_be_drawn_is_refused():
    with pytest.raises(ValueError, match="outside its mesh"):
        only(DrawnMesh(points=np.zeros((2, 3)), triangles=np.array([[0, 1, 2]])))
    with pytest.raises(ValueError, match="not finite"):
        rounded(np.array([[0.0, np.nan, 0.0]]))
    twice = [Entity(id="a", frame="tool", shapes=())] * 2
    with pytest.raises(ValueError, match="share an id"):
        entities_update(T, twice)


def test_a_path_is_one_list_of_lines_for_feed_and_one_for_rapids():
    feed = Polylines(np.arange(15.0).reshape(5, 3), np.array([0, 3]))
    rapid = Polylines(np.zeros((2, 3)), np.array([0]))
    update = read(path_update(0, "world", feed, rapid))

    assert [e.id for e in update.entities] == ["feed", "rapid"]
    line = update.entities[0].lines[0]
    assert line.type == LinePrimitive.LINE_LIST and line.scale_invariant
    assert list(line.indices) == [0, 1, 1, 2, 3, 4]
    assert [xyz(p) for p in line.points] == feed.points.tolist()
    assert not read(path_update(0, "world", Polylines.none(), Polylines.none())).entities


def test_what_is_ahead_is_drawn_strongly_until_its_time_has_come():
    first = Polylines(np.arange(6.0).reshape(2, 3), np.array([0]))
    second = Polylines(np.arange(6.0, 15.0).reshape(3, 3), np.array([0]))
    feed = Polylines(np.arange(15.0).reshape(5, 3), np.array([0, 2]))
    ahead = [PathPart(lines=first, until_ns=4_500_000_000), PathPart(lines=second, until_ns=9_000_000_000)]

    whole = read(path_update(0, "world", feed, Polylines.none(), ahead))
    assert [e.id for e in whole.entities] == ["feed", "ahead 0", "ahead 1"]
    assert [e.lifetime.ToNanoseconds() for e in whole.entities] == [0, 4_500_000_000, 9_000_000_000]
    assert whole.entities[0].lines[0].color.a < 0.3 < whole.entities[1].lines[0].color.a
    assert [xyz(p) for p in whole.entities[2].lines[0].points] == second.points.tolist()

    later = read(path_update(5_000_000_000, "world", feed, Polylines.none(), ahead))
    assert [(e.id, e.lifetime.ToNanoseconds()) for e in later.entities] == [("feed", 0), ("ahead 1", 4_000_000_000)]


def test_a_path_of_a_million_points_stays_below_four_megabytes():
    t = np.linspace(0.0, 100.0, 500_000)
    path = Polylines(np.stack([t, np.sin(t), np.cos(t)], axis=1), np.array([0]))

    assert 3e6 < len(path_update(0, "world", path, path)) < 4 << 20


def test_a_polyline_of_one_point_shows_nothing():
    assert not read(polyline_update(T, "block", "world", np.zeros((1, 3)))).entities
    (entity,) = read(polyline_update(T, "block", "world", np.eye(3))).entities
    assert entity.lines[0].type == LinePrimitive.LINE_STRIP and len(entity.lines[0].points) == 3


def test_force_arrows_point_along_the_force_a_millimetre_a_newton():
    forces = np.array([(0, 0, 250), (-100, 0, 0), (0, 0, 0), (1, 2, -3), (40, 0, 0), (-1, 1e-9, 0)], dtype=float)
    times = T + 100_000_000 * np.arange(len(forces))
    tips = P + 0.01 * np.arange(len(forces))[:, None]
    for t_ns, tip, force, message in zip(times, tips, forces, force_updates(times, "world", tips, forces), strict=True):
        update = read(message)
        assert update.deletions[0].timestamp.ToNanoseconds() == t_ns
        if not force.any():
            assert not update.entities
            continue
        (entity,) = update.entities
        (arrow,) = entity.arrows
        assert (entity.id, entity.frame_id, entity.timestamp.ToNanoseconds()) == ("force", "world", t_ns)
        q = arrow.pose.orientation
        along = rotation_from_quaternion(np.array([q.x, q.y, q.z, q.w]))[:, 0]
        assert np.allclose(along, force / np.linalg.norm(force), atol=1e-6)
        assert arrow.shaft_length + arrow.head_length == pytest.approx(1e-3 * np.linalg.norm(force))
        assert np.allclose(xyz(arrow.pose.position), tip, atol=GRID)
