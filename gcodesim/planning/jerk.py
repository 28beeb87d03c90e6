"""Caps of a path under limits of the jerk of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend_kernels import CYCLE
from gcodesim.motion.timing import Softness
from gcodesim.planning.jerk_kernels import NOTHING, Bends, SoftColumns, bends_of, border_caps, jerk_caps

if TYPE_CHECKING:
    from gcodesim.planning.arm_kernels import JointCaps, SegmentRates

_SHARE: Final = 0.9  # of each limit; the rest is for what changes within a segment besides
_ANY: Final = 1e9  # [rad/s³, m/s³] of a joint without a limit
_STRAIGHT: Final = 1e-7  # of a limit that bends take of a segment along which all joints go evenly


@frozen(kw_only=False, eq=False)
class Softened:
    """The caps `found` and `junction` (k,), lowered for limits of jerk, and what the law of time may do under them."""

    found: JointCaps
    junction: Array
    soft: Softness


def softer(
    rates: SegmentRates,
    length: Array,
    follows: NDArray[np.bool_],
    goes_on: NDArray[np.bool_],
    limit: Array,
    found: JointCaps,
    junction: Array,
) -> Softened:
    """The caps `found` and `junction` (k,) under the `limit` (j,) of the jerk of joints.

    `follows` and `goes_on` (k,): whether the next segment does so at all, and smoothly.
    """
    lower = found._replace(speed=found.speed.copy(), acceleration=found.acceleration.copy())
    junction, n = junction.copy(), len(length)
    soft = SoftColumns(np.empty(n), np.empty(n), np.empty(n))
    most = _SHARE * np.minimum(limit, _ANY)
    bends = bends_of(rates, length, follows, goes_on)
    stands = junction <= 0.0  # what is not passed asks for nothing
    bends.step[stands], bends.kink[stands] = 0.0, 0.0
    jerk_caps(rates, bends, most, lower, soft.jerk)
    soft.jerk[_straight(bends, lower, most)] *= (1.0 - _STRAIGHT) / _SHARE  # nothing changes besides
    border_caps(rates, bends, length, follows, most, CYCLE, lower.speed, junction, soft)
    return Softened(lower, junction, Softness(soft.jerk, soft.calm, soft.push))


def _straight(bends: Bends, caps: JointCaps, limit: Array) -> NDArray[np.bool_]:
    """Which segments (k,) joints pass evenly, without a step at either end."""
    v, a = caps.speed[:, None], caps.acceleration[:, None]
    even = (3.0 * bends.second * v * a + bends.third * v * v * v <= _STRAIGHT * limit).all(axis=1)
    smooth = np.maximum(bends.step, bends.kink).max(axis=1) <= NOTHING
    straight: NDArray[np.bool_] = even & smooth
    straight[1:] &= smooth[:-1]
    return straight
