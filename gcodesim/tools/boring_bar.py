"""Boring bar: one edge that opens a bore."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import NeckedCutter
from gcodesim.units import MM


@frozen
class BoringBar(NeckedCutter):
    """A boring bar in a spindle; it needs a bore, into which its bar fits, and cuts with the side of its insert."""

    kind: ClassVar[str] = "boring_bar"
    axial: ClassVar[bool] = True
    center_cutting: ClassVar[bool] = False

    diameter: float = key("length", "diameter of the bore that it makes")
    flutes: int = key("count", "number of edges", default=1)
    helix: float = key("angle", "helix angle of the edge", default=0.0, rule="0 deg")
    lead: float = key("length", "height of the 45 degree edge at the front", default=0.5 * MM, rule="0.5 mm")
    neck_diameter: float = key(
        "length",
        "diameter of the bar",
        derive=lambda cutter: 0.8 * cutter.diameter,
        rule="0.8 of `diameter`",
        example="12 mm",
    )
    flute_length: float = key(
        "length",
        "height of the insert",
        derive=lambda cutter: max(0.1 * cutter.diameter, 2.0 * cutter.lead),
        rule="a tenth of `diameter`, at least twice `lead`",
        example="3 mm",
    )

    @property
    def outline(self) -> Outline:
        R, h = self.radius, self.flute_length
        return [(0.0, 0.0), (R - self.lead, 0.0), (R, self.lead), (R, h), (0.5 * self.neck_diameter, h)]

    @property
    def edges(self) -> Outline:
        return self.outline[1:3]

    @property
    def tip_height(self) -> float:
        return self.lead

    @property
    def edge_height(self) -> float:
        return self.lead

    def _form_problems(self) -> list[tuple[str, str]]:
        if 0.0 < self.lead < self.radius:
            return NeckedCutter._form_problems(self)
        return [("lead", "`lead` lies between 0 and half of `diameter`")]
