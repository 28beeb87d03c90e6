"""The joint axes of an arm in its zero pose, from which closed forms recognise their geometry."""

from __future__ import annotations

import numpy as np

from gcodesim.arithmetic.matrices import applied, determinant, norm, solution
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.tree_kernels import joint_frames, place


def zero_axes(chain: Chain) -> tuple[Array, Array, Array]:
    """A point (j, 3) [m] and the direction (j, 3) of each driven axis at zero, and X_BF (4, 4) there."""
    tree = chain.tree
    count = len(tree.parent)
    frames, X_BF = np.empty((count, 4, 4)), np.empty((4, 4))
    joint_frames(np.zeros(count), tree.parent, tree.before, tree.axis, tree.prismatic, frames)
    place(frames, tree.flange_carrier, tree.flange_offset, X_BF)
    directions = applied(frames[:, :3, :3], tree.axis)
    return frames[:, :3, 3].copy(), directions, X_BF


def intersection(points: Array, directions: Array, tolerance: float) -> Array | None:
    """The point (3,) through which all lines go within `tolerance` [m], or None.

    Least squares: the sum of the projectors off each line has to be regular.
    """
    A, b = np.zeros((3, 3)), np.zeros(3)
    for p, u in zip(points, directions, strict=True):
        off = np.eye(3) - np.outer(u, u)
        A += off
        b += applied(off, p)
    if abs(determinant(A)) < 1e-6:  # all parallel
        return None
    centre: Array = solution(A, b)
    miss = [norm(np.cross(centre - p, u)) for p, u in zip(points, directions, strict=True)]
    return centre if max(miss) < tolerance else None
