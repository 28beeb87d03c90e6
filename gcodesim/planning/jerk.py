"""Caps of a path under limits of the jerk of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.motion.blend_kernels import CYCLE
from gcodesim.planning.arm_kernels import jerk_caps

if TYPE_CHECKING:
    from gcodesim.planning.arm_kernels import JointCaps, SegmentRates

_SHARE: Final = 0.9  # of each limit; the rest is for what changes within a segment besides
_ANY: Final = 1e9  # [rad/s³, m/s³] of a joint without a limit


def softer(
    rates: SegmentRates,
    length: Array,
    follows: NDArray[np.bool_],
    goes_on: NDArray[np.bool_],
    limit: Array,
    found: JointCaps,
    junction: Array,
) -> dict[str, Any]:
    """`found` and `junction` (k,) lowered, and the `jerk` (k,) that is left, under the `limit` (j,) of joints.

    `follows` and `goes_on` (k,): whether the next segment does so at all, and smoothly.
    """
    lower = found._replace(speed=found.speed.copy(), acceleration=found.acceleration.copy())
    junction, jerk = junction.copy(), np.empty(len(length))
    jerk_caps(rates, length, follows, goes_on, _SHARE * np.minimum(limit, _ANY), CYCLE, lower, junction, jerk)
    return {"found": lower, "junction": junction, "jerk": jerk}
