"""Spot drill: a short stiff point that marks a bore."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.drill import Drill
from gcodesim.units import DEG


@frozen
class SpotDrill(Drill):
    """A spot or centre drill."""

    kind: ClassVar[str] = "spot_drill"

    point_angle: float = key(
        "angle", "angle of the point, lip to lip", default=90.0 * DEG, rule="90 deg", example="120 deg"
    )
