"""The outline of a body of revolution by lines and arcs, as cutters have it: from the tip outwards and up."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from gcodesim.arithmetic.elementary import atan2
from gcodesim.frozen import frozen

Point = tuple[float, float]
"""Radius and height [m]."""


@frozen
class OutlineArc:
    """A piece of an outline to (r, h) about a centre (r, h) [m]; `ccw` as seen with r to the right and h up."""

    to: Point
    centre: Point
    ccw: bool

    @property
    def radius(self) -> float:
        """[m]"""
        return math.hypot(self.to[0] - self.centre[0], self.to[1] - self.centre[1])

    def angles(self, start: Point) -> tuple[float, float]:
        """Angle of `start` about the centre, from +r, and the turn to the end [rad], negative if clockwise."""
        begin = float(atan2(start[1] - self.centre[1], start[0] - self.centre[0]))
        end = float(atan2(self.to[1] - self.centre[1], self.to[0] - self.centre[0]))
        return begin, (end - begin) % (2.0 * math.pi) if self.ccw else -((begin - end) % (2.0 * math.pi))


Outline = Sequence["Point | OutlineArc"]
"""A first point, then points and arcs to go on to; heights never fall."""


def end_of(piece: Point | OutlineArc) -> Point:
    """Where a piece ends."""
    return piece.to if isinstance(piece, OutlineArc) else piece


def steps_of(outline: Outline) -> Iterator[tuple[Point, Point | OutlineArc]]:
    """Each piece with the point where it begins."""
    at = end_of(outline[0])
    for piece in outline[1:]:
        yield at, piece
        at = end_of(piece)
