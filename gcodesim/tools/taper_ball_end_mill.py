"""Taper ball end mill: a small ball on a slender cone."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.arithmetic.elementary import cos, sin, tan
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline, OutlineArc
from gcodesim.tools.form_cutter import FormCutter
from gcodesim.units import DEG, MM


@frozen
class TaperBallEndMill(FormCutter):
    """A ball of `tip_diameter` that passes smoothly into a cone, up to `diameter`."""

    kind: ClassVar[str] = "taper_ball_end_mill"

    diameter: float = key("length", "diameter where the cone ends, that of the shank")
    tip_diameter: float = key("length", "diameter of the ball at the tip", example="1 mm")
    taper: float = key("angle", "angle of the cone to the axis, on each side", example="5 deg")

    @property
    def outline(self) -> Outline:
        r, R = 0.5 * self.tip_diameter, self.radius
        to = (r * float(cos(self.taper)), r * (1.0 - float(sin(self.taper))))
        ball = OutlineArc(to=to, centre=(0.0, r), ccw=True)
        return [(0.0, 0.0), ball, (R, self.tip_height), (R, self.flute_length)]

    @property
    def tip_height(self) -> float:
        r = 0.5 * self.tip_diameter
        low = r * (1.0 - float(sin(self.taper)))
        return low + (self.radius - r * float(cos(self.taper))) / tan(self.taper) if self.taper > 0.0 else low

    def problems(self) -> list[tuple[str, str]]:
        if not 0.1 * DEG <= self.taper <= 80.0 * DEG:
            return [("taper", f"`taper` of {self.taper / DEG:g} deg is no taper; it is 0.1 to 80 deg")]
        found = FormCutter.problems(self)
        if not self.tip_diameter < self.diameter:
            found.append(
                ("tip_diameter", f"`tip_diameter` {self.tip_diameter / MM:g} mm has to be less than `diameter`")
            )
        return found

    def _positive(self) -> dict[str, float]:
        return {"tip_diameter": self.tip_diameter, **FormCutter._positive(self)}
