"""Ball end mill: a half ball below a cylinder."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, ClassVar

from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, sphere
from gcodesim.tools.cutter import Cutter, arc_piece, line_piece

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape


@frozen
class BallEndMill(Cutter):
    """A ball end mill; kappa runs from 0 at the tip to 90 degrees at the equator."""

    kind: ClassVar[str] = "ball_end_mill"

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        R = self.radius
        return [arc_piece(0.0, R, R, 0.0, 0.5 * pi), line_piece(R, R, R, self.flute_length)]

    @property
    def cutting_shape(self) -> Shape:
        from gcodesim.material.shape import ball

        return ball(self.diameter, self.flute_length)

    def _tip_bodies(self) -> tuple[list[Primitive], float]:
        return [sphere("cutting", self.radius, 0.0)], self.radius

    @property
    def tip_height(self) -> float:
        return self.radius
