"""Face mill: inserts at a lead angle on a wide body."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import FormCutter
from gcodesim.units import DEG, MM


@frozen
class FaceMill(FormCutter):
    """A face or shoulder mill; its edges stand at the lead angle to the axis, and there are none on its face."""

    kind: ClassVar[str] = "face_mill"
    center_cutting: ClassVar[bool] = False

    diameter: float = key("length", "greatest cutting diameter, at the top of the edges")
    flutes: int = key("count", "number of inserts", default=5)
    helix: float = key("angle", "helix angle of the edges", default=0.0, rule="0 deg")
    lead_angle: float = key(
        "angle", "angle of the edges to the axis; 0 deg makes a shoulder", default=45.0 * DEG, rule="45 deg"
    )
    flute_length: float = key(
        "length",
        "height of the edges",
        derive=lambda cutter: min(0.1 * cutter.diameter, 6.0 * MM),
        rule="a tenth of `diameter`, at most 6 mm",
        example="4 mm",
    )

    @property
    def tip_diameter(self) -> float:
        """Cutting diameter at the bottom of the edges [m]."""
        return self.diameter - 2.0 * self.flute_length * tan(self.lead_angle)

    @property
    def outline(self) -> Outline:
        return [(0.0, 0.0), (0.5 * self.tip_diameter, 0.0), (self.radius, self.flute_length)]

    @property
    def edges(self) -> Outline:
        return self.outline[1:]

    def _form_problems(self) -> list[tuple[str, str]]:
        if 0.0 <= self.lead_angle <= 80.0 * DEG and self.tip_diameter > 0.0:
            return []
        return [("lead_angle", f"`lead_angle` of {self.lead_angle / DEG:g} deg leaves nothing at the bottom")]
