"""The passes of roughing cycles of lathes: a contour, an allowance, and cuts of even depth above it.

Everything is in the half plane of the cut: `a` along the passes, `b` across them, away from the work (G71: a = Z,
b = X; G72 the other way round; inside cuts with the sign of X turned).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from gcodesim.arithmetic.scalars import atan2, cos, sin
from gcodesim.frozen import frozen

Point = tuple[float, float]
Step = tuple[bool, float, float]
"""A move of a cycle: whether it is a rapid, and its end."""

_CHORD: Final = math.radians(2.0)
_CLOSE: Final = 1e-9
_MOST_PASSES: Final = 100_000


@frozen(kw_only=False)
class ContourMove:
    """One move of a contour: its end, and for arcs centre and sense (1: from +a to +b), 0 for a straight one."""

    end: Point
    rapid: bool = False
    centre: Point = (0.0, 0.0)
    sense: int = 0


def chords(start: Point, moves: Sequence[ContourMove]) -> list[Point]:
    """The contour as points; arcs by chords of 2 degrees."""
    points = [start]
    for move in moves:
        if move.sense:
            (ca, cb), (a, b) = move.centre, points[-1]
            radius = math.hypot(a - ca, b - cb)
            begin, end = atan2(b - cb, a - ca), atan2(move.end[1] - cb, move.end[0] - ca)
            sweep = (end - begin) * move.sense % (2.0 * math.pi)
            parts = max(1, math.ceil(sweep / _CHORD))
            for k in range(1, parts):
                angle = begin + move.sense * sweep * k / parts
                points.append((ca + radius * cos(angle), cb + radius * sin(angle)))
        points.append(move.end)
    return points


def passes(contour: Sequence[Point], start: Point, depth: float, escape: float, *, pockets: bool) -> list[Step]:
    """The cuts of `depth` above a contour from `start`, each ended by an escape of 45 degrees and a way back.

    Without `pockets` each pass ends where it first meets the contour. The contour lies below `start`. It goes ahead to
    its farthest point along `a`; what comes after that, as a last block back to before the face, is a way out.
    """
    contour = _to_the_farthest(contour)
    ahead = 1.0 if contour[-1][0] >= contour[0][0] else -1.0
    lowest = min(b for _, b in contour)
    found: list[Step] = []
    level = start[1]
    for _ in range(_MOST_PASSES):
        level -= depth
        if level <= lowest + _CLOSE:
            break
        cuts = _free(contour, level, start[0], ahead)
        for begin, end in cuts if pockets else cuts[:1]:
            if begin == start[0]:
                found.append((True, begin, level))
            else:
                down = min(level + depth + escape, start[1])
                found += [(True, begin, start[1]), (True, begin, down), (False, begin, level)]
            away = min(escape, 0.5 * abs(end - begin))
            found += [
                (False, end, level),
                (True, end - ahead * away, level + escape),
                (True, begin, level + escape),
            ]
            if begin != start[0]:  # out of the pocket, from which no straight way leads to the next cut
                found.append((True, begin, start[1]))
    return found


def _to_the_farthest(contour: Sequence[Point]) -> Sequence[Point]:
    """The contour up to the last of its points that is farthest along `a` from the first."""
    begin = contour[0][0]
    farthest = max(abs(a - begin) for a, _ in contour)
    last = max(k for k, (a, _) in enumerate(contour) if abs(a - begin) >= farthest - _CLOSE)
    return contour[: last + 1] if farthest > _CLOSE else contour


def _free(contour: Sequence[Point], level: float, begin: float, ahead: float) -> list[Point]:
    """Where along `a` there is work above the contour at a level, in the order of the cut: from `begin` on."""
    meets: list[float] = []
    for (a0, b0), (a1, b1) in pairwise(contour):
        if (b0 - level) * (b1 - level) < 0.0:
            meets.append(a0 + (level - b0) / (b1 - b0) * (a1 - a0))
        elif b1 == level != b0:
            meets.append(a1)
    beyond = contour[-1][0]
    below = contour[0][1] < level
    ways, at = [], begin if below else None
    for meet in sorted(set(meets), key=lambda a: a * ahead):
        if at is None:
            at = meet
        else:
            if (meet - at) * ahead > _CLOSE:
                ways.append((at, meet))
            at = None
    if at is not None and (beyond - at) * ahead > _CLOSE:
        ways.append((at, beyond))
    return ways
