"""The outline that a cycle of lathes follows: lines and arcs in its half plane, and the outline beside it.

`a` points along the passes, ahead; `b` across them, out of the work. An outline goes ahead: `a` never falls.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Final

from gcodesim.arithmetic.scalars import atan2
from gcodesim.frozen import frozen

Point = tuple[float, float]

CLOSE: Final = 1e-9
"""Lengths [mm] up to this are rounding."""


@frozen(kw_only=False)
class OutlinePart:
    """A line, or an arc about `centre`, to the left (1) or to the right (-1); `sense` 0 is a line."""

    begin: Point
    end: Point
    rapid: bool = False
    centre: Point = (0.0, 0.0)
    sense: int = 0

    @property
    def radius(self) -> float:
        return math.hypot(self.begin[0] - self.centre[0], self.begin[1] - self.centre[1])

    @property
    def length_is_zero(self) -> bool:
        return math.hypot(self.end[0] - self.begin[0], self.end[1] - self.begin[1]) <= CLOSE

    def part(self, begin: Point, end: Point) -> OutlinePart:
        """The same from one of its points to another."""
        return OutlinePart(begin, end, self.rapid, self.centre, self.sense)

    def way_at(self, point: Point) -> Point:
        """Unit vector of its direction at a point."""
        if self.sense:
            ra, rb = point[0] - self.centre[0], point[1] - self.centre[1]
            along = (-self.sense * rb, self.sense * ra)
        else:
            along = (self.end[0] - self.begin[0], self.end[1] - self.begin[1])
        length = math.hypot(*along)
        return (along[0] / length, along[1] / length)

    def share_of(self, point: Point) -> float:
        """Where a point is that lies on its line or circle: 0 at the beginning, 1 at the end, other values beyond."""
        if not self.sense:
            da, db = self.end[0] - self.begin[0], self.end[1] - self.begin[1]
            return ((point[0] - self.begin[0]) * da + (point[1] - self.begin[1]) * db) / (da * da + db * db)
        whole, there = _turn(self, self.end), _turn(self, point)
        if there > 0.5 * (whole + 2.0 * math.pi):  # before the beginning rather than behind the end
            there -= 2.0 * math.pi
        return there / whole


def _turn(arc: OutlinePart, point: Point) -> float:
    """Angle [rad] from the beginning of an arc to a point of its circle, 0 to 2 pi."""
    (ca, cb), (a, b) = arc.centre, arc.begin
    angle = arc.sense * (atan2(point[1] - cb, point[0] - ca) - atan2(b - cb, a - ca)) % (2.0 * math.pi)
    return 0.0 if 2.0 * math.pi - angle <= CLOSE else angle


def goes_ahead(stretch: OutlinePart) -> bool:
    """Whether `a` never falls on the way."""
    return all(part.end[0] >= part.begin[0] - CLOSE for part in _split(stretch, 0))


def rising_and_falling(stretches: Iterable[OutlinePart]) -> list[OutlinePart]:
    """The same outline in parts of which each only rises or only falls."""
    return [part for stretch in stretches for part in _split(stretch, 1)]


def _split(stretch: OutlinePart, axis: int) -> list[OutlinePart]:
    """Parts between the places where an arc turns back in one of the two coordinates."""
    if not stretch.sense:
        return [stretch]
    radius, centre = stretch.radius, stretch.centre
    found = []
    for side in (-radius, radius):
        point = (centre[0] + side, centre[1]) if axis == 0 else (centre[0], centre[1] + side)
        share = stretch.share_of(point)
        if CLOSE < share < 1.0 - CLOSE:
            found.append((share, point))
    points = [stretch.begin, *(point for _, point in sorted(found)), stretch.end]
    return [stretch.part(begin, end) for begin, end in pairwise(points)]


def at_level(stretch: OutlinePart, level: float) -> Point:
    """The point of a part that only rises or only falls, and reaches `level`, where it does so."""
    (a0, b0), (a1, b1) = stretch.begin, stretch.end
    if abs(level - b0) <= CLOSE:
        return stretch.begin
    if abs(level - b1) <= CLOSE:
        return stretch.end
    if not stretch.sense:
        return (a0 + (level - b0) / (b1 - b0) * (a1 - a0), level)
    ca, cb = stretch.centre
    half = math.sqrt(max(stretch.radius * stretch.radius - (level - cb) * (level - cb), 0.0))
    before, after = ca - half, ca + half
    middle = 0.5 * (a0 + a1)
    return (before if abs(before - middle) < abs(after - middle) else after, level)


def beside(outline: Sequence[OutlinePart], distance: float) -> list[OutlinePart]:
    """The outline at `distance` to its left; around corners that point there by an arc.

    What the distance leaves no room for, as of a fillet with a smaller radius, is not there.
    """
    if not distance:
        return list(outline)
    kept: list[OutlinePart] = []
    before: OutlinePart | None = None
    for stretch in outline:
        if stretch.length_is_zero:
            continue
        aside = moved(stretch, distance)
        if before is not None:
            corner = _around(before, stretch, distance)
            if corner is not None:
                _join(kept, corner)
        if aside is not None:
            _join(kept, aside)
        before = stretch
    return kept


def moved(stretch: OutlinePart, distance: float) -> OutlinePart | None:
    """One line or arc, moved to its left; None for an arc that vanishes."""
    if stretch.sense:
        radius = stretch.radius
        left = radius - stretch.sense * distance
        if left <= CLOSE:
            return None
        (ca, cb), share = stretch.centre, left / radius
        ends = [(ca + share * (a - ca), cb + share * (b - cb)) for a, b in (stretch.begin, stretch.end)]
        return stretch.part(*ends)
    ta, tb = stretch.way_at(stretch.begin)
    na, nb = -tb * distance, ta * distance
    (a0, b0), (a1, b1) = stretch.begin, stretch.end
    return stretch.part((a0 + na, b0 + nb), (a1 + na, b1 + nb))


def _around(before: OutlinePart, after: OutlinePart, distance: float) -> OutlinePart | None:
    """The arc around the corner between two, if it points to where the outline is moved."""
    (ta, tb), (ua, ub) = before.way_at(before.end), after.way_at(after.begin)
    turn = ta * ub - tb * ua
    if turn * distance >= -CLOSE * abs(distance):
        return None
    a, b = after.begin
    begin, end = (a - tb * distance, b + ta * distance), (a - ub * distance, b + ua * distance)
    return OutlinePart(begin, end, after.rapid, (a, b), -1 if distance > 0.0 else 1)


def _join(kept: list[OutlinePart], new: OutlinePart) -> None:
    """Add a part to those that are `kept`, each ended where the next begins."""
    if kept and math.hypot(kept[-1].end[0] - new.begin[0], kept[-1].end[1] - new.begin[1]) <= 1e3 * CLOSE:
        kept.append(new)
        return
    for count in range(len(kept), 0, -1):
        last = kept[count - 1]
        if last.length_is_zero:
            continue
        meets = [point for point in meetings(last, new) if is_on(last, point) and is_on(new, point)]
        if meets:
            point = min(meets, key=last.share_of)
            del kept[count:]
            kept[-1] = last.part(last.begin, point)
            new = new.part(point, new.end)
            break
    kept.append(new)


def is_on(stretch: OutlinePart, point: Point) -> bool:
    """Whether a point of its line or circle lies between its ends."""
    return -1e-6 <= stretch.share_of(point) <= 1.0 + 1e-6


def meetings(one: OutlinePart, other: OutlinePart) -> list[Point]:
    """Where the lines or circles of two parts meet."""
    if not one.sense and not other.sense:
        (a, b), (ta, tb), (c, d), (ua, ub) = one.begin, one.way_at(one.begin), other.begin, other.way_at(other.begin)
        cross = ta * ub - tb * ua
        if abs(cross) <= CLOSE:
            return []
        way = ((c - a) * ub - (d - b) * ua) / cross
        return [(a + way * ta, b + way * tb)]
    if one.sense and other.sense:
        (a, b), (c, d), r, s = one.centre, other.centre, one.radius, other.radius
        apart = math.hypot(c - a, d - b)
        if apart <= CLOSE:
            return []
        along = (apart * apart + r * r - s * s) / (2.0 * apart)
        ta, tb = (c - a) / apart, (d - b) / apart
    else:
        line, arc = (other, one) if one.sense else (one, other)
        (a, b), r = arc.centre, arc.radius
        ua, ub = line.way_at(line.begin)
        ta, tb = -ub, ua
        along = (line.begin[0] - a) * ta + (line.begin[1] - b) * tb
    square = r * r - along * along
    if square < -CLOSE:
        return []
    half = math.sqrt(max(square, 0.0))
    ma, mb = a + along * ta, b + along * tb
    return [(ma - half * tb, mb + half * ta), (ma + half * tb, mb - half * ta)]
