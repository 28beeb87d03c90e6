"""Poses of the flange of an arm that holds its tool along −Z of a frame O, and the spin of the tool about itself."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import atan2, cos_sin
from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.frames import Array

_TURNED = np.diag([1.0, -1.0, -1.0])  # a tool that points down: its Z along -Z of O


def flange_poses(p_BO: Array, R_BO: Array, spin: float) -> Array:
    """X_BF (n, 4, 4) at origins (n, 3) [m] with tools along −Z of R_BO (n, 3, 3), turned by `spin` [rad]."""
    X = np.zeros((len(p_BO), 4, 4))
    X[:, :3, :3] = multiplied(R_BO, tool_rotation(spin))
    X[:, :3, 3] = p_BO
    X[:, 3, 3] = 1.0
    return X


def tool_rotation(spin: float) -> Array:
    """The tool (3, 3) seen from O: along −Z, turned by `spin` [rad]."""
    c, s = cos_sin(spin)
    return multiplied(_TURNED, np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def turned(X_BF: Array, spins: Array) -> Array:
    """The same poses (n, 4, 4) with the flange turned about its own Z by `spins` (n,) [rad]."""
    cosine, sine = cos_sin(spins)
    X = X_BF.copy()
    X[:, :3, 0] = cosine[:, None] * X_BF[:, :3, 0] + sine[:, None] * X_BF[:, :3, 1]
    X[:, :3, 1] = cosine[:, None] * X_BF[:, :3, 1] - sine[:, None] * X_BF[:, :3, 0]
    return X


def unbent(X_BN: Array, X_NF: Array | None) -> Array:
    """X_BF (n, 4, 4) of tools with their noses at X_BN (n, 4, 4), seen from which the flange is at X_NF (n, 4, 4)."""
    X: Array = X_BN if X_NF is None else multiplied(X_BN, X_NF)
    return X


def flange_origins(positions: Array, offsets: Array, R_BO: Array) -> Array:
    """Where the flange is (n, 3) when the controlled point is at `positions` (n, 3) under length `offsets` (n, 3)."""
    origins: Array = positions + applied(R_BO, offsets)
    return origins


def spin_of(R_BF: Array, R_BO: Array) -> float:
    """The spin [rad] at which the tool's X comes nearest to that of the flange rotation `R_BF` (3, 3)."""
    x = applied(multiplied(R_BO, _TURNED).T, R_BF[:, 0])
    return float(atan2(x[1], x[0])) if math.hypot(x[0], x[1]) > 1e-9 else 0.0


def candidates(spin: float, steps: int) -> NDArray[np.float64]:
    """`spin` and other angles all around the circle, the nearest first."""
    order = sorted(range(steps), key=lambda k: (min(k, steps - k), k))
    angles: NDArray[np.float64] = spin + 2.0 * np.pi * np.array(order) / steps
    return angles
