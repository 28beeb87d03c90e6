"""Facts behind a status that all families share: which joint, by how much."""

from __future__ import annotations

import numpy as np

from gcodesim.frames import Array
from gcodesim.kinematics.chain import Joints
from gcodesim.kinematics.protocol import Reason, Status


def unit_of(joints: Joints, index: int) -> str:
    """SI unit of a joint's position."""
    return "m" if joints.kinds[index] == "prismatic" else "rad"


def limit_reason(joints: Joints, q: Array) -> Reason:
    """The joint that is farthest beyond its limits at q (j,)."""
    over = np.maximum(q - joints.upper, joints.lower - q)
    i = int(np.argmax(over))
    bound = joints.upper[i] if q[i] > joints.upper[i] else joints.lower[i]
    return Reason(
        status=Status.LIMIT,
        what=joints.names[i],
        value=float(q[i]),
        limit=float(bound),
        unit=unit_of(joints, i),
        joint=i,
    )


def jump_reason(joints: Joints, q: Array, previous: Array, allowed: float) -> Reason:
    """The joint that jumps most between `previous` and q (j,)."""
    step = np.abs(q - previous)
    i = int(np.argmax(step))
    return Reason(
        status=Status.FLIP,
        what=f"jump of {joints.names[i]}",
        value=float(step[i]),
        limit=allowed,
        unit=unit_of(joints, i),
        joint=i,
    )
