"""The limits of the joints as the log gives them, and how much of them a motion uses."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.recorder.pose_kernels import most_used

if TYPE_CHECKING:
    from gcodesim.shop import Shop


@frozen(eq=False)
class JointLimits:
    """Limits (j,) of the joints of a shop, infinite where there are none; SI."""

    shop: Shop
    middle: Array
    reach: Array

    @staticmethod
    def of(shop: Shop) -> JointLimits:
        joints = shop.kinematics.joints
        bounded = np.isfinite(joints.lower) & np.isfinite(joints.upper)
        lower, upper = np.where(bounded, joints.lower, 0.0), np.where(bounded, joints.upper, 0.0)
        reach = np.where(upper > lower, 0.5 * (upper - lower), np.inf)
        return JointLimits(shop=shop, middle=0.5 * (lower + upper), reach=reach)

    def used(self, q: Array, qd: Array, effort: Array) -> tuple[Array, Array, Array]:
        """Share (n,) that the nearest joint uses of its travel, speed and effort, from those of all joints (n, j)."""
        joints, none = self.shop.kinematics.joints, np.zeros(len(self.middle))
        questions = ((q, self.middle, self.reach), (qd, none, joints.speed), (effort, none, joints.effort))
        travel, speed, load = (_most(*question) for question in questions)
        return travel, speed, load

    @property
    def record(self) -> dict[str, str]:
        """One entry for each joint: its limits as a JSON object, without those that it does not have."""
        joints = self.shop.kinematics.joints
        return {
            name: json.dumps(
                {
                    "kind": joints.kinds[i],
                    **_finite("lower", joints.lower[i]),
                    **_finite("upper", joints.upper[i]),
                    **_finite("speed", joints.speed[i]),
                    **_finite("acceleration", joints.acceleration[i]),
                    **_finite("effort", joints.effort[i]),
                }
            )
            for i, name in enumerate(self.shop.joint_names)
        }


def _most(value: Array, middle: Array, limit: Array) -> Array:
    most = np.empty(len(value))
    value, middle, limit = (np.require(array, np.float64, ["C", "W"]) for array in (value, middle, limit))
    most_used(value, middle, limit, most)
    return most


def _finite(name: str, value: Any) -> dict[str, float]:
    return {name: float(value)} if np.isfinite(value) else {}
