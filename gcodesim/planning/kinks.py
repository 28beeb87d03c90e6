"""Steps of the rates of joints where one piece of a path goes over into the next."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.motion.blend_kernels import CYCLE, KINK_SHARE
from gcodesim.planning.arm_kernels import SegmentRates, kink_caps


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
        kink_caps(rates, end, ratio, here, acceleration, CYCLE, KINK_SHARE, cap, left)
        return Kinks(cap, left)
