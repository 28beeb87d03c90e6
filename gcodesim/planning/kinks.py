"""Steps of the rates of joints where one piece of a path goes over into the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import greatest
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend_kernels import CYCLE, KINK_SHARE

if TYPE_CHECKING:
    from gcodesim.planning.arm_kernels import SegmentRates


@frozen(kw_only=False, eq=False)
class Kinks:
    """For k segments one after the other: the speed `cap` (k,) at the end of each, and what is `left` (k,).

    As on the axes of a machine tool, a step of speed may ask for `KINK_SHARE` of a joint's acceleration within one
    cycle, and the segments on both sides make do with the rest of it.
    """

    cap: Array
    left: Array

    @staticmethod
    def between(rates: SegmentRates, end: Array, ratio: Array, here: NDArray[np.bool_], acceleration: Array) -> Kinks:
        """Kinks where `here` (k - 1,) says that segment and next may differ; the next begins `ratio` (k,) as fast.

        `end` (k,) is how fast each segment may end, `acceleration` (j,) that of the joints.
        """
        cap, left = np.full(len(end), np.inf), np.ones(len(end))
        if not here.any():
            return Kinks(cap, left)
        at = np.flatnonzero(here)
        step = np.abs(rates.start[at + 1] * ratio[at, None] - rates.end[at])
        share = greatest(step / acceleration) / CYCLE  # of the acceleration, for each m/s
        sharp = share * end[at] > KINK_SHARE
        cap[at[sharp]] = KINK_SHARE / share[sharp]
        taken = 1.0 - np.minimum(share * end[at], KINK_SHARE)
        for segment in (at, at + 1):
            left[segment] = np.minimum(left[segment], taken)
        return Kinks(cap, left)
