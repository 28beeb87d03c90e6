"""Tools against fixtures: the body of the tool, swept along its path, against convex bodies; needs no world.

All points are in one frame, in which the fixtures stand still (W, or the table
of a machine that moves it). Path pieces are straight; arcs come as chords, with
an error that is the chord's.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.checks.pairs import may_not_meet, role_of_part
from gcodesim.diagnostics import Diagnostic, Span
from gcodesim.diagnostics.events import runs
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.scene import Role
from gcodesim.solids import Hull, Placed, facets_of, hulls_of, outline_of
from gcodesim.tools.parts import body_part
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

# bodies that enter each other by less than this only touch [m]
TOUCH: Final = 1e-6
_SAME: Final = 1e-9  # [m] between places that are one
_BUNCH: Final = 64  # neighbouring pieces that are compared with a hull as one
_AT_ONCE: Final = 1024  # triangles for one call, so that a Ctrl-C is heard between two


@frozen(slots=False, eq=False)
class Obstacle:
    """Something that must not be touched, as convex bodies: hulls, and then triangles of `facets` (t, 3, 3) [m]."""

    name: str
    hulls: tuple[Hull, ...]
    facets: Array

    @staticmethod
    def of(name: str, solids: Sequence[Placed]) -> Obstacle:
        """Solids in the frame in which the tool moves."""
        facets = np.concatenate([np.zeros((0, 3, 3)), *map(facets_of, solids)])
        return Obstacle(name=name, hulls=tuple(hull for placed in solids for hull in hulls_of(placed)), facets=facets)

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Upright boxes around the convex bodies, least and greatest corners (k, 3)."""
        low = np.array([hull.corners.min(axis=0) for hull in self.hulls]).reshape(-1, 3)
        high = np.array([hull.corners.max(axis=0) for hull in self.hulls]).reshape(-1, 3)
        return np.concatenate([low, self.facets.min(axis=1)]), np.concatenate([high, self.facets.max(axis=1)])


@frozen(eq=False)
class ToolParts:
    """A tool as convex bodies of revolution.

    `outlines` are parts (cutting, shank, holder, nozzle …) with points (k, 2): radius and height above the tip [m]. A
    part that is not convex, such as a holder with a collar, is there several times.
    """

    name: str
    outlines: tuple[tuple[str, Array], ...]

    @staticmethod
    def of(tool: Tool) -> ToolParts:
        """The parts of a tool of the cell."""
        points: dict[str, list[Array]] = {}
        for body in tool.round_parts:
            outline = outline_of(body.solid)
            outline[:, 1] = -(outline[:, 1] + body.placed.X.p[2])
            points.setdefault(body.part, []).append(outline)
        found = [(part, outline) for part, rows in points.items() for outline in _convex(rows)]
        return ToolParts(name=tool.name, outlines=tuple(found))

    def against(self, role: Role) -> ToolParts:
        """The parts that may not enter a body of this role."""
        parts = [one for one in self.outlines if may_not_meet(role_of_part(one[0]), role)]
        return replace(self, outlines=tuple(parts))


def _convex(outlines: list[Array]) -> list[Array]:
    """Bodies on one axis (k, 2) as few convex ones: neighbours are joined where nothing is added."""
    found: list[list[Array]] = []
    for outline in sorted(outlines, key=lambda one: float(one[:, 1].min())):
        if found and _is_convex([*found[-1], outline]):
            found[-1].append(outline)
        else:
            found.append([outline])
    return [np.concatenate(group) for group in found]


def _is_convex(outlines: list[Array]) -> bool:
    """Whether bodies (k, 2) on one axis fill their hull: its radius is theirs between all heights of their corners."""
    points = np.concatenate(outlines)
    heights = np.unique(points[:, 1])
    middle = 0.5 * (heights[:-1] + heights[1:])
    wide, hull = np.zeros_like(middle), np.zeros_like(middle)
    for outline in outlines:
        up = outline[np.argsort(outline[:, 1], kind="stable")]
        wide = np.maximum(wide, np.interp(middle, up[:, 1], up[:, 0], left=0.0, right=0.0))
    for r, z in points:  # the hull's radius at a height is the greatest on a chord across it
        share = (middle[:, None] - z) / (points[None, :, 1] - z + (points[None, :, 1] == z))
        on = (share >= 0.0) & (share <= 1.0) & (points[None, :, 1] != z)
        hull = np.maximum(hull, np.where(on, r + share * (points[None, :, 0] - r), 0.0).max(axis=1))
    return bool(np.all(hull <= wide + TOUCH))


@frozen
class Touch:
    """One event: from piece `piece` on, at `share` of it, `part` of `tool` is in `fixture`.

    `tip` [m] is where the tip is at first contact, `depth` [m] the greatest of
    the event, `pieces` how many path pieces it lasts.
    """

    tool: str
    part: str
    fixture: str
    piece: int
    share: float
    tip: tuple[float, float, float]
    depth: float
    pieces: int


def fixture_touches(
    tool: ToolParts, fixtures: Iterable[Obstacle], start: Array, end: Array, axis: Array
) -> list[Touch]:
    """Every event in which `tool` enters a fixture while its tip goes from `start` to `end` (m, 3), piece by piece.

    `axis` (m, 3) is the unit vector from the tip to the holder. An event is a
    run of pieces in which some part is inside one fixture; the part that comes
    first gives it its name.
    """
    start, end, axis = (np.ascontiguousarray(v, dtype=float) for v in (start, end, axis))
    found = []
    for fixture in fixtures:
        depths = np.zeros((len(tool.outlines), len(start)))
        shares = np.ones_like(depths)
        for part, (_, outline) in enumerate(tool.outlines):
            _enter(outline, fixture, start, end, axis, depths[part], shares[part])
        inside_at = depths.max(axis=0, initial=0.0) > 0.0
        for rows in runs(inside_at, group=_visits(tool, fixture, start, end, axis, inside_at)):
            piece = int(rows[0])
            inside = depths[:, piece] > 0.0
            part = int(np.lexsort((-depths[:, piece], np.where(inside, shares[:, piece], np.inf)))[0])
            share = float(shares[part, piece])
            tip = start[piece] + share * (end[piece] - start[piece])
            found.append(
                Touch(
                    tool=tool.name,
                    part=tool.outlines[part][0],
                    fixture=fixture.name,
                    piece=piece,
                    share=share,
                    tip=(float(tip[0]), float(tip[1]), float(tip[2])),
                    depth=float(depths[:, rows].max()),
                    pieces=len(rows),
                )
            )
    return sorted(found, key=lambda touch: (touch.piece, touch.share, touch.fixture))


def _visits(
    tool: ToolParts, fixture: Obstacle, start: Array, end: Array, axis: Array, inside: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """A number (m,) for each piece that rises where `tool` is out of a fixture between two pieces that are `inside`."""
    borders = np.flatnonzero(inside[:-1] & inside[1:])
    if not len(borders):
        return np.zeros(len(inside), dtype=np.int64)
    here, depth = end[borders], np.zeros(len(borders))
    for _, outline in tool.outlines:
        _enter(outline, fixture, here, here, axis[borders], depth, np.ones(len(borders)))
    out = (depth <= 0.0) | (norms(start[borders + 1] - here) > _SAME)
    rises = np.zeros(len(inside), dtype=np.int64)
    rises[borders[out] + 1] = 1
    return np.cumsum(rises)


def _enter(
    outline: Array, fixture: Obstacle, start: Array, end: Array, axis: Array, depth: Array, share: Array
) -> None:
    """Raise `depth` (m,) of each piece to that of `outline` in `fixture`, and lower `share` (m,) to first contact."""
    from gcodesim.checks.collision_kernels import Crossing, facet_touches, touches

    low, high = _boxes(outline, start, end, axis)
    hull_low, hull_high = fixture.boxes
    if not len(hull_low):
        return
    whole: NDArray[np.bool_] = np.all(low < hull_high.max(axis=0), axis=1)
    whole &= np.all(high > hull_low.min(axis=0), axis=1)
    near = np.flatnonzero(whole)
    if not len(near):
        return
    # bunches of pieces first, then the pieces of those bunches that come near a hull
    begin = np.arange(0, len(near), _BUNCH)
    bunch_low, bunch_high = np.minimum.reduceat(low[near], begin), np.maximum.reduceat(high[near], begin)
    crossed = _crossed(hull_low, hull_high, bunch_low, bunch_high)
    hulls = crossed[crossed < len(fixture.hulls)]
    for number in hulls.tolist():
        hull, hull_from, hull_to = fixture.hulls[number], hull_low[number], hull_high[number]
        bunches = begin[np.all(bunch_low < hull_to, axis=1) & np.all(bunch_high > hull_from, axis=1)]
        places = (bunches[:, None] + np.arange(_BUNCH)).ravel()
        some = near[places[places < len(near)]]
        piece = some[np.all(low[some] < hull_to, axis=1) & np.all(high[some] > hull_from, axis=1)].astype(np.int64)
        touches(piece, outline, axis, start, end, hull.corners, hull.normals, TOUCH, share, depth)
    facets = crossed[len(hulls) :] - len(fixture.hulls)
    highest_first = _highest_first(fixture.facets[facets], axis[near[0]])  # see `facet_touches`
    way = Crossing(outline, axis, start, end, near, low, high, np.append(begin, len(near)), bunch_low, bunch_high)
    for one in range(0, len(facets), _AT_ONCE):
        facet_touches(highest_first[one : one + _AT_ONCE], way, TOUCH, share, depth)


def _highest_first(facets: Array, axis: Array) -> Array:
    """Triangles (t, 3, 3) from the highest to the lowest along an axis (3,)."""
    heights = facets[:, :, 0] * axis[0] + facets[:, :, 1] * axis[1] + facets[:, :, 2] * axis[2]
    return facets[np.argsort(-heights.max(axis=1, initial=-np.inf), kind="stable")]


def _crossed(low: Array, high: Array, bunch_low: Array, bunch_high: Array) -> NDArray[np.intp]:
    """Numbers of the boxes `low` to `high` (k, 3) that cross one of the bunches; there may be millions of boxes."""
    near = np.flatnonzero(np.all(low < bunch_high.max(axis=0), axis=1) & np.all(high > bunch_low.min(axis=0), axis=1))
    crossed = np.zeros(len(near), dtype=np.bool_)
    for bunch_from, bunch_to in zip(bunch_low, bunch_high, strict=True):
        rest = np.flatnonzero(~crossed)
        if not len(rest):
            break
        some = near[rest]
        crossed[rest] = np.all(low[some] < bunch_to, axis=1) & np.all(high[some] > bunch_from, axis=1)
    return near[crossed]


def _boxes(outline: Array, start: Array, end: Array, axis: Array) -> tuple[Array, Array]:
    """Upright boxes around the swept part, least and greatest corners (m, 3)."""
    widest, low_end, high_end = outline[:, 0].max(), outline[:, 1].min(), outline[:, 1].max()
    spread = np.sqrt(np.maximum(1.0 - axis * axis, 0.0)) * widest  # of the cylinder that holds it
    one, other = axis * low_end, axis * high_end
    low = np.minimum(one, other) - spread + np.minimum(start, end)
    high = np.maximum(one, other) + spread + np.maximum(start, end)
    return low, high


FIRST_TOUCH: Final = "they touch first when the tip is at"


def place_in_words(system: str, point: Array) -> str:
    """Coordinates of `point` (3,) [m] in a work system, in mm; what rounds to zero has no sign."""
    numbers = np.round(point / MM, 3) + 0.0
    return " ".join(f"{letter}{value:.3f}" for letter, value in zip("XYZ", numbers, strict=True)) + f" of {system}"


def collision_finding(touch: Touch, span: Span, system: str, point: Array, time: float | None = None) -> Diagnostic:
    """GS301 to GS304: `point` (3,) [m] is where the tip is at first contact, in work system `system`; `time` [s]."""
    part = body_part(touch.part)
    return Diagnostic(
        code=part.code,
        message=f"{part.words} of {touch.tool} hits {touch.fixture}, {touch.depth / MM:.3f} mm deep; "
        f"{FIRST_TOUCH} {place_in_words(system, point)}",
        span=span,
        hint=part.hint,
        time=time,
        value=touch.depth / MM,
        limit=0.0,
        unit="mm",
        bodies=(touch.tool, touch.fixture),
    )
