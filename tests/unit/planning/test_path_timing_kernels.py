"""The fastest way along a path of joints, against closed forms and against ways that are lifted at random."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gcodesim.planning.path_timing_kernels import fastest, seconds_along


def duration(s: np.ndarray, q1: np.ndarray, q2: np.ndarray, v: np.ndarray, a: np.ndarray) -> tuple[float, np.ndarray]:
    most = 1.0 / np.maximum((np.abs(q1) / v).max(axis=1), 1e-12) ** 2
    reach, times = np.empty(len(s)), np.empty(len(s))
    fastest(s, q1, q2, most, a, reach)
    seconds_along(s, reach, times)
    return float(times[-1]), reach


def test_a_straight_path_takes_the_time_of_its_slowest_trapezium() -> None:
    s = np.linspace(0.0, 1.0, 2001)
    way, v, a = np.array([1.0, -2.0]), np.array([0.8, 1.0]), np.array([4.0, 5.0])
    found, _ = duration(s, np.tile(way, (len(s), 1)), np.zeros((len(s), 2)), v, a)

    assert found == pytest.approx(2.0 / 1.0 + 1.0 / 5.0, rel=1e-4)  # the second joint: way / v + v / a


def test_a_circle_of_two_joints_is_run_at_the_speed_that_bending_leaves() -> None:
    """q = (cos s, sin s): somewhere on each quarter one joint has all of v² as its acceleration, so v² is at most 1."""
    s = np.linspace(0.0, 4.0 * math.pi, 20001)
    q1 = np.column_stack([-np.sin(s), np.cos(s)])
    q2 = np.column_stack([-np.cos(s), -np.sin(s)])
    limits = np.array([1.0, 1.0])
    _, reach = duration(s, q1, q2, np.array([10.0, 10.0]), limits)
    u = np.diff(reach) / (2.0 * np.diff(s))
    acceleration = q1[:-1] * u[:, None] + q2[:-1] * reach[:-1, None]

    assert np.abs(acceleration).max() <= 1.0 + 1e-9
    assert reach[np.argmin(np.abs(s - 2.0 * math.pi))] == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("seed", range(3))
def test_no_faster_way_is_found_by_lifting_speeds_at_random(seed: int) -> None:
    """Every grid point by itself is as fast as its neighbours let it be: one that is lifted breaks a limit."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0.0, 1.0, 60)
    turns, phase = rng.uniform(1.0, 6.0, 3), rng.uniform(0.0, 6.0, 3)
    q1, q2 = turns * np.cos(turns * s[:, None] + phase), -(turns**2) * np.sin(turns * s[:, None] + phase)
    v, a = rng.uniform(0.5, 3.0, 3), rng.uniform(2.0, 8.0, 3)
    _, reach = duration(s, q1, q2, v, a)

    def breaks(x: np.ndarray) -> float:
        """By what share the limits are exceeded at the ends of all steps."""
        u = (np.diff(x) / (2.0 * np.diff(s)))[:, None]
        ends = [np.abs(q1[:-1] * u + q2[:-1] * x[:-1, None]), np.abs(q1[1:] * u + q2[1:] * x[1:, None])]
        speeds = np.abs(q1) * np.sqrt(np.maximum(x, 0.0))[:, None] / v
        return float(max((ends[0] / a).max(), (ends[1] / a).max(), speeds.max()))

    assert breaks(reach) <= 1.0 + 1e-9
    for _ in range(300):
        lift = np.zeros(len(s))
        a_row, b_row = np.sort(rng.integers(1, len(s) - 1, 2))
        lift[a_row : b_row + 1] = rng.uniform(1e-3, 0.1) * np.hanning(b_row - a_row + 3)[1:-1]
        assert breaks(reach * (1.0 + lift)) > 1.0
