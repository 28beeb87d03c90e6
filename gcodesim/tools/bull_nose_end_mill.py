"""Bull nose end mill: a flat bottom and a rounded corner below a cylinder."""

from __future__ import annotations

from itertools import pairwise
from math import pi
from typing import TYPE_CHECKING, ClassVar, Final

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone
from gcodesim.tools.cutter import Cutter, arc_piece, line_piece
from gcodesim.tools.sizes import exceeds
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape

_FACETS: Final = 8
"""Cones in place of the rounded corner, in bodies for collision and drawing: 0.5 % of its radius too thin at most."""


@frozen
class BullNoseEndMill(Cutter):
    """An end mill with a corner radius between 0 and half its diameter."""

    kind: ClassVar[str] = "bull_nose_end_mill"

    corner_radius: float = key("length", "radius of the rounded corner", example="1 mm")

    def __post_init__(self) -> None:
        Cutter.__post_init__(self)
        if not exceeds(self.corner_radius, self.radius) and not exceeds(self.radius, self.corner_radius):
            object.__setattr__(self, "corner_radius", self.radius)

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        R, rho = self.radius, self.corner_radius
        return [
            line_piece(0.0, 0.0, R - rho, 0.0),
            arc_piece(R - rho, rho, rho, 0.0, 0.5 * pi),
            line_piece(R, rho, R, self.flute_length),
        ]

    @property
    def cutting_shape(self) -> Shape:
        from gcodesim.material.shape import bull_nose

        return bull_nose(self.diameter, self.corner_radius, self.flute_length)

    def _tip_bodies(self) -> tuple[list[Primitive], float]:
        corner, inner = self.corner_radius, self.radius - self.corner_radius
        angles = [0.5 * pi * k / _FACETS for k in range(_FACETS + 1)]
        points = [(inner + corner * float(sin(a)), corner * (1.0 - float(cos(a)))) for a in angles]
        return [cone("cutting", r0, r1, h0, h1) for (r0, h0), (r1, h1) in pairwise(points)], corner

    @property
    def tip_height(self) -> float:
        return self.corner_radius

    def problems(self) -> list[tuple[str, str]]:
        found = Cutter.problems(self)
        if exceeds(self.corner_radius, self.radius):
            found.append(
                (
                    "corner_radius",
                    f"`corner_radius` {self.corner_radius / MM:g} mm is more than half the diameter, "
                    f"{self.radius / MM:g} mm",
                )
            )
        return found

    def _positive(self) -> dict[str, float]:
        return {"corner_radius": self.corner_radius, **Cutter._positive(self)}
