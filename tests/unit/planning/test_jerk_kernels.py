"""Jerk of steps at borders: what is passed within a control cycle counts together, and stays within the limit."""

from __future__ import annotations

import numpy as np
import pytest

from gcodesim.planning.arm_kernels import JointCaps, SegmentRates
from gcodesim.planning.jerk import softer

CYCLE, SHARE = 1e-3, 0.9
LIMIT = np.array([50.0])


def borders(slope: list[float], length: list[float], speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speeds, and what is left of jerk, at the ends of straight segments of one joint, with `slope` of it each."""
    n = len(slope)
    rates = SegmentRates(*(np.array(slope)[:, None].copy() for _ in range(3)))
    caps = JointCaps(*(np.full(n, speed) for _ in range(2)), np.full(n, 10.0), np.zeros(n, dtype=np.int64), np.zeros(n))
    follows = np.append(np.ones(n - 1, dtype=bool), False)
    lower = softer(rates, np.array(length), follows, np.zeros(n, dtype=bool), LIMIT, caps, np.full(n, np.inf))
    return lower.junction, lower.soft.calm, lower.soft.push


def test_a_kink_and_the_jerk_of_the_law_share_the_limit() -> None:
    """A step of q' by k at speed v is a jerk of k v / T² over a cycle T."""
    junction, calm, push = borders([0.5, 0.501], [0.1, 0.1], 1.0)
    taken = 0.001 * junction[0] / CYCLE**2

    assert taken == pytest.approx(0.75 * SHARE * LIMIT[0], rel=1e-6)
    assert taken + 0.501 * calm[0] + 0.001 * push[0] / CYCLE <= SHARE * LIMIT[0] * (1 + 1e-9)
    assert calm[0] > 0.0 and push[0] > 0.0


def test_kinks_within_two_cycles_count_together() -> None:
    far = borders([0.5, 0.501, 0.5], [0.1, 0.1, 0.1], 1.0)[0]
    near = borders([0.5, 0.501, 0.5], [0.1, 1e-6, 0.1], 1.0)[0]

    assert near[:2] == pytest.approx(0.5 * far[:2], rel=1e-6)


def test_a_border_without_a_step_is_no_cap() -> None:
    junction, calm, _ = borders([0.5, 0.5], [0.1, 0.1], 1.0)

    assert junction[0] == 1.0
    assert calm[0] >= 1e30


def test_a_straight_way_has_the_whole_limit() -> None:
    """Where nothing bends, a joint jerks q' times as much as the law; beside a kink a tenth is left for the rest."""
    rates = SegmentRates(*(np.array([0.5, 0.5, 0.501])[:, None].copy() for _ in range(3)))
    caps = JointCaps(*(np.ones(3) for _ in range(2)), np.full(3, 10.0), np.zeros(3, dtype=np.int64), np.zeros(3))
    follows, smooth = np.array([True, True, False]), np.zeros(3, dtype=bool)
    jerk = softer(rates, np.full(3, 0.1), follows, smooth, LIMIT, caps, np.full(3, np.inf)).soft.jerk

    assert jerk * rates.start[:, 0] == pytest.approx(np.array([1.0, SHARE, SHARE]) * LIMIT, rel=1e-6)
