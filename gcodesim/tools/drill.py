"""Twist drill: a cone below a cylinder."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone
from gcodesim.tools.chisel_edge import LONGEST, USUAL, weight_of_chisel
from gcodesim.tools.cutter import Cutter, line_piece
from gcodesim.tools.sizes import exceeds
from gcodesim.units import DEG

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape


@frozen
class Drill(Cutter):
    """A drill: two straight lips and the chisel edge between them cut, the margins of the cylinder guide."""

    kind: ClassVar[str] = "drill"
    axial: ClassVar[bool] = True

    point_angle: float = key(
        "angle", "angle of the point, lip to lip", default=118.0 * DEG, rule="118 deg", example="140 deg"
    )

    chisel_edge: float = key(
        Quantity("length", NOT_NEGATIVE),
        "length of the chisel edge across its web",
        derive=lambda drill: USUAL * drill.diameter,
        rule="0.18 times the diameter; a split point has 0.03",
        example="0.3 mm",
    )

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        return point_pieces(self.radius, self.tip_height, self.chisel_edge)

    @property
    def chisel_length(self) -> float:
        return self.chisel_edge

    @property
    def edge_height(self) -> float:
        return self.tip_height

    @property
    def cutting_shape(self) -> Shape:
        from gcodesim.material.shape import cone as cone_shape

        return cone_shape(self.diameter, self.point_angle, self.flute_length)

    def _tip_bodies(self) -> tuple[list[Primitive], float]:
        return [cone("cutting", 0.0, self.radius, 0.0, self.tip_height)], self.tip_height

    @property
    def tip_height(self) -> float:
        # a point without an angle is impossible, which `problems` says; until then it must not divide by zero
        return self.radius / tan(0.5 * self.point_angle) if self.point_angle > 0.0 else 0.0

    def problems(self) -> list[tuple[str, str]]:
        found = Cutter.problems(self)
        if not 10.0 * DEG <= self.point_angle <= 180.0 * DEG:
            found.append(
                (
                    "point_angle",
                    f"`point_angle` of {self.point_angle / DEG:g} deg is no drill point; it is 10 to 180 deg",
                )
            )
        if exceeds(self.chisel_edge, LONGEST * self.diameter):
            found.append(("chisel_edge", f"`chisel_edge` is at most {LONGEST:g} times the diameter"))
        return found


def point_pieces(radius: float, height: float, chisel: float) -> list[tuple[float, ...]]:
    """Rows of `Cutter.edge` for the point of a drill [m]: the chisel edge, if there is any, and a lip."""
    if chisel <= 0.0:
        return [line_piece(0.0, 0.0, radius, height)]
    share = 0.5 * chisel / radius
    inner, foot = share * radius, share * height
    weight = weight_of_chisel(share)
    return [line_piece(0.0, 0.0, inner, foot, weight), line_piece(inner, foot, radius, height)]
