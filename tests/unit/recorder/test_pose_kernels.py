"""The compiled comparisons of poses against plain formulas."""

import numpy as np
import pytest

from gcodesim.frames import quaternion_from_rotation, rotation_from_quaternion
from gcodesim.recorder.pose_kernels import bend, compare, most_used, write_poses


def poses(n, seed, turn=np.inf):
    """Random poses (n, 4, 4), turned by up to `turn` [rad]; the first few by half turns and by nothing."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=(n, 3))
    axis[:3] = np.eye(3)
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.minimum(rng.uniform(0.0, 2.0 * np.pi, n), turn)
    angle[:3], angle[3] = np.minimum(np.pi, turn), 0.0
    X = np.tile(np.eye(4), (n, 1, 1))
    half = 0.5 * angle[:, None]
    X[:, :3, :3] = rotation_from_quaternion(np.concatenate([axis * np.sin(half), np.cos(half)], axis=1))
    X[:, :3, 3] = rng.normal(size=(n, 3))
    return X


def test_rows_of_poses_have_the_bits_of_the_slow_way():
    X = poses(2000, 1).reshape(500, 4, 4, 4)
    out = np.full((500, 5, 7), np.nan)
    write_poses(X, np.array([3, 0, 2]), 1, out)
    expected = np.concatenate([X[..., :3, 3], quaternion_from_rotation(X[..., :3, :3])], axis=-1)
    assert (out[:, 1:4] == expected[:, [3, 0, 2]]).all()
    assert not np.signbit(out[:, 1:4][out[:, 1:4] == 0.0]).any()
    assert np.isnan(out[:, [0, 4]]).all()


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-3, 2.0])
def test_bent_poses_are_turned_about_their_origins(size):
    n = 200
    X, X_WB = poses(n, 2), poses(7, 3)[6]
    deflection = np.random.default_rng(4).normal(size=(n, 6)) * size
    vector = deflection[:, 3:]
    half = 0.5 * np.linalg.norm(vector, axis=1, keepdims=True)
    q = np.concatenate([0.5 * vector * np.sinc(half / np.pi), np.cos(half)], axis=1)
    expected = X.copy()
    expected[:, :3, 3] += deflection[:, :3]
    expected[:, :3, :3] = rotation_from_quaternion(q) @ X[:, :3, :3]
    bent = X.copy()
    bend(X_WB, deflection, bent)
    assert bent == pytest.approx(X_WB @ expected, abs=1e-14)
    if size == 0.0:
        bend(np.eye(4), deflection, X)
        assert (expected == X).all()


@pytest.mark.parametrize("turn", [np.inf, 1e-3, 1e-9])
def test_errors_between_poses(turn):
    n = 300
    target, part, off = poses(n, 5), poses(n, 6), poses(n, 7, turn)
    off[:, :3, 3] *= 1e-4
    actual = target @ off
    errors, local = np.empty((n, 2)), np.empty((n, 3))
    compare(target, actual, part, errors, local)
    q = quaternion_from_rotation(off[:, :3, :3])
    angle = 2.0 * np.arctan2(np.linalg.norm(q[:, :3], axis=1), q[:, 3])
    assert errors[:, 0] == pytest.approx(np.linalg.norm(off[:, :3, 3], axis=1), abs=1e-15)
    assert errors[:, 1] == pytest.approx(angle, abs=3e-8 if turn > 3.0 else 1e-15)  # a half turn has no axis
    assert local == pytest.approx((np.linalg.inv(part) @ actual)[:, :3, 3], abs=1e-14)


def test_the_nearest_limit_counts():
    value = np.array([[1.0, -3.0, 100.0, 5.0], [0.5, 0.0, 0.0, 0.0]])
    middle, limit = np.array([0.5, 0.0, 0.0, 0.0]), np.array([2.0, 4.0, np.inf, 0.0])
    out = np.empty(2)
    most_used(value, middle, limit, out)
    assert out.tolist() == [0.75, 0.0]
