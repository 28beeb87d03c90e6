"""Engraver: a slender cone with a small flat."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.conical_cutter import ConicalCutter
from gcodesim.units import DEG, MM


@frozen
class Engraver(ConicalCutter):
    """A single-edged engraving tool."""

    kind: ClassVar[str] = "engraver"

    angle: float = key("angle", "included angle of the cone, edge to edge", default=30.0 * DEG, rule="30 deg")
    flutes: int = key("count", "number of teeth", default=1)
    tip_diameter: float = key(
        "length", "diameter of the flat at the tip; 0: a point", default=0.1 * MM, rule="0.1 mm", example="0.2 mm"
    )
