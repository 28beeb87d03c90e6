"""The time law under jerk: closed forms of single moves, and caps everywhere on drawn spans."""

from __future__ import annotations

from math import cbrt, sqrt
from typing import Any

import numpy as np
import pytest

from gcodesim.motion.soft_kernels import CHANGE, DURATION, JERK, PIECE, PLACE, SPEED, SoftCaps, soft_law

CYCLE = 1e-3


def law(length: Any, speed: Any, acceleration: Any, jerk: Any, *ends: Any) -> np.ndarray:
    """Phases; `ends`: what is allowed where segments end, of speed, jerk and acceleration."""
    n = len(length)
    none = np.full(n, 1e30)
    junction, calm, push = (np.array(column, dtype=float) for column in (*ends, none, none, none)[:3])
    junction[-1] = 0.0
    columns = [np.array(column, dtype=float) for column in (length, speed, acceleration, jerk)]
    caps = SoftCaps(np.arange(n), np.zeros(n), *columns, junction, calm, push, np.zeros(n, dtype=bool))
    phases: np.ndarray = soft_law(caps, CYCLE)
    return phases


@pytest.mark.parametrize(
    ("length", "speed", "expected"),
    [
        (1.0, 1.0, 1.0 / 1.0 + 1.0 / 3.0 + 3.0 / 50.0),  # D/v + v/a + a/j
        (0.1, 0.1, 0.1 / 0.1 + 2.0 * sqrt(0.1 / 50.0)),  # full acceleration is not reached: D/v + 2 √(v/j)
        (0.001, 1.0, 4.0 * cbrt(0.001 / 100.0)),  # nor the speed: 4 ∛(D/2j)
    ],
)
def test_single_moves_are_the_fastest(length: float, speed: float, expected: float) -> None:
    """Closed forms of Biagiotti, Melchiorri: Trajectory Planning, 2008, section 3.4."""
    assert law([length], [speed], [3.0], [50.0])[:, DURATION].sum() == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("acceleration", [9.9, 5.0])
def test_a_move_in_many_segments_takes_as_long_as_in_one(acceleration: float) -> None:
    """Where caps end within a move, rounding makes slopes that last no time; they are no tops."""
    whole = law([0.2], [0.99], [acceleration], [54.0])[:, DURATION].sum()
    parts = law([0.005] * 40, [0.99] * 40, [acceleration] * 40, [54.0] * 40)[:, DURATION].sum()

    assert parts == pytest.approx(whole, rel=1e-6)


def test_every_cap_holds_everywhere() -> None:
    rng = np.random.default_rng(3)
    for number in range(60):
        n = int(rng.integers(1, 40))
        length, speed = 10 ** rng.uniform(-5, 0, n), 10 ** rng.uniform(-2, 0, n)
        acceleration = 10 ** rng.uniform(-0.5, 0.7, n)
        jerk = acceleration * 10 ** rng.uniform(0.5, 2, n)
        junction = np.where(rng.random(n) < 0.2, 10 ** rng.uniform(-3, -1, n), 1e30)
        calm = np.where(rng.random(n) < 0.3, jerk * rng.uniform(0.1, 0.9, n), 1e30)
        push = np.where(rng.random(n) < 0.3, acceleration * rng.uniform(0.01, 0.9, n), 1e30)
        phases = law(length, speed, acceleration, jerk, junction, calm, push)
        piece, t = phases[:, PIECE].astype(int), phases[:, DURATION]
        v0, a0, j = phases[:, SPEED], phases[:, CHANGE], phases[:, JERK]
        v1, a1 = v0 + t * (a0 + 0.5 * j * t), a0 + j * t
        gone = t * (v0 + t * (0.5 * a0 + j * t / 6.0))

        assert np.maximum(v0, v1).max() > 0.0 and min(v0.min(), v1.min()) > -1e-9
        assert (np.maximum(v0, v1) <= speed[piece] * (1 + 1e-6) + 1e-9).all(), number
        assert (np.maximum(np.abs(a0), np.abs(a1)) <= acceleration[piece] * (1 + 1e-6) + 1e-9).all(), number
        assert (np.abs(j) <= jerk[piece] * (1 + 1e-5)).all(), number
        assert np.allclose(v1[:-1], v0[1:], atol=1e-6) and np.allclose(a1[:-1], a0[1:], atol=1e-3)
        assert np.allclose(np.bincount(piece, weights=gone, minlength=n), length, atol=1e-9)
        follows = np.where(piece[1:] == piece[:-1], (phases[:, PLACE] + gone)[:-1], 0.0)
        assert np.allclose(phases[1:, PLACE], follows, atol=1e-9)
        last = np.flatnonzero(piece[1:] != piece[:-1])
        assert (v1[last] <= junction[piece[last]] * (1 + 1e-6) + 1e-9).all(), number
        ends = np.cumsum(t)[last]
        for k, end in zip(piece[last], ends, strict=True):  # nor in the cycles before and behind
            near = (np.cumsum(t) > end - CYCLE) & (np.cumsum(t) - t < end + CYCLE)
            assert (np.abs(j[near]) <= calm[k] * (1 + 1e-5)).all(), number
            assert (np.maximum(np.abs(a0), np.abs(a1))[near] <= push[k] * (1 + 1e-6) + 1e-9).all(), number
