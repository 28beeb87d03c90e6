"""Joint rates and caps against numpy, joint by joint."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from gcodesim.planning.arm_kernels import JointCaps, SegmentRates, joint_caps, joint_rates


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
