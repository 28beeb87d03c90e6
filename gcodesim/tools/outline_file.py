"""The half section of a form cutter from a drawing: lines and arcs of a DXF or SVG file, chained from the tip upwards.

The axis of the tool is the line x = 0 of the drawing. What is drawn left of it, as the other half of a whole section,
does not count, nor do lines along the axis and the one that closes the section at its top.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from math import dist, isfinite, sqrt
from typing import Final, NamedTuple

from gcodesim.arithmetic.elementary import atan2, cos_sin
from gcodesim.frozen import frozen
from gcodesim.solids.turned import OutlineArc, Point

JOINED: Final = 2e-6
"""Ends [m] that are nearer than this are one point; drawings round to a thousandth of a millimetre."""


class DrawingError(Exception):
    """A drawing that is no outline; the text says why."""


class StrokeArc(NamedTuple):
    """The circle that a stroke follows."""

    centre: Point
    ccw: bool


@frozen(kw_only=False)
class Stroke:
    """A line, or an arc, of a drawing with y upwards [m]."""

    start: Point
    end: Point
    arc: StrokeArc | None = None

    @property
    def reversed(self) -> Stroke:
        arc = None if self.arc is None else StrokeArc(self.arc.centre, not self.arc.ccw)
        return Stroke(self.end, self.start, arc)

    @property
    def piece(self) -> Point | OutlineArc:
        """What an outline goes on with along it."""
        if self.arc is None:
            return self.end
        return OutlineArc(to=self.end, centre=self.arc.centre, ccw=self.arc.ccw)


def bulged(start: Point, end: Point, bulge: float) -> Stroke:
    """A stroke of a polyline of DXF: `bulge` is the tangent of a quarter of the turn, positive counter-clockwise."""
    if bulge == 0.0:
        return Stroke(start, end)
    along = (end[0] - start[0], end[1] - start[1])
    aside = (1.0 - bulge * bulge) / (4.0 * bulge)
    centre = (
        0.5 * (start[0] + end[0]) - aside * along[1],
        0.5 * (start[1] + end[1]) + aside * along[0],
    )
    return Stroke(start, end, StrokeArc(centre, bulge > 0.0))


def turned_about(centre: Point, radius: float, begin: float, end: float) -> list[Stroke]:
    """Counter-clockwise from angle `begin` to `end` [rad], a whole circle in two strokes."""
    turn = (end - begin) % _TURN or _TURN
    parts = 2 if turn > 0.75 * _TURN else 1
    ends = [_on(centre, radius, begin + turn * k / parts) for k in range(parts + 1)]
    return [Stroke(a, b, StrokeArc(centre, True)) for a, b in itertools.pairwise(ends)]


_TURN: Final = 8.0 * float(atan2(1.0, 1.0))


def _on(centre: Point, radius: float, angle: float) -> Point:
    cosine, sine = cos_sin(angle)
    return centre[0] + radius * float(cosine), centre[1] + radius * float(sine)


def outline_of(strokes: Sequence[Stroke]) -> tuple[Point | OutlineArc, ...]:
    """The outline from the tip `(0, 0)` to the top; DrawingError if the strokes are no half section."""
    if not all(isfinite(value) for stroke in strokes for value in (*stroke.start, *stroke.end)):
        raise DrawingError("a coordinate is not finite")
    right = [part for stroke in strokes for part in _right_of_axis(stroke)]
    left = [part for part in right if not (part.start[0] <= JOINED and part.end[0] <= JOINED and part.arc is None)]
    if not left:
        raise DrawingError("nothing is drawn right of the axis, x = 0")
    on_axis = [end for stroke in left for end in (stroke.start, stroke.end) if abs(end[0]) <= JOINED]
    if not on_axis:
        raise DrawingError("no line begins on the axis, x = 0, at the tip")
    tip = min(on_axis, key=lambda end: end[1])
    at = tip
    pieces: list[Point | OutlineArc] = []
    while left:
        following = next((s for s in left if _same(s.start, at) or _same(s.end, at)), None)
        if following is None:
            break
        left.remove(following)
        own = following if _same(following.start, at) else following.reversed
        if pieces and own.arc is None and abs(own.end[0]) <= JOINED:
            left = [s for s in left if not _same(s.start, at) and not _same(s.end, at)]
            at = own.end
            break  # back to the axis: the section is closed at its top
        pieces.append(own.piece)
        at = own.end
    if left:
        x, y = left[0].start
        raise DrawingError(
            f"the lines are no single chain from the tip: one at x {x * 1e3:.3f} y {y * 1e3:.3f} mm is not joined to it"
        )
    return ((0.0, 0.0), *(_lowered(piece, tip[1]) for piece in pieces))


def _same(a: Point, b: Point) -> bool:
    return dist(a, b) <= JOINED


def _lowered(piece: Point | OutlineArc, by: float) -> Point | OutlineArc:
    if isinstance(piece, OutlineArc):
        to, centre = _lowered(piece.to, by), _lowered(piece.centre, by)
        assert not isinstance(to, OutlineArc) and not isinstance(centre, OutlineArc)
        return OutlineArc(to=to, centre=centre, ccw=piece.ccw)
    r, h = piece
    return (0.0 if abs(r) <= JOINED else r, h - by)


def _right_of_axis(stroke: Stroke) -> list[Stroke]:
    """The parts of a stroke with x >= 0."""
    ends = [stroke.start, *_crossings(stroke), stroke.end]
    parts = [Stroke(a, b, stroke.arc) for a, b in itertools.pairwise(ends) if not _same(a, b)]
    return [part for part in parts if _middle(part)[0] > -JOINED]


def _middle(stroke: Stroke) -> Point:
    (ax, ay), (bx, by) = stroke.start, stroke.end
    if stroke.arc is None:
        return 0.5 * (ax + bx), 0.5 * (ay + by)
    whole = OutlineArc(to=stroke.end, centre=stroke.arc.centre, ccw=stroke.arc.ccw)
    begin, turn = whole.angles(stroke.start)
    return _on(stroke.arc.centre, whole.radius, begin + 0.5 * turn)


def _crossings(stroke: Stroke) -> list[Point]:
    """Where a stroke goes through the axis, in its order."""
    (ax, ay), (bx, by) = stroke.start, stroke.end
    if stroke.arc is None:
        if min(ax, bx) >= -JOINED or max(ax, bx) <= JOINED:
            return []
        return [(0.0, ay + (by - ay) * ax / (ax - bx))]
    (cx, cy), _ = stroke.arc
    whole = OutlineArc(to=stroke.end, centre=stroke.arc.centre, ccw=stroke.arc.ccw)
    half = whole.radius * whole.radius - cx * cx
    if half <= 0.0:
        return []
    begin, turn = whole.angles(stroke.start)
    found = []
    for y in (cy - sqrt(half), cy + sqrt(half)):
        way = float(atan2(y - cy, -cx)) - begin
        way = way % _TURN if turn > 0.0 else -((-way) % _TURN)
        if 1e-6 < way / turn < 1.0 - 1e-6:
            found.append((way / turn, (0.0, y)))
    return [point for _, point in sorted(found)]
