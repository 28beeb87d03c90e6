"""Step drill: a drill that opens the mouth of its bore."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.chisel_edge import LONGEST, USUAL
from gcodesim.tools.drill import point_pieces
from gcodesim.tools.form_cutter import FormCutter
from gcodesim.tools.sizes import exceeds
from gcodesim.units import DEG, MM


@frozen
class StepDrill(FormCutter):
    """A drill of `tip_diameter` for the first `step_length`, and of `diameter` above; the two cones cut."""

    kind: ClassVar[str] = "step_drill"
    axial: ClassVar[bool] = True

    tip_diameter: float = key("length", "diameter of the first step", example="5 mm")
    step_length: float = key("length", "from the tip to where the second cone begins", example="12 mm")
    point_angle: float = key("angle", "angle of the point, lip to lip", default=118.0 * DEG, rule="118 deg")
    step_angle: float = key("angle", "included angle of the step", default=90.0 * DEG, rule="90 deg")
    chisel_edge: float = key(
        Quantity("length", NOT_NEGATIVE),
        "length of the chisel edge across its web",
        derive=lambda drill: USUAL * drill.tip_diameter,
        rule="0.18 times `tip_diameter`; a split point has 0.03",
        example="0.3 mm",
    )

    @property
    def outline(self) -> Outline:
        inner, R = 0.5 * self.tip_diameter, self.radius
        point = inner / tan(0.5 * self.point_angle)
        return [(0.0, 0.0), (inner, point), (inner, self.step_length), (R, self.tip_height), (R, self.flute_length)]

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        inner = 0.5 * self.tip_diameter
        point = point_pieces(inner, inner / tan(0.5 * self.point_angle), self.chisel_edge)
        return [*point, FormCutter._edge_pieces(self)[2]]

    @property
    def point_diameter(self) -> float:
        return self.tip_diameter

    @property
    def chisel_length(self) -> float:
        return self.chisel_edge

    @property
    def edge_height(self) -> float:
        return self.tip_height

    @property
    def tip_height(self) -> float:
        return self.step_length + (self.radius - 0.5 * self.tip_diameter) / tan(0.5 * self.step_angle)

    def problems(self) -> list[tuple[str, str]]:
        for name, angle in (("point_angle", self.point_angle), ("step_angle", self.step_angle)):
            if not 10.0 * DEG <= angle < 180.0 * DEG:
                return [(name, f"`{name}` of {angle / DEG:g} deg is no cone; it is 10 to 179 deg")]
        found = FormCutter.problems(self)
        if not self.tip_diameter < self.diameter:
            found.append(("tip_diameter", "`tip_diameter` has to be less than `diameter`"))
        elif exceeds(self.chisel_edge, LONGEST * self.tip_diameter):
            found.append(("chisel_edge", f"`chisel_edge` is at most {LONGEST:g} times `tip_diameter`"))
        elif self.step_length <= 0.5 * self.tip_diameter / tan(0.5 * self.point_angle):
            found.append(("step_length", f"`step_length` {self.step_length / MM:g} mm ends within the point"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"tip_diameter": self.tip_diameter, "step_length": self.step_length, **FormCutter._positive(self)}
