"""The way of a tool whose axis has any direction, in straight pieces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class AxisWay(NamedTuple):
    """Pieces of a tip's way in S, each (c, 3): tips [m], and unit vectors from the tip to the holder at both ends.

    Between them the axis is that of the weighted mean of both vectors.
    """

    starts: Array
    ends: Array
    axes_start: Array
    axes_end: Array


def upright(starts: Array, ends: Array) -> AxisWay:
    """Pieces (c, 3) of a tool along Z."""
    axes = np.zeros_like(starts)
    axes[:, 2] = 1.0
    return AxisWay(starts, ends, axes, axes)
