"""What all tools of a lathe have in common: an outline in the half plane of the spindle, and where they are driven.

Outlines are convex, counter-clockwise (m, 2) in (z, r) [m], seen from the programmed point, with r = X as a radius.
Orientations are those of LinuxCNC's tool table: 1 to 4 have the nose at the corners of a square, 5 to 8 in the middle
of its sides, at 0 and 9 the middle of the nose is driven.
"""

from __future__ import annotations

from math import ceil, pi
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Range
from gcodesim.declarations.plain_kinds import Whole
from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Cylinder, Placed
from gcodesim.tools.body import Primitive
from gcodesim.tools.teeth import RAKE
from gcodesim.tools.tool import Tool
from gcodesim.units import DEG, MM

Array = NDArray[np.float64]

NOSE_CENTRES: Final = {
    0: (0, 0),
    1: (-1, 1),
    2: (1, 1),
    3: (1, -1),
    4: (-1, -1),
    5: (-1, 0),
    6: (0, 1),
    7: (1, 0),
    8: (0, -1),
    9: (0, 0),
}
"""Where the middle of the nose is from the programmed point, in radii along Z and X, by orientation."""

REACH: Final = 150.0 * MM
"""Length of the edges of a tool of which only the tip is described."""

_TURN: Final = 4.0 * DEG  # of a nose, from corner to corner of its outline: 0.5 um on a radius of 0.8 mm
_ASIDE: Final = 1.0 * MM
_LEANS: Final = 3.0 * DEG  # how far a holder stays behind the edges of its insert

ORIENTATION = Whole(Range(least=0, most=9))


@frozen
class LatheTool(Tool):
    """A tool that stands still while the work turns."""

    process: ClassVar[str] = "turning"
    inside: ClassVar[bool] = False

    rake: float | None = key(
        RAKE,
        "of its edge, which corrects forces (1 % a degree)",
        default=None,
        rule="as the table of the material has it",
    )

    @property
    def blade(self) -> Array:
        """The outline of what cuts."""
        raise NotImplementedError

    @property
    def main_edges(self) -> NDArray[np.bool_]:
        """Edges (m,) of `blade`, from point i to point i + 1, that may cut; any other that does is a gouge."""
        raise NotImplementedError

    @property
    def behind(self) -> int:
        """The side along Z (1, -1, or 0: none) to which the tip leaves what it has made."""
        return 0

    @property
    def shank(self) -> Array:
        """The outline of what holds the blade; (0, 2) if it is not described."""
        return np.zeros((0, 2))

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """A bar along the spindle beside the tip, on the side away from the work; for drawing."""
        low, high = self.blade.min(axis=0), self.blade.max(axis=0)
        half = max(1.0 * MM, min(8.0 * MM, 0.25 * float(min(high - low))))
        aside = -half if self.inside else half
        solid = Cylinder(radius=half, bottom=-self.length, top=0.0)
        bar = Primitive("cutting", Placed(solid, Pose(np.array([aside, 0.0, 0.0]), np.eye(3))))
        return (bar, *self._holder_bodies())


def wedge(
    front: float, back: float, nose: float, edge: float, orientation: int
) -> tuple[Array, NDArray[np.bool_], tuple[float, float]]:
    """The outline of a tip, which of its edges are the main one and the nose, and the middle of the nose.

    `front` and `back` [rad] are the directions of both edges away from the nose, from +Z towards +X, as in LinuxCNC's
    tool table; `edge` is their length.
    """
    ways = NOSE_CENTRES[orientation]
    cz, cr = ways[0] * nose, ways[1] * nose
    low, high = min(front, back), max(front, back)
    if high - low > pi:
        low, high = high, low + 2.0 * pi
    at_low = (cz + nose * sin(low), cr - nose * cos(low))
    at_high = (cz - nose * sin(high), cr + nose * cos(high))
    points = [(at_high[0] + edge * cos(high), at_high[1] + edge * sin(high)), at_high]
    sweep = pi - (high - low)
    parts = max(1, ceil(sweep / _TURN)) if nose > 0.0 else 0
    for k in range(1, parts):
        angle = high + 0.5 * pi + sweep * k / parts
        points.append((cz + nose * cos(angle), cr + nose * sin(angle)))
    if nose > 0.0:
        points.append(at_low)
    points.append((at_low[0] + edge * cos(low), at_low[1] + edge * sin(low)))
    count = len(points)
    main = np.ones(count, dtype=bool)
    main[-1] = False  # from end to end of both edges
    is_back = 0 if abs(_apart(back, high)) < 1e-9 else count - 2
    main[is_back] = False
    return np.array(points, dtype=float), main, (float(cz), float(cr))


def _apart(a: float, b: float) -> float:
    return (a - b + pi) % (2.0 * pi) - pi


def angles_of_edges(front: float, back: float, orientation: int) -> tuple[float | None, float]:
    """Lead angle and tip angle [rad] of edges that lead away from the nose in these directions [rad].

    Directions count from +Z towards +X, as I and J of LinuxCNC's tool table do. A tip in the middle has no lead angle.
    """
    ways = NOSE_CENTRES[orientation]
    if not (ways[0] and ways[1]):
        apart = (front - back) % (2.0 * pi)
        return None, min(apart, 2.0 * pi - apart)
    if ways[1] < 0:
        front, back = -front, -back
    if ways[0] < 0:
        front, back = pi - front, pi - back
    return (pi - front) % (2.0 * pi), (front - back) % (2.0 * pi)


def behind(front: float, back: float, centre: tuple[float, float], nose: float, width: float) -> Array:
    """The outline of a holder behind both edges of an insert: a little aside, `width` wide along the back edge."""
    low, high = min(front, back), max(front, back)
    if high - low > pi:
        low, high = high, low + 2.0 * pi
    if high - low <= 2.0 * _LEANS + 2.0 * DEG:
        return np.zeros((0, 2))
    middle = 0.5 * (low + high)
    deep = (nose + _ASIDE) / max(0.05, float(sin(0.5 * (high - low))))
    p = (centre[0] + deep * cos(middle), centre[1] + deep * sin(middle))
    low, high = low + _LEANS, high - _LEANS
    far = REACH
    a = (p[0] + far * cos(low), p[1] + far * sin(low))
    b = (p[0] + far * cos(high), p[1] + far * sin(high))
    if abs(_apart(back, low - _LEANS)) < 1e-9:
        a = (p[0] + width * cos(low), p[1] + width * sin(low))
        c = (a[0] + far * cos(high), a[1] + far * sin(high))
        return np.array([p, a, c, b], dtype=float)
    b = (p[0] + width * cos(high), p[1] + width * sin(high))
    c = (b[0] + far * cos(low), b[1] + far * sin(low))
    return np.array([p, a, c, b], dtype=float)
