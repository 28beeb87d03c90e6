"""Drawn cases of one body that moves past another, and the search for meetings on them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.meetings import JointWay, MovingBodies
from gcodesim.checks.rigid import RigidBody
from gcodesim.checks.way_kernels import JointTree
from gcodesim.frames import Pose, rotation_about
from gcodesim.solids import Box, Cylinder, Hull, Hulls, Placed, Solid, Sphere

Array = NDArray[np.float64]
Gap = Callable[[Array], float]
"""The signed gap [m] of the two bodies of a case at a pose (4, 4) of the one that moves."""

TREE = JointTree(
    np.arange(-1, 5, dtype=np.int64),
    np.tile(np.eye(4), (6, 1, 1)),
    np.array([*np.eye(3), *np.eye(3)]),
    np.array([1, 1, 1, 0, 0, 0], dtype=np.int64),
)
"""A body that floats: shifted along X, Y and Z, then turned about X, Y and Z."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A body that moves straight in its six joints from `start` to `end` (6,), and one that stands."""

    moving: Solid
    standing: Placed
    start: Array
    end: Array

    def at(self, share: float) -> Array:
        """X_WM (4, 4) of the moving body."""
        q = self.start + share * (self.end - self.start)
        X = np.eye(4)
        X[:3, 3] = q[:3]
        for axis, angle in zip(np.eye(3), q[3:], strict=True):
            X[:3, :3] = X[:3, :3] @ rotation_about(axis, float(angle))
        return X

    @property
    def bodies(self) -> MovingBodies:
        bodies = [RigidBody(name="moving", solids=(Placed(self.moving),), carrier=5)]
        bodies.append(RigidBody(name="standing", solids=(self.standing,)))
        return MovingBodies(TREE, bodies, np.array([[0, 1]]))

    @property
    def way(self) -> JointWay:
        return JointWay.straight(np.array([self.start, self.end]))


def _solid(rng: np.random.Generator, size: float) -> Solid:
    """A box, cylinder, sphere or hull some `size` [m] large."""
    a, b, c = size * rng.uniform(0.2, 1.0, 3)
    match int(rng.integers(4)):
        case 0:
            return Box(lower=(-a, -b, -c), upper=(a, b, c))
        case 1:
            return Cylinder(radius=a, bottom=-b, top=b)
        case 2:
            return Sphere(radius=a)
    return _hull(rng, a, b, c)


def _hull(rng: np.random.Generator, a: float, b: float, c: float) -> Solid:
    """A leaning prism: of a rhombus at the bottom and one that is turned by drawn shifts at the top."""
    top = rng.uniform(-0.5, 0.5, 2) * a
    low = [(a, 0.0, -c), (0.0, b, -c), (-a, 0.0, -c), (0.0, -b, -c)]
    high = [(x + top[0], y + top[1], c) for x, y, _ in low]
    from scipy.spatial import ConvexHull

    corners = np.array(low + high)
    hull = ConvexHull(corners)
    return Hulls(hulls=(Hull(corners=corners, normals=np.ascontiguousarray(hull.equations[:, :3])),))


def cases(count: int, seed: int) -> Iterator[Case]:
    """Half of them at random; a quarter are walls of 0.1 to 1 mm passed within one move, a quarter graze."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        moving = _solid(rng, 0.05)
        X = Pose(rng.uniform(-0.05, 0.05, 3), _turn(rng))
        if number % 4 == 0:  # a wall, and a small body that is through it at once
            thin = rng.uniform(1e-4, 1e-3)
            standing = Placed(Box(lower=(-0.2, -0.2, -0.5 * thin), upper=(0.2, 0.2, 0.5 * thin)), X)
            moving = _solid(rng, 0.004)
            middle = X.apply(np.array([*rng.uniform(-0.22, 0.22, 2), 0.0]))
            way = X.rotate(np.array([*rng.uniform(-0.5, 0.5, 2), 1.0])) * rng.uniform(0.0, 0.2)
            start, end = np.append(middle - way, rng.uniform(-3, 3, 3)), np.append(middle + way, rng.uniform(-3, 3, 3))
        else:
            standing = Placed(_solid(rng, 0.08), X)
            start = np.append(rng.uniform(-0.25, 0.25, 3), rng.uniform(-3.0, 3.0, 3))
            end = start + np.append(rng.uniform(-0.3, 0.3, 3), rng.uniform(-2.0, 2.0, 3))
            if number % 4 == 1:
                end[3:] = start[3:]
        yield Case(moving=moving, standing=standing, start=start, end=end)


def _turn(rng: np.random.Generator) -> Array:
    axis = rng.normal(size=3)
    return rotation_about(axis / np.linalg.norm(axis), float(rng.uniform(0.0, 3.0)))


DIRECTIONS = 4000
REFINED = 8


def extent_along(solid: Solid, n: Array) -> Array:
    """How far (m,) [m] a body reaches from the origin of its frame along unit vectors n (m, 3)."""
    match solid:
        case Box(lower=lower, upper=upper):
            return np.maximum(np.array(lower) * n, np.array(upper) * n).sum(axis=1)
        case Cylinder(radius=radius, bottom=bottom, top=top):
            return radius * np.hypot(n[:, 0], n[:, 1]) + np.maximum(bottom * n[:, 2], top * n[:, 2])
        case Sphere(radius=radius):
            return np.full(len(n), radius)
        case Hulls(hulls=(hull,)):
            return (hull.corners @ n.T).max(axis=0)
    raise AssertionError(solid)


def depth_of(case: Case, at: Array) -> float:
    """How deep [m] both bodies are in each other with the moving one at `at` (4, 4): the least shift that parts them.

    Two convex bodies are parted by a shift along n of h(n), what both reach towards each other along n; the depth is
    the least h. It is sought among many directions, and from the best of them by steps aside that become shorter. So
    no engine's algorithm is in it, and it can only be found too deep, not too shallow.
    """
    X = case.standing.X

    def both(n: Array) -> Array:
        own = extent_along(case.moving, n @ at[:3, :3]) + n @ at[:3, 3]
        return own + extent_along(case.standing.solid, -n @ X.R) - n @ X.p

    k = np.arange(DIRECTIONS) + 0.5
    height, turn = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    wide = np.sqrt(1.0 - height**2)
    n = np.stack([wide * np.cos(turn), wide * np.sin(turn), height], axis=1)
    best = np.inf
    for start in n[np.argsort(both(n), kind="stable")[:REFINED]]:
        here, value, step = start, float(both(start[None])[0]), 0.05
        while step > 1e-9:
            tries = here + step * np.concatenate([np.eye(3), -np.eye(3)])
            tries /= np.linalg.norm(tries, axis=1)[:, None]
            found = both(tries)
            if found.min() < value:
                here, value = tries[int(found.argmin())], float(found.min())
            else:
                step *= 0.5
        best = min(best, value)
    return best


def misses(case: Case, gap: Gap, samples: int, close: float) -> str:
    """What is wrong with what the search says of a case, in the eyes of another engine; "": nothing.

    `close` [m] is how exact the other engine is. A contact must be found that goes deeper than that at any of the
    samples; and at the places that are reported the bodies must be as near, or as deep in each other, as is said.
    Where the engine says another depth, `depth_of` decides, ten times as exactly.
    """
    found = case.bodies.search(case.way)
    shares = np.linspace(0.0, 1.0, samples)
    if not found:
        deep = min((gap(case.at(float(share))), float(share)) for share in shares)
        return f"missed: {deep[0]} at {deep[1]}" if deep[0] < -close else ""
    first = found[0]
    if gap(case.at(first.share)) > close:
        return f"reported at {first.share}, where the gap is {gap(case.at(first.share))}"
    before = [float(share) for share in shares if share < first.share - 1e-9]
    early = min((gap(case.at(share)) for share in before), default=np.inf)
    if early < -close:
        return f"reported at {first.share}, but the gap is {early} before"
    deepest = min(found, key=lambda meeting: meeting.gap)
    there = gap(case.at(deepest.deepest[1]))
    if abs(there - deepest.gap) > close + 1e-3 * abs(there):
        depth = depth_of(case, case.at(deepest.deepest[1]))
        if there >= 0.0 or abs(depth + deepest.gap) > 0.1 * close:
            return f"deepest {deepest.gap} at {deepest.deepest[1]}, where it is {there}, or {-depth}"
    return ""
