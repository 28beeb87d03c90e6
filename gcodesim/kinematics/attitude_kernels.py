"""Rotations of many attitudes, compiled: `attitude.Direction` and `attitude.WordTurns` row by row."""

from __future__ import annotations

import math

import numpy as np

from gcodesim.arithmetic.rotation_kernels import multiply
from gcodesim.arithmetic.sin_kernels import cos_sin
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices

BACK = 1e-12  # 1 + z of a direction that points straight back


@kernel(lean=True)
def along_directions(values: Array, out: Array) -> None:
    """R `out` (n, 3, 3): the shortest turn from Z into (a, b, 1 + c) of `values` (n, 3); straight back about X."""
    for i in range(values.shape[0]):
        x, y, z = values[i, 0] + 0.0, values[i, 1] + 0.0, values[i, 2] + 1.0
        length = max(math.sqrt(x * x + y * y + z * z), 1e-12)
        x, y, z = x / length, y / length, z / length
        R = out[i]
        if 1.0 + z < BACK:
            R[:, :] = 0.0
            R[0, 0], R[1, 1], R[2, 2] = 1.0, -1.0, -1.0
            continue
        share = 1.0 / (1.0 + z)
        R[0, 0], R[0, 1], R[0, 2] = 1.0 - share * x * x, -share * x * y, x
        R[1, 0], R[1, 1], R[1, 2] = -share * x * y, 1.0 - share * y * y, y
        R[2, 0], R[2, 1], R[2, 2] = -x, -y, z


@kernel
def by_turns(values: Array, axis: Indices, word: Indices, sign: Array, out: Array) -> None:
    """R `out` (n, 3, 3) of turns one after the other, number k about `axis[k]` by `sign[k]` times word `word[k]`.

    Words are `values` (n, 3) [rad].
    """
    own, product = np.zeros((3, 3)), np.zeros((3, 3))
    for n in range(values.shape[0]):
        R = out[n]
        R[:, :] = 0.0
        R[0, 0] = R[1, 1] = R[2, 2] = 1.0
        for t in range(axis.shape[0]):
            cosine, sine = cos_sin(sign[t] * values[n, word[t]])
            own[:, :] = 0.0
            i, j = (axis[t] + 1) % 3, (axis[t] + 2) % 3
            own[axis[t], axis[t]] = 1.0
            own[i, i], own[j, j] = cosine, cosine
            own[i, j], own[j, i] = -sine, sine
            multiply(R, own, product)
            R[:, :] = product
