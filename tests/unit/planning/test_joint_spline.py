"""A spline through joint vectors: it meets all of them, from rest to rest, within the limits, as fast as they allow."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from gcodesim.planning.joint_spline import JointSpline

LIMITS = SimpleNamespace(speed=np.array([1.0, 2.0, 0.5]), acceleration=np.array([4.0, 3.0, 10.0]))


@pytest.mark.parametrize("n", [2, 3, 4, 30])
def test_it_is_the_natural_cubic_spline_within_the_limits(n: int) -> None:
    q = np.random.default_rng(n).uniform(-1.0, 1.0, (n, 3))
    spline = JointSpline.through(q, LIMITS)  # type: ignore[arg-type]
    other = CubicSpline(spline.knots, q, bc_type="natural")
    assert spline.at(spline.times) == pytest.approx(other(spline.grid), abs=1e-9)
    assert spline.at(np.interp(spline.knots, spline.grid, spline.times)) == pytest.approx(q, abs=1e-9)

    dt = spline.duration / 40_000
    table = spline.at(np.arange(40_001) * dt)
    speed, acceleration = np.diff(table, axis=0) / dt, np.diff(table, 2, axis=0) / dt**2
    assert (np.abs(speed) <= LIMITS.speed * (1.0 + 1e-6)).all()
    assert (np.abs(acceleration) <= LIMITS.acceleration * (1.0 + 1e-3)).all()
    assert np.abs(speed[[0, -1]]).max() < 10.0 * dt * LIMITS.acceleration.max()
    paces, pushes = (
        (np.abs(speed[:-1]) / LIMITS.speed).max(axis=1),
        (np.abs(acceleration) / LIMITS.acceleration).max(axis=1),
    )
    assert (np.maximum(paces, pushes) > 0.9).mean() > 0.9  # some joint is near a limit nearly all the time


def test_one_straight_way_takes_the_time_of_its_trapezium() -> None:
    """From 0 to 1: full speed 0.5 after 0.05 s and 0.0125, and the same to rest; the other joints have time."""
    spline = JointSpline.through(np.array([[0.0, 0.0, 0.0], [0.1, 0.2, 1.0]]), LIMITS)  # type: ignore[arg-type]

    assert spline.duration == pytest.approx(0.05 + 0.05 + (1.0 - 0.025) / 0.5, rel=2e-3)


def test_what_repeats_takes_no_time() -> None:
    q = np.array([[0.1, 0.2, 0.3]])
    still = JointSpline.through(np.vstack([q, q, q]), LIMITS)  # type: ignore[arg-type]
    assert still.duration == 0.0
    assert still.at(np.array([0.0, 1.0])).tolist() == [[0.1, 0.2, 0.3]] * 2
