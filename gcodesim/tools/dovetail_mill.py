"""Dovetail mill: wide at the bottom, narrower above."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import NeckedCutter
from gcodesim.units import DEG


@frozen
class DovetailMill(NeckedCutter):
    """A dovetail mill; `diameter` is that at the bottom."""

    kind: ClassVar[str] = "dovetail_mill"

    diameter: float = key("length", "cutting diameter, at the bottom")
    angle: float = key("angle", "angle between flank and bottom", default=60.0 * DEG, rule="60 deg")
    flute_length: float = key("length", "height of the flank", example="5 mm")
    neck_diameter: float = key(
        "length",
        "diameter of the neck above the edges",
        derive=lambda cutter: max(2.0 * cutter.upper_radius, 0.0),
        rule="that at the top of the flank",
        example="6 mm",
    )

    @property
    def upper_radius(self) -> float:
        """Radius at the top of the flank [m]."""
        return self.radius - self.flute_length / tan(self.angle) if self.angle > 0.0 else 0.0

    @property
    def outline(self) -> Outline:
        return [(0.0, 0.0), (self.radius, 0.0), (self.upper_radius, self.flute_length)]

    def problems(self) -> list[tuple[str, str]]:
        if not 10.0 * DEG <= self.angle < 90.0 * DEG:
            return [("angle", f"`angle` of {self.angle / DEG:g} deg is no dovetail; it is 10 to 89 deg")]
        if self.upper_radius <= 0.0:
            return [("flute_length", "the flanks meet below `flute_length`")]
        return NeckedCutter.problems(self)
