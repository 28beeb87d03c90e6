"""Corners of a contour that are rounded or broken: LinuxCNC's words A and C in the contours of G70, G71 and G72.

Both begin and end where a circle of that radius touches the two sides; C goes straight between these points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from gcodesim.frozen import frozen
from gcodesim.rs274.lathe_outline import CLOSE, OutlinePart, Point, is_on, meetings, moved


@frozen(kw_only=False)
class ContourCorner:
    """How a corner is finished: the radius of the circle in it, and whether a straight line takes its place."""

    radius: float
    straight: bool = False


class NoRoomError(Exception):
    """The finish of a corner does not fit beside it; `corner` is its number."""

    def __init__(self, corner: int) -> None:
        super().__init__(f"no room at corner {corner}")
        self.corner = corner


def finished(stretches: Sequence[OutlinePart], corners: Sequence[ContourCorner | None]) -> list[OutlinePart]:
    """The outline with its corners finished; corner `k` is where stretch `k` ends."""
    kept: list[OutlinePart] = []
    for index, stretch in enumerate(stretches):
        corner = corners[index - 1] if index else None
        if corner is None:
            kept.append(stretch)
            continue
        before = kept.pop()
        between = _between(before, stretch, corner)
        if between is None:
            raise NoRoomError(index - 1)
        kept += [
            before.part(before.begin, between.begin),
            between,
            stretch.part(between.end, stretch.end),
        ]
    return kept


def _between(before: OutlinePart, after: OutlinePart, corner: ContourCorner) -> OutlinePart | None:
    if before.length_is_zero or after.length_is_zero:
        return None
    (ta, tb), (ua, ub) = before.way_at(before.end), after.way_at(after.begin)
    turn = ta * ub - tb * ua
    if abs(turn) <= CLOSE:
        return None
    sense = 1 if turn > 0.0 else -1
    one, other = moved(before, sense * corner.radius), moved(after, sense * corner.radius)
    centres = [] if one is None or other is None else meetings(one, other)
    if not centres:
        return None
    centre = min(centres, key=lambda point: math.dist(point, after.begin))
    begin, end = _touched(before, centre), _touched(after, centre)
    if not (is_on(before, begin) and is_on(after, end)):
        return None
    return OutlinePart(begin, end, after.rapid, centre, 0 if corner.straight else sense)


def _touched(stretch: OutlinePart, centre: Point) -> Point:
    """The point of a line or circle that is nearest to the centre of a circle that touches it."""
    if stretch.sense:
        (ca, cb), (a, b) = stretch.centre, centre
        share = stretch.radius / math.hypot(a - ca, b - cb)
        return (ca + share * (a - ca), cb + share * (b - cb))
    ta, tb = stretch.way_at(stretch.begin)
    way = (centre[0] - stretch.begin[0]) * ta + (centre[1] - stretch.begin[1]) * tb
    return (stretch.begin[0] + way * ta, stretch.begin[1] + way * tb)
