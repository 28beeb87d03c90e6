"""Feeds per turn of a spindle that keeps the cutting speed (G96): they change with the radius on the way.

Such a move becomes rows that are short enough for an even feed; the feed of each takes exactly the time that the
changing one takes.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import ceil, pi
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import cos, log, power, sin
from gcodesim.arithmetic.matrices import dot, norm
from gcodesim.canon import ArcFeed, Axes
from gcodesim.frozen import frozen

_EVEN: Final = 0.05
"""By how much of it the feed may change within a row."""

_MOST: Final = 200  # rows of a move
_LEAST_RADIUS: Final = 1e-6


@frozen(kw_only=False)
class Pace:
    """A spindle that keeps the cutting speed `surface` [m/s] as long as it need not turn faster than `cap` [rad/s].

    It turns about `centre`, an X [m].
    """

    surface: float
    cap: float
    centre: float = 0.0

    def turns(self, radius: float) -> float:
        """Turns a second at a radius [m]."""
        wanted = self.surface / max(radius, _LEAST_RADIUS)
        return (min(wanted, self.cap) if self.cap > 0.0 else wanted) / (2.0 * pi)

    @property
    def knee(self) -> float:
        """The radius [m] below which the spindle turns as fast as it may."""
        return self.surface / self.cap if self.cap > 0.0 else _LEAST_RADIUS

    def mean(self, a: float, b: float) -> float:
        """The turns a second with which a way on which the radius goes evenly from `a` to `b` takes its time.

        The time is that of the integral of 1 / turns, which is even below the knee and grows with the radius above it.
        """
        low, high = sorted((abs(a), abs(b)))
        if a * b < 0.0:  # through the axis
            low = 0.0
            share = abs(a) / (abs(a) + abs(b))
            return 1.0 / (share / self.mean(0.0, abs(a)) + (1.0 - share) / self.mean(0.0, abs(b)))
        if high - low < 1e-12:
            return self.turns(high)
        knee = min(max(self.knee, low), high)
        below = (knee - low) / self.turns(min(self.knee, high)) if knee > low else 0.0
        above = pi * (high * high - knee * knee) / self.surface
        return float((high - low) / (below + above))


def _shares(pace: Pace, a: float, b: float) -> list[float]:
    """Where to divide a way on which the radius goes from `a` to `b`, so that the speed is even in each part."""
    low, high = sorted((max(abs(a), pace.knee), max(abs(b), pace.knee)))
    parts = 1 if high <= low else min(_MOST, ceil(log(high / low) / _EVEN))
    if parts == 1 or a == b:
        return [0.0, 1.0]
    radii = [low * float(power(high / low, k / parts)) for k in range(parts + 1)]
    sign = -1.0 if a + b < 0.0 else 1.0
    inner = sorted((sign * r - a) / (b - a) for r in radii)
    return [0.0, *(t for t in inner if 1e-9 < t < 1.0 - 1e-9), 1.0]


def along_line(start: Axes, end: Axes, feed: float, pace: Pace) -> Iterator[tuple[Axes, float]]:
    """The ends and feeds [m/s] of the rows of a straight move; `feed` in m/turn."""
    first, way = start[0] - pace.centre, end[0] - start[0]
    shares = _shares(pace, first, first + way)
    for before, after in pairwise(shares):
        here = end if after == 1.0 else _between(start, end, after)
        a, b = (first + t * way for t in (before, after))
        yield here, feed * pace.mean(a, b)


def along_arc(start: Axes, arc: ArcFeed, pace: Pace) -> Iterator[tuple[Axes, float, float]]:
    """The ends, sweeps [rad] and feeds [m/s] of the rows of an arc; each turns by no more than 5 degrees."""
    parts = max(1, ceil(abs(arc.sweep) / np.radians(5.0)))
    p, c, n = (np.array(v[:3], dtype=float) for v in (start, arc.center, arc.normal))
    along = dot(p - c, n) * n
    u = p - c - along
    v = np.array([n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]])
    rise = dot(np.array(arc.end[:3], dtype=float) - p, n)
    growth = norm(np.array(arc.end[:3]) - c - along - rise * n) / max(norm(u), 1e-12)
    before = start
    for k in range(1, parts + 1):
        share = k / parts
        if k == parts:
            here = arc.end
        else:
            angle = share * arc.sweep
            q = c + along + (1.0 + share * (growth - 1.0)) * (u * cos(angle) + v * sin(angle)) + share * rise * n
            here = (*(float(x) for x in q), *_between(start, arc.end, share)[3:])  # type: ignore[assignment]
        yield here, arc.sweep / parts, arc.feed * pace.mean(before[0] - pace.centre, here[0] - pace.centre)
        before = here


def _between(start: Axes, end: Axes, share: float) -> Axes:
    return tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))  # type: ignore[return-value]
