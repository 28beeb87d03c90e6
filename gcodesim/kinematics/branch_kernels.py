"""All branches of arms with a closed form at many poses, compiled."""

from __future__ import annotations

import numpy as np

from gcodesim.compiled import kernel
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Indices
from gcodesim.kinematics.closed_form_kernels import solve_family
from gcodesim.kinematics.plane_kernels import PlaneArm
from gcodesim.kinematics.tree_kernels import copy_row


@kernel
def branches_of_poses(family: int, X: Array, arm: PlaneArm, out: Array, flags: Indices) -> None:
    """Joints `out` (n, 8, 6) and `flags` (n, 8) of all branches at flange poses X (n, 4, 4).

    Where an axis is free, because the arm is singular, it takes the value of the pose before.
    """
    previous = np.zeros(6)
    for k in range(X.shape[0]):
        solve_family(family, X[k], -1, arm, previous, out[k], flags[k])
        for b in range(8):
            if flags[k, b] > 0:
                copy_row(out[k, b], previous)
                break
