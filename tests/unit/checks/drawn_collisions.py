"""Drawn cases of bodies that move past each other, and the search for meetings on them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gcodesim.checks.meetings import JointWay, MovingBodies
from gcodesim.checks.rigid import RigidBody
from gcodesim.checks.way_kernels import JointTree
from gcodesim.frames import Pose, rotation_about
from gcodesim.solids import Box, Cylinder, Hull, Hulls, Mesh, Placed, Solid, Sphere

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
    """Bodies of convex solids on joints `carriers` (-1: the base) of a tree that goes straight between q (n + 1, j).

    Times count stretches. `dented` is a mesh whose triangles are the solids of the standing body.
    """

    moving: tuple[Placed, ...]
    standing: tuple[Placed, ...]
    q: Array
    tree: JointTree = TREE
    carriers: tuple[int, int] = (5, -1)
    dented: tuple[Placed, ...] = ()

    def poses(self, times: Array) -> Array:
        """X (k, 4, 4) of the moving body's carrier seen from that of the standing one."""
        last = np.minimum(times.astype(int), len(self.q) - 2)
        q = self.q[last] + (times - last)[:, None] * (self.q[last + 1] - self.q[last])
        frames = {-1: np.tile(np.eye(4), (len(times), 1, 1))}
        for j in range(q.shape[1]):
            frames[j] = frames[int(self.tree.parent[j])] @ self.tree.before[j] @ self._motion(j, q[:, j])
        return np.linalg.inv(frames[self.carriers[1]]) @ frames[self.carriers[0]]

    def _motion(self, j: int, q: Array) -> Array:
        axis, X = self.tree.axis[j], np.tile(np.eye(4), (len(q), 1, 1))
        if self.tree.prismatic[j]:
            X[:, :3, 3] = q[:, None] * axis
            return X
        K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
        X[:, :3, :3] += np.sin(q)[:, None, None] * K + (1.0 - np.cos(q))[:, None, None] * (K @ K)
        return X

    def at(self, time: float) -> Array:
        """One of `poses`."""
        at: Array = self.poses(np.array([time]))[0]
        return at

    @property
    def bodies(self) -> MovingBodies:
        bodies = [RigidBody(name="moving", solids=self.moving, carrier=self.carriers[0])]
        bodies.append(RigidBody(name="standing", solids=self.dented or self.standing, carrier=self.carriers[1]))
        return MovingBodies(self.tree, bodies, np.array([[0, 1]]))

    @property
    def way(self) -> JointWay:
        return JointWay.straight(self.q)


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
        yield Case(moving=(Placed(moving),), standing=(standing,), q=np.array([start, end]))


def chain_cases(count: int, seed: int) -> Iterator[Case]:
    """Arms and machines: solids on a joint of a drawn tree, others on the base, on an earlier joint or on a branch.

    A quarter of them meet a bracket, which is a mesh with a dent. The ways have up to four stretches.
    """
    rng = np.random.default_rng(seed)
    for number in range(count):
        n, branch = int(rng.integers(2, 7)), int(rng.integers(0, 3))
        parent = np.concatenate([np.arange(-1, n - 1), np.where(np.arange(branch) == 0, -1, n - 1 + np.arange(branch))])
        before = np.tile(np.eye(4), (len(parent), 1, 1))
        for X in before:
            X[:3, :3], X[:3, 3] = _turn(rng), rng.uniform(-0.05, 0.05, 3)
        axis = np.array([_turn(rng)[0] for _ in parent])
        prismatic = rng.integers(0, 4, len(parent)) == 0
        tree = JointTree(parent.astype(np.int64), before, axis, prismatic.astype(np.int64))
        size = np.where(prismatic, 0.1, 1.0)
        nodes = 2 + int(rng.integers(4))
        steps = rng.uniform(-0.5, 0.5, (nodes, len(parent)))
        q = (rng.uniform(-1.5, 1.5, len(parent)) + np.cumsum(steps, axis=0)) * size
        carriers = n - 1, len(parent) - 1 if branch else int(rng.integers(-1, n - 1))
        moving, standing = (_some(rng, large) for large in (0.05, 0.08))
        if number % 4 == 0:
            bracket = Placed(_bracket(rng), Pose(rng.uniform(-0.05, 0.05, 3), _turn(rng)))
            yield Case(moving=moving, standing=_faces(bracket), q=q, tree=tree, carriers=carriers, dented=(bracket,))
        else:
            yield Case(moving=moving, standing=standing, q=q, tree=tree, carriers=carriers)


def _some(rng: np.random.Generator, size: float) -> tuple[Placed, ...]:
    """One to three solids beside each other."""
    count = 1 + int(rng.integers(3))
    return tuple(Placed(_solid(rng, size), Pose(rng.uniform(-size, size, 3), _turn(rng))) for _ in range(count))


def _bracket(rng: np.random.Generator) -> Mesh:
    """An L of drawn size, as a closed mesh."""
    outline = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in outline]) * rng.uniform(0.015, 0.04, 3)
    low = [(0, 2, 1), (0, 3, 2), (0, 5, 3), (5, 4, 3)]
    faces = [*low, *((a + 6, c + 6, b + 6) for a, b, c in low)]
    for i in range(6):
        j = (i + 1) % 6
        faces += [(i, j, j + 6), (i, j + 6, i + 6)]
    return Mesh.of(points, np.array(faces))


def _faces(mesh: Placed) -> tuple[Placed, ...]:
    """The triangles of a mesh as convex solids without an inside."""
    assert isinstance(mesh.solid, Mesh)
    skin = mesh.solid.triangles
    return tuple(
        Placed(Hulls(hulls=(Hull(corners=corners, normals=np.zeros((0, 3))),)), mesh.X)
        for corners in skin.points[skin.faces]
    )


def _turn(rng: np.random.Generator) -> Array:
    axis = rng.normal(size=3)
    return rotation_about(axis / np.linalg.norm(axis), float(rng.uniform(0.0, 3.0)))


DIRECTIONS = 4000
REFINED = 8
FAR = 0.02  # [m] bodies are this far apart along a direction: they are in each other along none
ASIDE = np.random.default_rng(1).normal(size=(12, 3))
GOLDEN_ROUNDS = 16
JUDGED = 2e-5  # [m] to which `depth_of` is believed at one place,
BOUND = 5e-6  # and by which it may find bodies deeper than is said: the search's own 1e-6, and rounding of the judge


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
    no engine's algorithm is in it, and it can only be found too deep, not too shallow. Of several couples of convex
    bodies the deepest counts.
    """
    return max(_depth_of_couple(one, other, at) for one in case.moving for other in case.standing)


def _depth_of_couple(one: Placed, other: Placed, at: Array) -> float:
    R, p = at[:3, :3] @ one.X.R, at[:3, :3] @ one.X.p + at[:3, 3]
    X = other.X

    def both(n: Array) -> Array:
        own = extent_along(one.solid, n @ R) + n @ p
        return own + extent_along(other.solid, -n @ X.R) - n @ X.p

    k = np.arange(DIRECTIONS) + 0.5
    height, turn = 1.0 - 2.0 * k / DIRECTIONS, np.pi * (1.0 + np.sqrt(5.0)) * k
    wide = np.sqrt(1.0 - height**2)
    n = np.stack([wide * np.cos(turn), wide * np.sin(turn), height], axis=1)
    reach = both(n)
    best = float(reach.min())
    if best < -FAR:
        return best
    for start in n[np.argsort(reach, kind="stable")[:REFINED]]:
        here, value, step = start, float(both(start[None])[0]), 0.05
        while step > 1e-9:
            aside = np.cross(here, ASIDE)
            tries = here + step * aside / np.linalg.norm(aside, axis=1)[:, None]
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
    samples; at the places that are reported the bodies must be as near, or as deep in each other, as is said; and where
    the engine finds them deepest they must not be deeper than that by more than `BOUND`. Where the engine says another
    depth, `depth_of` decides.
    """
    found = case.bodies.search(case.way)
    times = np.linspace(0.0, len(case.q) - 1.0, samples)
    first = min((meeting.stretch + meeting.share for meeting in found), default=np.inf)
    gaps = sampled_gaps(case, gap, times, first, close)
    if not found:
        least = int(gaps.argmin())
        return f"missed: {gaps[least]} at {times[least]}" if gaps[least] < -close else ""
    if gap(case.at(first)) > close:
        return f"reported at {first}, where the gap is {gap(case.at(first))}"
    early = gaps[times < first - 1e-9].min(initial=np.inf)
    if early < -close:
        return f"reported at {first}, but the gap is {early} before"
    deepest = min(found, key=lambda meeting: meeting.gap)
    if first == 0.0 and deepest.gap <= -deep_inside(case):
        return ""  # inside a mesh: nobody knows how deep
    at = case.at(sum(deepest.deepest))
    there = gap(at)
    if abs(there - deepest.gap) > close + 1e-3 * abs(there):
        depth = depth_of(case, at)
        if there >= 0.0 or abs(depth + deepest.gap) > JUDGED:
            return f"deepest {deepest.gap} at {deepest.deepest}, where it is {there}, or {-depth}"
    time, least_gap = _least_near(case, gap, float(times[gaps.argmin()]), float(times[1] - times[0]))
    if least_gap < deepest.gap - BOUND:
        depth = depth_of(case, case.at(time))
        if -depth < deepest.gap - BOUND:
            return f"deepest {deepest.gap} at {deepest.deepest}, but {least_gap}, or {-depth}, at {time}"
    return ""


def sampled_gaps(case: Case, gap: Gap, times: Array, first: float, close: float) -> Array:
    """The gaps (k,) [m] at sampled times, or less where it cannot matter how much.

    Between two places no point of the moving body goes farther than its frame goes and turns, and neither a gap nor a
    depth changes by more than that. So a sample is asked of the engine, which is `close` [m] exact, unless what is
    known of others says that its gap is above the least, and before the time `first` that it is no contact.
    """
    poses, asked = case.poses(times), np.zeros(len(times), dtype=bool)
    turn = np.einsum("kij,kij->k", poses[1:, :3, :3], poses[:-1, :3, :3])  # 1 + 2 cos
    chord = np.sqrt(np.maximum(3.0 - turn, 0.0))  # 2 sin of half the angle
    way = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1) + chord * reach_of(case.moving)
    gone = np.concatenate([[0.0], np.cumsum(way)])
    bound, early, least = np.full(len(times), -np.inf), times < first, np.inf
    while True:
        open_ = ~asked & (bound <= np.where(early, max(-close, least), least))
        if not open_.any():
            return bound
        k = int(np.where(open_, bound, np.inf).argmin()) if asked.any() else 0
        if np.isneginf(bound[k]):
            k = (len(times) - 1) // 2
        value = gap(poses[k])
        least = min(least, value)
        bound = np.where(asked, bound, np.maximum(bound, value - np.abs(gone - gone[k]) - 2.0 * close))
        bound[k], asked[k] = value, True


def reach_of(solids: tuple[Placed, ...]) -> float:
    """How far [m] bodies reach from the origin of their frame at the most."""
    axes = np.vstack([np.eye(3), -np.eye(3)])
    reach = 0.0
    for each in solids:
        own = np.linalg.norm([extent_along(each.solid, axis[None])[0] for axis in axes])
        reach = max(reach, float(own + np.linalg.norm(each.X.p)))
    return reach


def deep_inside(case: Case) -> float:
    """The depth [m] that is said of a body inside a mesh: how far the smaller of both reaches."""
    return float(min(case.bodies._woods.far)) if case.dented else np.inf


def _least_near(case: Case, gap: Gap, time: float, step: float) -> tuple[float, float]:
    """When the gap is least near a time, by golden section, and that gap [m]."""
    share = 0.5 * (np.sqrt(5.0) - 1.0)
    low, high = max(time - step, 0.0), min(time + step, len(case.q) - 1.0)
    left, right = high - share * (high - low), low + share * (high - low)
    at_left, at_right = gap(case.at(left)), gap(case.at(right))
    best = min((gap(case.at(time)), time), (at_left, left), (at_right, right))
    for _ in range(GOLDEN_ROUNDS - 1):  # each round keeps one of its two places for the next
        if at_left <= at_right:
            high, right, at_right = right, left, at_left
            left = high - share * (high - low)
            at_left = gap(case.at(left))
        else:
            low, left, at_left = left, right, at_right
            right = low + share * (high - low)
            at_right = gap(case.at(right))
        best = min(best, (at_left, left), (at_right, right))
    return best[1], best[0]
