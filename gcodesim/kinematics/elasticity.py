"""Elastic gears: how far the tip yields under a wrench while links are rigid."""

from __future__ import annotations

import numpy as np

from gcodesim.arithmetic.matrices import applied, multiplied
from gcodesim.frames import Array


def shift_jacobian(J: Array, R_BF: Array, p_FT: Array) -> Array:
    """Jacobian (n, 6, j) at the tip T from the one at the flange, base axes.

    `R_BF` (n, 3, 3) are flange rotations (poses (n, 4, 4) are accepted too),
    `p_FT` (3,) [m] is the tip in F. The tip moves with v + w × (R_BF p_FT).
    """
    r = applied(R_BF[:, :3, :3], np.asarray(p_FT, dtype=float))
    out = J.copy()
    out[:, :3] += np.cross(J[:, 3:], r[:, :, None], axis=1)
    return out


def compliance(J: Array, stiffness: Array | None) -> Array:
    """Compliance (n, 6, 6), C = J K⁻¹ Jᵀ, of Jacobians (n, 6, j) and joint stiffness (j,) [N·m/rad] or [N/m].

    C times a wrench (force [N], torque [N·m]) is the small displacement
    (position [m], rotation vector [rad]) of the same point (Salisbury 1980, eq. 7
    inverted). None means a rigid machine and gives zeros. An infinite stiffness is a rigid joint.
    """
    if stiffness is None:
        return np.zeros((len(J), 6, 6))
    scaled = J / np.asarray(stiffness, dtype=float)
    return multiplied(scaled, J.transpose(0, 2, 1))
