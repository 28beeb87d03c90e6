"""Zones: where a process acts, seen from the tip of its tool."""

from __future__ import annotations

from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen

Array = NDArray[np.float64]


@frozen
class Zone:
    """A cylinder about the axis of the tool that contains everything on which a process may act; lengths [m].

    In the tip frame T, whose Z points from the holder to the tip: within `radius` of the axis, from `above` the tip,
    towards the holder, to `below` it, beyond the tip. A laser that burns 300 mm away from its lens says `below=0.3`.
    Either may be negative: a zone that begins 10 mm beyond the tip has `above=-0.01`.
    """

    radius: float
    below: float = 0.0
    above: float = 0.0

    @property
    def everywhere(self) -> bool:
        """Whether the zone is unbounded, so that the process is asked about every step."""
        return not isfinite(self.radius)

    def meets(self, start: Array, end: Array, axis: Array, low: Array, high: Array, margin: float = 0.0) -> bool:
        """Whether part of the box from `low` to `high` (3,) may be in the zone, or nearer to it than `margin` [m].

        The tip goes along pieces from `start` to `end` (c, 3); `axis` (n, 3) are the unit vectors from the tip to the
        holder on the way. All are in one frame. May say yes where the answer is no, but never the other way round.
        """
        if self.everywhere:
            return True
        lower, upper = self.bounds(start, end, axis, margin)
        return bool((lower < high).all() and (upper > low).all())

    def bounds(self, start: Array, end: Array, axis: Array, margin: float = 0.0) -> tuple[Array, Array]:
        """Least and greatest corner (3,) [m] of a box that contains the zone on the way, see `meets`."""
        least, most = axis.min(axis=0), axis.max(axis=0)
        ends = np.array([-self.below * least, -self.below * most, self.above * least, self.above * most])
        steepest = np.where(least * most > 0.0, np.minimum(np.abs(least), np.abs(most)), 0.0)
        across = self.radius * np.sqrt(np.maximum(1.0 - steepest * steepest, 0.0)) + margin
        lower = np.minimum(start, end).min(axis=0) + ends.min(axis=0) - across
        upper = np.maximum(start, end).max(axis=0) + ends.max(axis=0) + across
        return lower, upper

    def bounds_by_step(
        self, ends: tuple[Array, Array], first: NDArray[np.int64], axes: tuple[Array, Array], margin: float = 0.0
    ) -> tuple[Array, Array]:
        """The same for each of n steps on the way: corners (n, 3) (n, 3).

        The tip goes along pieces between `ends` (c, 3); `first` (n,) is the first piece of each step. `axes` (n, 3)
        are those at the beginnings and at the ends of the steps. The box of a step without a piece has no end.
        """
        lower, upper = np.full((2, len(first), 3), -inf)
        upper[:] = inf
        count = np.diff(first, append=len(ends[0]))
        some = np.flatnonzero(count)
        if self.everywhere or not len(some):
            return lower, upper
        one, other = (axis[some] for axis in axes)
        tilts = np.stack([-self.below * one, -self.below * other, self.above * one, self.above * other])
        steepest = np.where(one * other > 0.0, np.minimum(np.abs(one), np.abs(other)), 0.0)
        across = self.radius * np.sqrt(np.maximum(1.0 - steepest * steepest, 0.0)) + margin
        least = np.minimum.reduceat(np.minimum(*ends), first[some], axis=0)
        most = np.maximum.reduceat(np.maximum(*ends), first[some], axis=0)
        lower[some] = least + tilts.min(axis=0) - across
        upper[some] = most + tilts.max(axis=0) + across
        return lower, upper


EVERYWHERE = Zone(radius=inf)
"""For a process that wants to see every step, wherever the tool is."""
