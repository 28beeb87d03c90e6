"""Boxes around parts of bodies only spare looks: what touches is what a search with balls alone finds."""

import numpy as np
import pytest

from gcodesim.checks.meetings import JointWay, MovingBodies
from gcodesim.checks.rigid import RigidBody, Woods
from gcodesim.frames import Pose
from gcodesim.kinematics.chain import Tree
from gcodesim.solids import Box, Cylinder, Mesh, Placed, Sphere

JOINTS = 4


def shell(rng, across):
    """A sheet of long triangles that is bent like a gutter, with a rim that is nowhere even."""
    u, v = np.meshgrid(np.linspace(0.0, 3.0, across), (0.0, 0.3), indexing="ij")
    points = np.stack([0.1 * np.cos(u), 0.1 * np.sin(u), v + rng.uniform(-0.02, 0.02, u.shape)], axis=-1).reshape(-1, 3)
    first = 2 * np.arange(across - 1)
    faces = np.concatenate(
        [np.column_stack([first, first + 1, first + 2]), np.column_stack([first + 1, first + 3, first + 2])]
    )
    return Mesh.of(points, faces)


def chain():
    axes = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    before = np.tile(np.eye(4), (JOINTS, 1, 1))
    before[1:, :3, 3] = (0.05, 0.02, 0.08)
    return Tree(
        parent=np.arange(-1, JOINTS - 1),
        before=before,
        axis=axes,
        prismatic=np.array([0, 0, 0, 1]),
        path=np.ones(JOINTS, dtype=np.int64),
        carrier=np.zeros(0, dtype=np.int64),
        offset=np.zeros((0, 4, 4)),
        flange_carrier=JOINTS - 1,
        flange_offset=np.eye(4),
    )


def drawn(rng):
    """A shell and round and edged bodies on the last joints, and others that stand still."""
    solids = [
        shell(rng, 12),
        Cylinder(radius=0.03, bottom=-0.1, top=0.1),
        Sphere(radius=0.04),
        Box.about_origin((0.02, 0.1, 0.3)),
    ]
    bodies = [
        RigidBody(
            name=str(n),
            solids=(Placed(solid, Pose.from_xyz_rpy(rng.uniform(-0.1, 0.1, 3), rng.uniform(-3, 3, 3))),),
            carrier=carrier,
        )
        for carrier in (-1, 3)
        for n, solid in enumerate(solids)
    ]
    count = len(solids)
    return bodies, np.array([(i, count + j) for i in range(count) for j in range(count)])


@pytest.mark.parametrize("seed", range(4))
def test_what_touches_is_what_a_search_finds(seed):
    rng = np.random.default_rng(seed)
    bodies, pairs = drawn(rng)
    q = rng.uniform(-0.25, 0.25, (60, JOINTS)) * [6.0, 6.0, 6.0, 1.0]
    seen = set()
    for pair in pairs:
        moving = MovingBodies(chain(), bodies, pair[None])
        touch = moving.touching(q) >= 0
        found = [bool(moving.search(JointWay.straight(row[None]))) for row in q]
        assert touch.tolist() == found, pair
        seen |= set(found)
    assert seen == {True, False}


def test_boxes_hold_what_they_stand_for():
    bodies, _ = drawn(np.random.default_rng(9))
    woods = Woods.of(bodies)
    forest, convexes = woods.forest, woods.convexes
    for node in np.flatnonzero(forest.left < 0):
        body = forest.convex[node]
        if convexes.round[body]:
            continue
        points = convexes.points[convexes.first[body] : convexes.first[body] + convexes.many[body]]
        away = np.abs(points - forest.centre[node]) + convexes.grown[body] - forest.half[node]
        assert away.max() < 1e-15
    inner = np.flatnonzero(forest.left >= 0)
    for parts in (forest.left, forest.right):
        part = parts[inner]
        away = np.abs(forest.centre[part] - forest.centre[inner]) + forest.half[part] - forest.half[inner]
        assert away.max() < 1e-15
