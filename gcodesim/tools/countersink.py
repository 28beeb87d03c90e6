"""Countersink: a cone that opens a bore."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.conical_cutter import ConicalCutter
from gcodesim.units import DEG


@frozen
class Countersink(ConicalCutter):
    """A countersink; only the cone cuts, the cylinder above it guides."""

    kind: ClassVar[str] = "countersink"
    axial: ClassVar[bool] = True

    angle: float = key("angle", "included angle of the cone, edge to edge", default=90.0 * DEG, rule="90 deg")
    flutes: int = key("count", "number of teeth", default=3)

    @property
    def edges(self) -> Outline:
        return self.outline[:3]

    @property
    def edge_height(self) -> float:
        return self.tip_height
