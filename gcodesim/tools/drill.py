"""Twist drill: a cone below a cylinder."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone
from gcodesim.tools.cutter import Cutter, line_piece
from gcodesim.units import DEG

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape


@frozen
class Drill(Cutter):
    """A drill whose straight lips reach the axis; only they cut, while the margins of the cylinder guide.

    The chisel edge is not modelled: the thrust of a real drill with a thick web is higher by a third or more.
    """

    kind: ClassVar[str] = "drill"
    axial: ClassVar[bool] = True

    point_angle: float = key(
        "angle", "angle of the point, lip to lip", default=118.0 * DEG, rule="118 deg", example="140 deg"
    )

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        return [line_piece(0.0, 0.0, self.radius, self.tip_height)]

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
        return found
