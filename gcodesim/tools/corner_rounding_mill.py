"""Corner rounding mill: a hollow quarter that rounds an edge."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline, OutlineArc
from gcodesim.tools.form_cutter import FormCutter


@frozen
class CornerRoundingMill(FormCutter):
    """A mill with a hollow quarter of `corner_radius` above a flat tip of `tip_diameter`."""

    kind: ClassVar[str] = "corner_rounding_mill"

    corner_radius: float = key("length", "radius that it leaves on the edge", example="3 mm")
    tip_diameter: float = key("length", "diameter of the flat tip", example="4 mm")
    diameter: float = key(
        "length",
        "greatest cutting diameter",
        derive=lambda cutter: cutter.tip_diameter + 2.0 * cutter.corner_radius,
        rule="`tip_diameter` and twice `corner_radius`",
        example="10 mm",
    )

    @property
    def outline(self) -> Outline:
        inner, rho = 0.5 * self.tip_diameter, self.corner_radius
        to = (inner + rho, rho)
        hollow = OutlineArc(to=to, centre=(inner + rho, 0.0), ccw=False)
        return [(0.0, 0.0), (inner, 0.0), hollow, (self.radius, rho), (self.radius, self.flute_length)]

    @property
    def tip_height(self) -> float:
        return self.corner_radius

    def _form_problems(self) -> list[tuple[str, str]]:
        if self.diameter >= self.tip_diameter + 2.0 * self.corner_radius - 1e-9:
            return []
        return [("diameter", "`diameter` is less than `tip_diameter` and twice `corner_radius`")]

    def _positive(self) -> dict[str, float]:
        sizes = {"corner_radius": self.corner_radius, "tip_diameter": self.tip_diameter}
        return {**sizes, **FormCutter._positive(self)}
