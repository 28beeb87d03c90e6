"""`Course`: which way a path goes around where the machine is, and a little further along it."""

from __future__ import annotations

from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.frames import Array
from gcodesim.motion.pieces import Pieces

CORNER: Final = 0.97
"""Cosine of the angle between two directions from which on they are one way."""

CORNER_ARC: Final = 0.5
"""Of the way that is looked ahead: an arc that is shorter rounds a corner."""


class Bend(NamedTuple):
    """Unit vectors (n, 3) along a path at two places, and the way (n,) [m] from the first to the second."""

    first: Array
    second: Array
    way: Array


class Course:
    """The directions of `pieces` by the way along all of them, in axes of the path."""

    def __init__(self, pieces: Pieces) -> None:
        self._pieces = pieces
        every = np.arange(len(pieces))
        _, along = pieces.points(every, 0.5 * pieces.length)
        self._rate = norms(along[:, :3])  # of way by s: s is a time in some pieces, and an angle in others
        self._way = pieces.length * self._rate
        self._end = np.cumsum(self._way)
        starts, ends = self._towards(every, np.zeros(len(pieces))), self._towards(every, pieces.length)
        self._breaks = dots(ends[:-1], starts[1:]) < CORNER  # from a piece to the next
        self._turns = dots(starts, ends) < CORNER
        self._corners: dict[float, Array] = {}

    def bends(self, piece: NDArray[np.int64], s: Array, onward: float) -> Bend:
        """How the path goes on from the places `s` (n,) of pieces `piece` (n,) for `onward` [m], or up to a corner.

        Close to a corner the first place is before it, half of `onward` from the corner; a corner behind it stays
        behind. The directions of a piece in which only rotary axes turn are zeros.
        """
        way = self._end[piece] - (self._pieces.length[piece] - s) * self._rate[piece]
        corners = self._corners_in(onward)
        following = np.clip(np.searchsorted(corners, way, side="right"), 1, len(corners) - 1)
        first, last = corners[following - 1], corners[following]
        end = np.minimum(way + onward, last)
        begin = np.maximum(np.minimum(way, end - 0.5 * onward), first)
        return Bend(self._at(begin, "right"), self._at(end, "left"), end - begin)

    def _corners_in(self, onward: float) -> Array:
        """Ways (m,) [m] of the corners for one who looks so far: where directions part, and both ends of small arcs."""
        if onward not in self._corners:
            rounded = self._turns & (self._way < CORNER_ARC * onward)
            ends = rounded.copy()
            ends[:-1] |= self._breaks | rounded[1:]
            self._corners[onward] = np.concatenate([[0.0], self._end[:-1][ends[:-1]], self._end[-1:]])
        return self._corners[onward]

    def _at(self, way: Array, side: Literal["left", "right"]) -> Array:
        """Directions (n, 3) at ways (n,) [m] along the path; where two pieces meet, of that on the `side`."""
        found = np.searchsorted(self._end, way, side=side)
        piece = np.minimum(found, len(self._end) - 1)
        rest = np.maximum(self._end[piece] - way, 0.0) / np.where(self._rate[piece] > 0.0, self._rate[piece], 1.0)
        return self._towards(piece, np.maximum(self._pieces.length[piece] - rest, 0.0))

    def _towards(self, piece: NDArray[np.int64], s: Array) -> Array:
        _, along = self._pieces.points(piece, s)
        sizes = norms(along[:, :3])
        return along[:, :3] / np.where(sizes > 0.0, sizes, 1.0)[:, None]
