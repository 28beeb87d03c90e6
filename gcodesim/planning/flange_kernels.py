"""Poses of the flange of many places along a path, compiled: what `flange_poses` and `guide` say of each, in one go."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gcodesim.arithmetic.rotation_kernels import multiply, multiply_transposed
from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices


class Holding(NamedTuple):
    """How each row of a path holds its tool: frames O and `axes` about which they lean, in B (n, 3, 3), `offset` (n, 3)
    of the flange [m] in axes of O, and the tool seen from O, turned by the spin, `tool` (3, 3).
    """

    R_BO: Array
    axes: Array
    offset: Array
    tool: Array


@kernel
def lean_frames(attitudes: Array, rows: Indices, holding: Holding, out: Array) -> None:
    """Frames O `out` (k, 3, 3) in B, leaned by `attitudes` (k, 3, 3) about the axes of their `rows` (k,)."""
    one, two = np.empty((3, 3)), np.empty((3, 3))
    for i in range(rows.shape[0]):
        axes = holding.axes[rows[i]]
        multiply(axes, attitudes[i], one)
        multiply_transposed(one, axes, two)
        multiply(two, holding.R_BO[rows[i]], out[i])


@kernel(lean=True)
def hold_tools(positions: Array, frames: Array, rows: Indices, holding: Holding, out: Array) -> None:
    """X_BF `out` (k, 4, 4) with controlled points at the first three of `positions` (k, 6), in `frames` (k, 3, 3)."""
    for i in range(rows.shape[0]):
        R, X, offset = frames[i], out[i], holding.offset[rows[i]]
        multiply(R, holding.tool, X)
        for r in range(3):
            X[r, 3] = positions[i, r] + (R[r, 0] * offset[0] + R[r, 1] * offset[1] + R[r, 2] * offset[2])
        X[3, 0], X[3, 1], X[3, 2], X[3, 3] = 0.0, 0.0, 0.0, 1.0


@kernel(lean=True)
def turn_flanges(X_BF: Array, cosine: Array, sine: Array) -> None:
    """Turn flanges X_BF (k, 4, 4) about their own Z, in place, by angles with this `cosine` and `sine` (k,)."""
    for i in range(X_BF.shape[0]):
        X, c, s = X_BF[i], cosine[i], sine[i]
        for r in range(3):
            x, y = X[r, 0], X[r, 1]
            X[r, 0] = c * x + s * y
            X[r, 1] = c * y - s * x


@kernel(lean=True)
def twists_between(behind: Array, ahead: Array, width: Array, out: Array) -> None:
    """Velocities `out` (k, 6), linear and angular, from poses (k, 4, 4) to others `width` (k,) of way farther on."""
    for i in range(width.shape[0]):
        A, B, w = ahead[i], behind[i], width[i]
        for r in range(3):
            out[i, r] = (A[r, 3] - B[r, 3]) / w
            a, b = (r + 2) % 3, (r + 1) % 3
            one = A[a, 0] * B[b, 0] + A[a, 1] * B[b, 1] + A[a, 2] * B[b, 2]
            two = A[b, 0] * B[a, 0] + A[b, 1] * B[a, 1] + A[b, 2] * B[a, 2]
            out[i, 3 + r] = 0.5 * (one - two) / w
