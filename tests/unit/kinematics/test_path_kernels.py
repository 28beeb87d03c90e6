"""Turns and the choice of a branch, against plain statements of the rules."""

import numpy as np
import pytest

from gcodesim.kinematics.path_kernels import FLIP, LIMIT, OK, REACH, choose, nearest_turn

TURN = 2 * np.pi


def slow_nearest_turn(angle, previous, lower, upper):
    every = [angle + k * TURN for k in range(-6, 7)]
    inside = [v for v in every if lower - 1e-9 <= v <= upper + 1e-9]
    return min(inside or every, key=lambda v: abs(v - previous))


def test_nearest_turn_agrees_with_trying_all_turns():
    rng = np.random.default_rng(4)
    for _ in range(500):
        lower, upper = -rng.uniform(0, 7), rng.uniform(0, 7)
        angle, previous = rng.uniform(-np.pi, np.pi), rng.uniform(lower, upper)
        expected = slow_nearest_turn(angle, previous, lower, upper)
        assert nearest_turn(angle, previous, lower, upper) == pytest.approx(expected, abs=1e-12)


def picked(candidates, previous, last=-1, lower=-3.0, upper=3.0, usable=None):
    candidates = np.array(candidates, dtype=float)
    count = candidates.shape[1]
    out = np.empty(count)
    usable = np.ones(len(candidates), dtype=np.int64) if usable is None else np.array(usable, dtype=np.int64)
    bounds = np.full(count, lower), np.full(count, upper)
    revolute = np.ones(count, dtype=np.int64)
    branch, status = choose(candidates, usable, np.array(previous, dtype=float), *bounds, revolute, last, out)
    return branch, status, out


def test_the_nearest_branch_wins():
    branch, status, out = picked([[1, 1], [0.2, 0.1], [0.3, 0.3]], [0, 0])
    assert (branch, status) == (1, OK) and out == pytest.approx([0.2, 0.1])


def test_a_tie_goes_to_the_lower_branch():
    assert picked([[2, 0], [-1, 0], [1, 0]], [0, 0])[0] == 1


def test_a_branch_that_does_not_exist_is_not_taken():
    assert picked([[0, 0], [1, 0]], [0, 0], usable=[0, 1])[0] == 1


def test_a_branch_within_limits_goes_before_a_nearer_one_outside():
    branch, status, _ = picked([[1.2, 0], [-0.9, 0]], [0.9, 0], upper=1.0)
    assert (branch, status) == (1, OK)


def test_outside_limits_the_nearest_one_is_told():
    branch, status, out = picked([[2.0, 0], [1.5, 0]], [0.9, 0], lower=-1.0, upper=1.0)
    assert (branch, status) == (1, LIMIT) and out == pytest.approx([1.5, 0])


def test_no_solution_keeps_the_joints():
    _, status, out = picked([[1, 1]], [0.5, 0.6], usable=[0])
    assert status == REACH and out == pytest.approx([0.5, 0.6])


def test_another_branch_by_a_jump_is_a_flip_and_by_a_small_step_is_not():
    assert picked([[2, 0], [0.5, 0]], [0, 0], last=0)[1] == FLIP
    assert picked([[2, 0], [0.2, 0]], [0, 0], last=0)[1] == OK
    assert picked([[2, 0], [0.5, 0]], [0, 0], last=-1)[1] == OK


def test_a_turn_is_not_unwound_along_a_path():
    """3.1 rad goes on from 2.9; −3.18 is the same angle within limits, but a turn away."""
    _, status, out = picked([[3.1, 0]], [2.9, 0], last=0, lower=-3.3, upper=3.0)
    assert status == LIMIT and out == pytest.approx([3.1, 0])
    _, status, out = picked([[3.1, 0]], [2.9, 0], last=-1, lower=-3.3, upper=3.0)
    assert status == OK and out == pytest.approx([3.1 - TURN, 0])


def test_beyond_a_limit_rather_than_by_a_jump():
    _, status, out = picked([[1.05, 0], [-0.9, 0]], [0.95, 0], last=0, lower=-1.0, upper=1.0)
    assert status == LIMIT and out == pytest.approx([1.05, 0])


def test_by_a_jump_where_nothing_is_smooth():
    _, status, out = picked([[1.6, 0], [-0.9, 0]], [0.95, 0], last=0, lower=-1.0, upper=1.0)
    assert status == FLIP and out == pytest.approx([-0.9, 0])
