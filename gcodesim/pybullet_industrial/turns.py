"""Quaternions x y z w as Bullet's transforms return them, for paths that have no client."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gcodesim.frames import Array


def matrix_of(quaternion: ArrayLike) -> Array:
    """Rotation (3, 3) of a quaternion (4,) of any length but zero."""
    x, y, z, w = (float(value) for value in np.asarray(quaternion, dtype=float))
    scale = 2.0 / (x * x + y * y + z * z + w * w)
    return np.array(
        [
            [1.0 - scale * (y * y + z * z), scale * (x * y - w * z), scale * (x * z + w * y)],
            [scale * (x * y + w * z), 1.0 - scale * (x * x + z * z), scale * (y * z - w * x)],
            [scale * (x * z - w * y), scale * (y * z + w * x), 1.0 - scale * (x * x + y * y)],
        ]
    )


def quaternion_of(R: Array) -> Array:
    """The quaternion (4,) of a rotation (3, 3) with the sign that Bullet chooses (Shepperd 1978)."""
    trace = float(np.trace(R))
    if trace > 0.0:
        size = np.sqrt(trace + 1.0)
        axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
        return np.append(0.5 / size * axis, 0.5 * size)
    i = int(np.argmax(np.diag(R)))
    j, k = (i + 1) % 3, (i + 2) % 3
    size = np.sqrt(R[i, i] - R[j, j] - R[k, k] + 1.0)
    found = np.zeros(4)
    found[i] = 0.5 * size
    found[[j, k, 3]] = 0.5 / size * np.array([R[j, i] + R[i, j], R[k, i] + R[i, k], R[k, j] - R[j, k]])
    return found
