"""The search for meetings against an independent engine (that of pybullet) and fine sampling, on drawn cases."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import sqrt

import numpy as np
import pybullet
import pytest

from gcodesim.checks.meetings import MovingBodies
from gcodesim.frames import rotation_about
from gcodesim.solids import Box, Cylinder, Hulls, Placed, Solid, Sphere
from tests.unit.checks.drawn_collisions import Array, Case, Gap, cases, chain_cases, depth_of, misses, sampled_gaps

MARGIN = 1e-6
FAR = 2.0
EXACT = 2e-4
"""[m] by which distances of pybullet (single steps of GJK, rounded corners) are trusted; coal 3.0.3, with 2e-6, finds

nothing wrong in 10,000 of these cases either.
"""


class Engine:
    """The solids of two bodies in pybullet, made anew for each case."""

    def __init__(self) -> None:
        self.client = pybullet.connect(pybullet.DIRECT)

    def gap(self, case: Case) -> Gap:
        pybullet.resetSimulation(physicsClientId=self.client)
        moving = [(each, *self._body(each.solid)) for each in case.moving]
        standing = []
        for each in case.standing:
            body, middle = self._body(each.solid)
            self._put(body, each.X.apply(middle), each.X.R)
            standing.append(body)

        def gap(at: Array) -> float:
            least = FAR
            for each, body, middle in moving:
                self._put(body, at[:3, :3] @ each.X.apply(middle) + at[:3, 3], at[:3, :3] @ each.X.R)
                for other in standing:
                    found = pybullet.getClosestPoints(body, other, FAR, physicsClientId=self.client)
                    least = min([least, *(point[8] for point in found)])
            return least

        return gap

    def _body(self, solid: Solid) -> tuple[int, Array]:
        """A body, and the middle of its shape in its frame."""
        middle, make = np.zeros(3), pybullet.createCollisionShape
        match solid:
            case Box(lower=lower, upper=upper):
                middle = 0.5 * (np.array(lower) + np.array(upper))
                half = 0.5 * (np.array(upper) - np.array(lower))
                shape = make(pybullet.GEOM_BOX, halfExtents=half.tolist(), physicsClientId=self.client)
            case Cylinder(radius=radius, bottom=bottom, top=top):
                middle = np.array([0.0, 0.0, 0.5 * (bottom + top)])
                shape = make(pybullet.GEOM_CYLINDER, radius=radius, height=top - bottom, physicsClientId=self.client)
            case Sphere(radius=radius):
                shape = make(pybullet.GEOM_SPHERE, radius=radius, physicsClientId=self.client)
            case Hulls(hulls=(hull,)):
                corners = hull.corners.tolist()
                shape = make(pybullet.GEOM_MESH, vertices=corners, physicsClientId=self.client)
            case _:
                raise AssertionError(solid)
        body = pybullet.createMultiBody(1.0, shape, physicsClientId=self.client)
        pybullet.changeDynamics(body, -1, collisionMargin=MARGIN, physicsClientId=self.client)
        return body, middle

    def _put(self, body: int, p: Array, R: Array) -> None:
        pybullet.resetBasePositionAndOrientation(body, p.tolist(), turn_of(R.tolist()), physicsClientId=self.client)


def turn_of(R: list[list[float]]) -> tuple[float, float, float, float]:
    """A rotation (3, 3) as a quaternion x, y, z, w (Shepperd 1978); asked a million times."""
    (a, b, c), (d, e, f), (g, h, i) = R
    squares = 1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i
    k = squares.index(max(squares))
    s = sqrt(squares[k])
    x, y, z, w = (
        (s, (b + d) / s, (c + g) / s, (h - f) / s),
        ((b + d) / s, s, (f + h) / s, (c - g) / s),
        ((c + g) / s, (f + h) / s, s, (d - b) / s),
        ((h - f) / s, (c - g) / s, (d - b) / s, s),
    )[k]
    return 0.5 * x, 0.5 * y, 0.5 * z, 0.5 * w


@pytest.fixture
def engine() -> Iterator[Engine]:
    found = Engine()
    yield found
    pybullet.disconnect(found.client)


def wrong(engine: Engine, drawn: Iterator[Case], samples: int) -> list[str]:
    """What is wrong with which of the cases."""
    said = ((number, misses(case, engine.gap(case), samples, EXACT)) for number, case in enumerate(drawn))
    return [f"{number}: {what}" for number, what in said if what]


def test_drawn_moves_meet_when_another_engine_says_so(engine: Engine) -> None:
    assert not wrong(engine, cases(80, 11), 60)


def test_drawn_arms_meet_when_another_engine_says_so(engine: Engine) -> None:
    assert not wrong(engine, chain_cases(40, 5), 60)


@pytest.mark.slow
def test_ten_thousand_drawn_moves(engine: Engine) -> None:
    assert not wrong(engine, cases(9_000, 23), 300)
    assert not wrong(engine, chain_cases(1_000, 29), 300)


def test_where_the_engine_is_less_exact_the_second_judge_decides(
    engine: Engine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A case of the ten thousand: pybullet stops 0.28 mm before the depth that directions find, as does the search."""
    case = next(case for number, case in enumerate(cases(6083, 23)) if number == 6082)
    gap = engine.gap(case)
    deepest = min(case.bodies.search(case.way), key=lambda meeting: meeting.gap)
    at = case.at(sum(deepest.deepest))
    assert abs(gap(at) - deepest.gap) > EXACT + 1e-3 * abs(gap(at))
    assert depth_of(case, at) == pytest.approx(-deepest.gap, abs=1e-6)
    assert misses(case, gap, 300, EXACT) == ""

    search = MovingBodies.search
    for wrong_by in (-1e-4, 6e-4):  # a search that were wrong is told, too deep or too shallow for both
        monkeypatch.setattr(
            MovingBodies,
            "search",
            lambda self, way, by=wrong_by: [replace(each, gap=each.gap + by) for each in search(self, way)],
        )
        assert misses(case, gap, 300, EXACT).startswith("deepest")


def test_the_second_judge_knows_depths_in_closed_form() -> None:
    """A ball beside a box, and two balls."""
    box, ball = Box(lower=(-0.05, -0.04, -0.03), upper=(0.05, 0.04, 0.03)), Sphere(radius=0.02)
    nowhere = np.zeros((2, 6))
    case = Case(moving=(Placed(ball),), standing=(Placed(box),), q=nowhere)
    at = np.eye(4)
    at[:3, 3] = 0.045, 0.01, 0.0
    assert depth_of(case, at) == pytest.approx(0.02 + 0.005, abs=1e-9)

    case = Case(moving=(Placed(ball),), standing=(Placed(ball),), q=nowhere)
    at[:3, 3] = 0.018, 0.0, 0.024
    assert depth_of(case, at) == pytest.approx(0.04 - 0.03, abs=1e-9)


def test_the_cases_are_of_both_sorts() -> None:
    met = [bool(case.bodies.search(case.way)) for case in cases(80, 11)]

    assert 20 < sum(met) < 60
    arms = [bool(case.bodies.search(case.way)) for case in chain_cases(40, 5)]

    assert 10 < sum(arms) < 30


def test_samples_that_are_not_asked_change_nothing(engine: Engine) -> None:
    """Contacts, the least gap and its place are those of all samples; fewer than a quarter of them are asked."""
    asked = 0
    for case in [*cases(60, 31), *chain_cases(20, 37)]:
        gap, times = engine.gap(case), np.linspace(0.0, len(case.q) - 1.0, 300)
        every = np.array([gap(at) for at in case.poses(times)])
        for first in (np.inf, float(times[every.argmin()])):
            looks = []
            found = sampled_gaps(case, lambda at, own=gap, seen=looks: seen.append(1) or own(at), times, first, EXACT)
            asked += len(looks)
            assert (found <= every + 1e-12).all()
            early = times < first
            assert np.array_equal(found[early] < -EXACT, every[early] < -EXACT)
            if first < np.inf or every.min() < -EXACT:
                assert found.argmin() == every.argmin() and found.min() == every.min()
    assert asked < 0.25 * 160 * 300


def test_the_engine_turns_bodies_as_they_are_meant() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        axis = rng.normal(size=3)
        R = rotation_about(axis / np.linalg.norm(axis), float(rng.uniform(-3.2, 3.2)))
        assert np.array(pybullet.getMatrixFromQuaternion(turn_of(R.tolist()))) == pytest.approx(R.ravel(), abs=1e-12)
