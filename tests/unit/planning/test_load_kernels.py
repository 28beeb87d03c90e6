"""Kernels of motors along segments, beside what they say in numpy."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.planning.arm_kernels import SegmentRates, hold_rates
from gcodesim.planning.load_kernels import Needs, ample_motions, ample_segments, motions_at

COUNT, JOINTS = 40, 6


def drawn(seed: int) -> tuple[SegmentRates, np.ndarray, np.ndarray, np.ndarray]:
    """Rates (k, j), lengths [m], speeds and accelerations (k,)."""
    random = np.random.default_rng(seed)
    rates = SegmentRates(*(random.normal(size=(COUNT, JOINTS)) for _ in range(3)))
    length, speed, acceleration = random.uniform(0.1, 2.0, (3, COUNT))
    return rates, length, speed, acceleration


@pytest.mark.parametrize("at_end", [False, True])
def test_motions_are_those_of_the_cubic(at_end: bool) -> None:
    """q'' at an end, by a difference of the parabola q' that has both rates and the mean, is what acts across."""
    rates, length, speed, acceleration = drawn(1)
    qd, along, across = (np.empty((COUNT, JOINTS)) for _ in range(3))

    motions_at(rates, length, speed, acceleration, at_end, qd, along, across)

    rate = rates.end if at_end else rates.start
    bow = 3.0 * (rates.start + rates.end - 2.0 * rates.mean)  # q' = start + (end - start) u - bow u (1 - u)

    def slope(u: float) -> np.ndarray:
        return rates.start + (rates.end - rates.start) * u - bow * u * (1.0 - u)

    u, step = (1.0, -1e-6) if at_end else (0.0, 1e-6)
    bend = (slope(u + step) - slope(u)) / step / length[:, None]
    assert np.array_equal(qd, rate * speed[:, None])
    assert np.array_equal(along, rate * acceleration[:, None])
    assert across == pytest.approx(bend * speed[:, None] ** 2, abs=2e-4)


def test_ample_motions_are_those_within_the_bounds() -> None:
    random = np.random.default_rng(2)
    swing, coulomb, viscous, rotor = random.uniform(0.0, 1.0, (4, JOINTS))
    weight = random.uniform(-1.0, 1.0, (500, JOINTS))
    inertia, limit = random.uniform(0.0, 0.3, (JOINTS, JOINTS)), random.uniform(4.0, 40.0, JOINTS)
    qd, qdd = random.normal(size=(2, 500, JOINTS))
    found = np.empty(500, dtype=np.uint8)

    ample_motions(weight, qd, qdd, Needs(inertia, swing, coulomb, viscous, rotor, limit), found)

    moved, pushed = np.abs(qd), np.abs(qdd)
    needed = np.abs(weight) + pushed @ inertia.T + moved.sum(axis=1)[:, None] ** 2 * swing
    needed += coulomb + viscous * moved + rotor * pushed
    assert 20 < found.sum() < 480
    assert np.array_equal(found == 1, (needed <= limit).all(axis=1))


@pytest.mark.parametrize("at_end", [False, True])
def test_ample_segments_are_those_whose_motions_are_ample(at_end: bool) -> None:
    random = np.random.default_rng(6)
    rates, length, speed, acceleration = drawn(4)
    inertia, rest = random.uniform(0.0, 0.1, (JOINTS, JOINTS)), random.uniform(0.0, 0.1, (4, JOINTS))
    needs = Needs(inertia, *rest, np.full(JOINTS, 6.0))
    weight, found = random.uniform(0.0, 1.0, JOINTS), np.empty((2, COUNT), dtype=np.uint8)
    qd, along, across = (np.empty((COUNT, JOINTS)) for _ in range(3))

    ample_segments(rates, length, speed, acceleration, at_end, weight, needs, np.empty((2, JOINTS)), found[0])

    motions_at(rates, length, speed, acceleration, at_end, qd, along, across)
    ample_motions(np.tile(weight, (COUNT, 1)), qd, np.abs(along) + np.abs(across), needs, found[1])
    assert np.array_equal(*found) and 0 < found[0].sum() < COUNT


def test_rates_stay_near_the_mean_ones_around_them() -> None:
    rates, length, _, _ = drawn(3)
    length[::7] = 1e-9
    rates.start[::5] *= 50.0
    straight = np.arange(COUNT) % 4 == 0
    before = [rate.copy() for rate in rates]

    hold_rates(rates, length, straight, 1e-6, 10.0)

    size = np.abs(rates.mean)
    around = np.stack([size, np.vstack([size[:1], size[:-1]]), np.vstack([size[1:], size[-1:]])]).max(axis=0)
    most = np.where(length[:, None] > 1e-6, 10.0 * around, np.inf)
    for held, free in ((rates.start, before[0]), (rates.end, before[1])):
        assert np.array_equal(held, np.where(straight[:, None], rates.mean, np.clip(free, -most, most)))
    assert (rates.start != before[0]).any() and np.array_equal(rates.mean, before[2])
