"""Joint rates and caps against numpy, joint by joint."""

from __future__ import annotations

import numpy as np
import pytest

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
    rng = np.random.default_rng(8)
    n, share = 200, 0.8
    start, end = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
    length = rng.uniform(0.01, 0.1, n)
    speed_limit, acceleration_limit = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    wanted = rng.uniform(0.01, 2.0, n)
    possible, speed, joint = wanted.copy(), np.empty(n), np.empty(n, dtype=np.int64)
    acceleration = np.full(n, np.inf)

    caps = JointCaps(possible, speed, acceleration, joint)
    joint_caps(SegmentRates(start, end, start), length, share, speed_limit, acceleration_limit, caps)

    rate = np.maximum(np.abs(start), np.abs(end))
    bend = np.abs(end - start) / length[:, None]
    assert np.allclose(possible, np.min(speed_limit / rate, axis=1))
    assert np.array_equal(joint, np.argmin(speed_limit / rate, axis=1))
    assert np.all(speed <= wanted + 1e-15) and np.all(rate * speed[:, None] <= speed_limit * (1 + 1e-12))
    used = rate * acceleration[:, None] + bend * (speed**2)[:, None]
    assert np.all(used <= acceleration_limit * (1 + 1e-12))
    assert np.allclose(np.max(used / acceleration_limit, axis=1), 1.0)
    bent = np.min(np.sqrt(share * acceleration_limit / bend), axis=1)
    assert np.allclose(speed, np.minimum(np.minimum(wanted, possible), bent))
