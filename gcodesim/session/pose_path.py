"""Poses on the way through given ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan2, cos_sin
from gcodesim.arithmetic.matrices import dot, norm, norms
from gcodesim.frames import Array, rotation_from_quaternion


def between(ends: Array, turns: Array, spacing: float) -> tuple[Array, NDArray[np.int64]]:
    """Poses (m, 4, 4) on the way through positions (n, 3) and quaternions (n, 4), without the first.

    Straight, and turning evenly (Shoemake 1985); at most `spacing` [m] apart, or as many radians times 0.1 m. Besides
    the number of the pose to which each leads, from 0 on.
    """
    turns = turns / norms(turns)[:, None]
    poses, numbers = [], []
    for k in range(len(ends) - 1):
        a, b = turns[k], turns[k + 1]
        cosine = dot(a, b)
        b, cosine = (-b, -cosine) if cosine < 0.0 else (b, cosine)
        cosine = min(cosine, 1.0)
        angle = atan2(float(np.sqrt(1.0 - cosine * cosine)), cosine)
        count = max(int(np.ceil(max(float(norm(ends[k + 1] - ends[k])), 0.2 * angle) / spacing - 1e-9)), 1)
        s = np.arange(1, count + 1)[:, None] / count
        if angle < 1e-9:
            q = a + s * (b - a)
        else:
            q = (cos_sin((1.0 - s) * angle)[1] * a + cos_sin(s * angle)[1] * b) / np.sqrt(1.0 - cosine * cosine)
        X = np.tile(np.eye(4), (count, 1, 1))
        X[:, :3, :3] = rotation_from_quaternion(q)
        X[:, :3, 3] = ends[k] + s * (ends[k + 1] - ends[k])
        poses.append(X)
        numbers.append(np.full(count, k))
    return np.concatenate(poses), np.concatenate(numbers)
