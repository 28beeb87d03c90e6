"""Bull nose end mill: a flat bottom and a rounded corner below a cylinder."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.cutter import Cutter, arc_piece, line_piece
from gcodesim.tools.sizes import exceeds
from gcodesim.units import MM

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape


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
        inner = self.radius - 0.3 * self.corner_radius  # cylinder of nearly the same volume as the rounded part
        return [cylinder("cutting", inner, 0.0, self.corner_radius)], self.corner_radius

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
