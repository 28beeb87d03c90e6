"""A spline through joint vectors: it meets all of them, from rest to rest, within the limits, and touches one."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from gcodesim.planning.joint_spline import JointSpline

LIMITS = SimpleNamespace(speed=np.array([1.0, 2.0, 0.5]), acceleration=np.array([4.0, 3.0, 10.0]))


@pytest.mark.parametrize("n", [2, 3, 4, 30])
def test_it_is_the_clamped_cubic_spline_within_the_limits(n: int) -> None:
    q = np.random.default_rng(n).uniform(-1.0, 1.0, (n, 3))
    spline = JointSpline.through(q, LIMITS)  # type: ignore[arg-type]
    other = CubicSpline(spline.times, q, bc_type="clamped")
    t = np.linspace(0.0, spline.duration, 4001)

    assert spline.at(t) == pytest.approx(other(t), abs=1e-9)
    assert spline.at(spline.times) == pytest.approx(q, abs=1e-12)
    speed, acceleration = np.abs(other(t, 1)).max(axis=0), np.abs(other(t, 2)).max(axis=0)
    share = np.concatenate([speed / LIMITS.speed, acceleration / LIMITS.acceleration])
    assert (share <= 1.0 + 1e-9).all() and share.max() > 0.99
    assert other(0.0, 1) == pytest.approx(0.0, abs=1e-9) and other(spline.duration, 1) == pytest.approx(0.0, abs=1e-9)


def test_what_repeats_takes_no_time() -> None:
    q = np.array([[0.1, 0.2, 0.3]])
    still = JointSpline.through(np.vstack([q, q, q]), LIMITS)  # type: ignore[arg-type]
    assert still.duration == 0.0
    assert still.at(np.array([0.0, 1.0])).tolist() == [[0.1, 0.2, 0.3]] * 2
