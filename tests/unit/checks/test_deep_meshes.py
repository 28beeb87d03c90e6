"""Meshes that are deep in each other: what is left out by its size alone, and the depth against all couples."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.checks.descent_kernels import deepest_of
from gcodesim.checks.gap_kernels import gap_room, signed_gap
from gcodesim.checks.meetings import EXACT, TOUCH, JointWay, MovingBodies
from gcodesim.checks.rigid import RigidBody, Woods
from gcodesim.frames import Array, Pose
from gcodesim.solids import Box, Cylinder, Placed, Sphere
from tests.unit.checks.test_boxes import JOINTS, chain, shell

LOOKED = 65


def pose_of(xyz: Array, rpy: Array) -> Array:
    X = np.eye(4)
    pose = Pose.from_xyz_rpy(tuple(xyz), tuple(rpy))
    X[:3, :3], X[:3, 3] = pose.R, pose.p
    return X


def test_no_two_bodies_are_deeper_in_each_other_than_their_sizes_allow() -> None:
    rng = np.random.default_rng(3)
    solids = [shell(rng, 9), shell(rng, 40), Box.about_origin((0.02, 0.1, 0.3)), Sphere(radius=0.04)]
    solids.append(Cylinder(radius=0.03, bottom=-0.1, top=0.1))
    woods = Woods.of(
        [
            RigidBody(name=str(n), solids=(Placed(solid, Pose.from_xyz_rpy((0.0, 0.0, 0.0))),))
            for n, solid in enumerate(solids)
        ]
    )
    forest, convexes, room, n = woods.forest, woods.convexes, gap_room(), np.zeros(3)
    leaf = {int(forest.convex[node]): int(node) for node in np.flatnonzero(forest.left < 0)}
    middles, shares = convexes.origin, []
    for _ in range(3000):
        a, b = rng.integers(0, len(leaf), 2).tolist()
        Xa, Xb = (pose_of(np.zeros(3), rng.uniform(-3.0, 3.0, 3)) for _ in range(2))
        for X, body in ((Xa, a), (Xb, b)):  # one upon the other
            X[:3, 3] = rng.normal(0.0, 2e-3, 3) - X[:3, :3] @ middles[body]
        gap = signed_gap(a, b, convexes, Xa, Xb, np.inf, room, n)
        shares.append(-gap / deepest_of(leaf[a], leaf[b], forest.most))
    assert max(shares) <= 1.0
    assert max(shares) > 0.9  # so it is not allowed for too much


def test_a_node_allows_what_one_of_its_leaves_does() -> None:
    forest = Woods.of(
        [
            RigidBody(
                name="shell", solids=(Placed(shell(np.random.default_rng(1), 30), Pose.from_xyz_rpy((0.0, 0.0, 0.0))),)
            )
        ]
    ).forest
    leaves = forest.most[forest.left < 0]
    assert forest.most[0].tolist() == leaves.max(axis=0).tolist()
    assert (leaves[:, 2] == 0.0).all() and (leaves[:, 1] < 2.0 * leaves[:, 0]).all()


def test_the_depth_of_meshes_is_that_of_their_deepest_couple_anywhere_on_the_way() -> None:
    rng, met = np.random.default_rng(5), 0
    for _ in range(20):
        at = [Pose.from_xyz_rpy(*rng.uniform(-0.05, 0.05, (2, 3)).tolist()) for _ in range(2)]
        bodies = [
            RigidBody(name=str(carrier), solids=(Placed(shell(rng, 20), X),), carrier=carrier)
            for X, carrier in zip(at, (-1, JOINTS - 1), strict=True)
        ]
        moving = MovingBodies(chain(), bodies, np.array([[0, 1]]))
        way = JointWay.straight(rng.uniform(-0.2, 0.2, (5, JOINTS)))
        seen = min(depth_at(moving, way.at(k, share)) for k in range(4) for share in np.linspace(0.0, 1.0, LOOKED))
        found = moving.search(way)
        assert bool(found) or seen > -TOUCH
        if found:
            met += 1
            deepest = min(found, key=lambda meeting: meeting.gap)
            assert deepest.gap <= seen + EXACT
            assert depth_at(moving, way.at(*deepest.deepest)) == pytest.approx(deepest.gap, abs=1e-8)
    assert 5 < met < 20


def depth_at(moving: MovingBodies, q: Array) -> float:
    """The least gap [m] of all couples of two bodies, each looked at."""
    convexes, (one, other) = moving.table()
    frames = moving._frames(q)
    Xa, Xb = (frames[body.carrier] for body in moving.bodies)
    room, n = gap_room(), np.zeros(3)
    return min(float(signed_gap(a, b, convexes, Xa, Xb, 0.0, room, n)) for a in range(*one) for b in range(*other))
