"""Joint rates and caps against numpy, joint by joint."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from gcodesim.motion.blend_kernels import CYCLE, KINK_SHARE
from gcodesim.planning.arm_kernels import JointCaps, SegmentRates, hurry_shares, joint_caps, joint_rates, mean_rates
from gcodesim.planning.kinks import Kinks


@pytest.mark.parametrize("count", [6, 7])
def test_joint_rates_are_the_shortest_solution(count: int) -> None:
    rng = np.random.default_rng(4)
    J = rng.normal(size=(30, 6, count))
    v, w = rng.normal(size=(30, 3)), rng.normal(size=(30, 3))

    first, last = joint_rates(J, v, w)

    for got, velocity in ((first, v), (last, w)):
        twist = np.concatenate([velocity, np.zeros((30, 3))], axis=1)
        expected = np.stack([np.linalg.pinv(J[i]) @ twist[i] for i in range(30)])
        assert np.allclose(got, expected, rtol=1e-6, atol=1e-8)


def test_a_singular_jacobian_gives_huge_but_finite_rates() -> None:
    J = np.diag([1.0, 1.0, 0.0, 1.0, 1.0, 1.0])[None]

    rates, _ = joint_rates(J, np.array([[0.0, 0.0, 1.0]]), np.zeros((1, 3)))

    assert np.isfinite(rates).all() and np.abs(rates).max() > 1e6


def test_caps_keep_speed_and_acceleration_of_every_joint() -> None:
    """All along the cubic that has the joints and the rates of both ends, at the greatest speed and acceleration."""
    rng = np.random.default_rng(8)
    n, share = 200, 0.8
    start, end = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
    mean = 0.5 * (start + end) + 0.3 * rng.normal(size=(n, 3))
    length = rng.uniform(0.01, 0.1, n)
    speed_limit, acceleration_limit = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    wanted = rng.uniform(0.01, 2.0, n)
    caps = JointCaps(wanted.copy(), np.empty(n), np.full(n, np.inf), np.empty(n, dtype=np.int64), np.empty(n))

    joint_caps(SegmentRates(start, end, mean), length, share, speed_limit, acceleration_limit, caps)

    ends = zip(length, mean, start, end, strict=True)
    cubics = [CubicHermiteSpline([0.0, h], [np.zeros(3), m * h], [a, b]) for h, m, a, b in ends]
    at = np.linspace(0.0, 1.0, 41)
    rate = np.array([cubic(at * h, 1) for cubic, h in zip(cubics, length, strict=True)])
    bend = np.abs([cubic(at * h, 2) for cubic, h in zip(cubics, length, strict=True)])
    most = np.abs(rate).max(axis=1)
    share_of_speed = (most * caps.speed[:, None] / speed_limit).max(axis=1)
    assert np.all(caps.speed <= wanted + 1e-15) and np.all(share_of_speed <= 1.0 + 1e-12)
    assert np.all(share_of_speed <= caps.speed / caps.wanted + 1e-12)
    used = np.abs(rate) * caps.acceleration[:, None, None] + bend * (caps.speed**2)[:, None, None]
    assert np.all(used <= acceleration_limit * (1 + 1e-12))
    assert np.median((used / acceleration_limit).max(axis=(1, 2))) > 0.9  # and it is made use of
    bent = np.min(np.sqrt(share * acceleration_limit / bend.max(axis=1)), axis=1)
    assert np.allclose(caps.speed, np.minimum(np.minimum(wanted, caps.wanted), bent))
    change = np.abs(bend_ends(cubics, length)) / 2.0 * (caps.speed**2)[:, None]
    assert np.allclose(caps.unresolved, (change / acceleration_limit).max(axis=1))


def bend_ends(cubics: list[CubicHermiteSpline], length: np.ndarray) -> np.ndarray:
    """By how much q'' (n, j) differs between both ends."""
    return np.array([cubic(h, 2) - cubic(0.0, 2) for cubic, h in zip(cubics, length, strict=True)])


def test_mean_rates_are_differences_of_joints_where_these_say_something() -> None:
    rng = np.random.default_rng(2)
    q, ends = rng.normal(size=(12, 6)), np.array([1, 2, 3, 6, 7, 11])
    start, end, mean = rng.normal(size=(6, 6)), rng.normal(size=(6, 6)), np.empty((6, 6))
    length = np.array([0.1, 1e-6, 0.03, 2e-6, 1e-7, 0.2])

    mean_rates(q, ends, length, 1e-6, SegmentRates(start, end, mean))

    expected = (q[ends] - q[ends - 1]) / length[:, None]
    near = length <= 1e-6
    expected[near] = 0.5 * (start[near] + end[near])
    assert np.array_equal(mean, expected)


def test_a_kink_takes_a_share_of_the_acceleration_on_both_sides() -> None:
    rng = np.random.default_rng(5)
    n, acceleration = 40, np.array([2.0, 3.0, 5.0])
    rates = SegmentRates(rng.normal(size=(n, 3)), rng.normal(size=(n, 3)), np.zeros((n, 3)))
    speed, ratio, here = rng.uniform(1e-6, 3e-4, n), rng.uniform(0.5, 2.0, n), rng.random(n - 1) < 0.5

    kinks = Kinks.between(rates, speed, ratio, here, acceleration)

    cap, left = np.full(n, np.inf), np.ones(n)
    for k in np.flatnonzero(here):
        share = (np.abs(rates.start[k + 1] * ratio[k] - rates.end[k]) / acceleration).max() / CYCLE
        taken = min(share * speed[k], KINK_SHARE)
        cap[k] = KINK_SHARE / share if share * speed[k] > KINK_SHARE else np.inf
        left[k], left[k + 1] = min(left[k], 1.0 - taken), min(left[k + 1], 1.0 - taken)
    assert np.array_equal(kinks.cap, cap) and np.array_equal(kinks.left, left)
    assert 0 < np.isfinite(cap).sum() < here.sum()


def test_shares_of_hurry_are_those_of_the_quickest_way_from_rest_to_rest() -> None:
    """Against the envelope of all that bounds a speed squared, ahead and behind: two chains of segments."""
    rng = np.random.default_rng(5)
    n = 60
    length, acceleration = 10 ** rng.uniform(-4, -2, n), rng.uniform(0.1, 2.0, n)
    speed = 10 ** rng.uniform(-2, 0, n)
    end = np.minimum(speed, 10 ** rng.uniform(-1, 0, n))
    rests = np.isin(np.arange(n), (0, 25))
    shares = np.empty(n)

    hurry_shares(length, speed, acceleration, end, rests, shares)

    heads, last = [0, 25], [25, n]
    for a, b in zip(heads, last, strict=True):
        # places where a bound stands: at rest, at the end of a segment, or all along one
        gain = np.concatenate([[0.0], np.cumsum(2.0 * acceleration[a:b] * length[a:b])])
        bound = np.concatenate([[0.0], np.minimum(end[a:b], speed[a:b]) ** 2])
        bound[-1] = 0.0
        bound[:-1] = np.minimum(bound[:-1], speed[a:b] ** 2)
        nodes = np.min(bound[None] + np.abs(gain[:, None] - gain[None]), axis=1)
        own = 2.0 * acceleration[a:b] * length[a:b]
        top = np.minimum(0.5 * (nodes[:-1] + nodes[1:] + own), speed[a:b] ** 2)
        assert shares[a:b] == pytest.approx(top / speed[a:b] ** 2, rel=1e-9)
    assert (shares < 0.9).sum() > 5 and (shares == 1.0).any()


def test_nothing_is_cut_where_motion_is_never_quick_enough() -> None:
    """A segment that any speed would do for, between two that have to be slow, has little of it."""
    shares = np.empty(3)
    at = np.ones(3)
    hurry_shares(1e-4 * at, np.array([0.01, 10.0, 0.01]), at, np.array([0.01, 0.01, 0.0]), at < 0.0, shares)
    assert shares[1] == pytest.approx((0.01**2 + 1e-4) / 10.0**2)
