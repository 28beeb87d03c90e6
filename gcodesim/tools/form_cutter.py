"""Form cutters: mills, drills and saws whose body is any outline of lines and arcs turned about the axis."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline, OutlineArc, Point, end_of, steps_of
from gcodesim.tools.body import Primitive, cone, cylinder, sphere
from gcodesim.tools.cutter import Cutter, arc_piece, line_piece
from gcodesim.tools.sizes import exceeds
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape

FACETS: Final = 8
"""Straight pieces in place of an arc where arcs have no form of their own: hollow edges, bodies for collision."""

NOTHING: Final = 1e-9
"""[m]"""


@frozen
class FormCutter(Cutter):
    """A cutter that is given by the outline of its cutting part.

    Where the outline is that of a flat, ball, bull nose or conical end mill it cuts by the same kernels; any other
    cuts columns in three directions, so that undercuts come out right.
    """

    @property
    def outline(self) -> Outline:
        """The cutting part from (0, 0) on the axis outwards and up to its end at `flute_length`, (r, h) [m]."""
        raise NotImplementedError

    @property
    def edges(self) -> Outline:
        """The part of the outline that has cutting edges: all of it, unless the kind says otherwise."""
        return self.outline

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        pieces = []
        for start, piece in steps_of(self.edges):
            if isinstance(piece, OutlineArc) and piece.ccw:
                (rc, hc), radius = piece.centre, piece.radius
                begin, turn = piece.angles(start)
                pieces.append(arc_piece(rc, hc, radius, begin + 0.5 * math.pi, begin + turn + 0.5 * math.pi))
                continue
            points = _facets(start, piece) if isinstance(piece, OutlineArc) else [piece]
            for to in points:
                if math.dist(start, to) > NOTHING:
                    pieces.append(line_piece(*start, *to))
                start = to
        return pieces

    @property
    def widest(self) -> float:
        """The greatest radius of the cutting part [m]."""
        return max(end_of(piece)[0] for piece in _with_equators(self.outline))

    @property
    def form(self) -> Outline | None:
        return None if self._plain_shape is not None else self.outline

    @property
    def _plain_shape(self) -> Shape | None:
        from gcodesim.material.shape import shape_of_outline

        return shape_of_outline(self.outline)

    @property
    def cutting_shape(self) -> Shape:
        """The cutting part, or the cylinder around it where no shape of the kernels is like it."""
        from gcodesim.material.shape import cylinder as section

        plain = self._plain_shape
        return section(2.0 * self.widest, 0.0, self.flute_length) if plain is None else plain

    def _cutting_bodies(self) -> list[Primitive]:
        bodies: list[Primitive] = []
        for start, piece in steps_of(self.outline):
            if isinstance(piece, OutlineArc) and piece.ccw and abs(piece.centre[0]) <= NOTHING and start[0] <= NOTHING:
                bodies.append(sphere("cutting", piece.radius, piece.centre[1] - piece.radius))
                continue
            for to in _facets(start, piece) if isinstance(piece, OutlineArc) else [piece]:
                bodies += _section(start, to)
                start = to
        return bodies

    def problems(self) -> list[tuple[str, str]]:
        found = Cutter.problems(self)
        return found or self._form_problems()

    def _form_problems(self) -> list[tuple[str, str]]:
        """What makes the outline impossible, where the sizes alone are sound."""
        return []


def _section(start: Point, to: Point) -> list[Primitive]:
    (r0, h0), (r1, h1) = start, to
    if h1 - h0 <= NOTHING or max(r0, r1) <= 0.0:
        return []
    if abs(r1 - r0) <= NOTHING:
        return [cylinder("cutting", r0, h0, h1)]
    return [cone("cutting", r0, r1, h0, h1)]


def _facets(start: Point, arc: OutlineArc) -> list[Point]:
    begin, turn = arc.angles(start)
    (rc, hc), radius = arc.centre, arc.radius
    angles = [begin + turn * k / FACETS for k in range(1, FACETS)]
    return [*((rc + radius * float(cos(a)), hc + radius * float(sin(a))) for a in angles), arc.to]


def _with_equators(outline: Outline) -> list[Point | OutlineArc]:
    """The pieces, and the widest points of arcs."""
    found = list(outline)
    for start, piece in steps_of(outline):
        if isinstance(piece, OutlineArc) and piece.ccw and start[1] <= piece.centre[1] <= piece.to[1]:
            found.append((piece.centre[0] + piece.radius, piece.centre[1]))
    return found


@frozen
class NeckedCutter(FormCutter):
    """A cutter whose edges are wider than the neck above them, so that it cuts sideways below a ledge."""

    neck_diameter: float = key(
        "length",
        "diameter of the neck above the edges",
        derive=lambda cutter: 0.5 * cutter.diameter,
        rule="half of `diameter`",
        example="6 mm",
    )

    @property
    def shank_diameter(self) -> float:
        return self.neck_diameter

    def _form_problems(self) -> list[tuple[str, str]]:
        if exceeds(self.neck_diameter, self.diameter):
            return [
                (
                    "neck_diameter",
                    f"`neck_diameter` {self.neck_diameter / MM:g} mm is more than `diameter` {self.diameter / MM:g} mm",
                )
            ]
        return []

    def _positive(self) -> dict[str, float]:
        return {"neck_diameter": self.neck_diameter, **FormCutter._positive(self)}
