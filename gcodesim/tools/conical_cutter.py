"""What all cutters with a conical end share: an included angle, and a flat at the tip."""

from __future__ import annotations

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import FormCutter
from gcodesim.units import DEG, MM


@frozen
class ConicalCutter(FormCutter):
    """A cone from the flat at the tip to the cutting diameter, and a cylinder above."""

    angle: float = key("angle", "included angle of the cone, edge to edge", example="90 deg")
    tip_diameter: float = key("length", "diameter of the flat at the tip; 0: a point", default=0.0, example="0.2 mm")

    @property
    def tip_height(self) -> float:
        # an angle of nothing is impossible, which `problems` says; until then it must not divide by zero
        return (self.radius - 0.5 * self.tip_diameter) / tan(0.5 * self.angle) if self.angle > 0.0 else 0.0

    @property
    def outline(self) -> Outline:
        R = self.radius
        return [(0.0, 0.0), (0.5 * self.tip_diameter, 0.0), (R, self.tip_height), (R, self.flute_length)]

    def problems(self) -> list[tuple[str, str]]:
        found = FormCutter.problems(self)
        if not 1.0 * DEG <= self.angle < 180.0 * DEG:
            found.append(("angle", f"`angle` of {self.angle / DEG:g} deg is no cone; it is 1 to 179 deg"))
        if not 0.0 <= self.tip_diameter < self.diameter:
            found.append(
                (
                    "tip_diameter",
                    f"`tip_diameter` {self.tip_diameter / MM:g} mm does not lie between 0 and `diameter` "
                    f"{self.diameter / MM:g} mm",
                )
            )
        return found
