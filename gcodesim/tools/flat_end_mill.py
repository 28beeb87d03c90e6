"""Flat end mill: a cylinder with a flat bottom."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from gcodesim.frozen import frozen
from gcodesim.tools.cutter import Cutter, line_piece

if TYPE_CHECKING:
    from gcodesim.material.sweep_kernels import Shape


@frozen
class FlatEndMill(Cutter):
    """A cylindrical end mill; its bottom edges reach the axis, so it can plunge."""

    kind: ClassVar[str] = "flat_end_mill"

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        R = self.radius
        return [line_piece(0.0, 0.0, R, 0.0), line_piece(R, 0.0, R, self.flute_length)]

    @property
    def cutting_shape(self) -> Shape:
        from gcodesim.material.shape import flat

        return flat(self.diameter, self.flute_length)
