"""Thread mill: one or more teeth of the thread's form on a neck."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline, Point
from gcodesim.tools.form_cutter import NeckedCutter
from gcodesim.units import DEG, MM


def _tooth_height(cutter: ThreadMill) -> float:
    depth = max(0.5 * (cutter.diameter - cutter.neck_diameter), 0.0)
    return 2.0 * depth * tan(0.5 * cutter.angle) + cutter.crest


def _form_height(cutter: ThreadMill) -> float:
    return _tooth_height(cutter) + (cutter.rows - 1) * (cutter.pitch or _tooth_height(cutter))


@frozen
class ThreadMill(NeckedCutter):
    """A thread mill with one tooth, or with `rows` of them a `pitch` apart; teeth are as deep as the neck allows."""

    kind: ClassVar[str] = "thread_mill"

    helix: float = key("angle", "helix angle; positive is right-hand", default=0.0, rule="0 deg")
    neck_diameter: float = key(
        "length",
        "diameter of the neck above and between the teeth",
        derive=lambda cutter: 0.7 * cutter.diameter,
        rule="0.7 of `diameter`",
        example="6 mm",
    )
    angle: float = key("angle", "included angle of a tooth", default=60.0 * DEG, rule="60 deg")
    crest: float = key("length", "width of the flat on a tooth", default=0.0, example="0.2 mm")
    rows: int = key("count", "number of teeth above each other", default=1)
    pitch: float | None = key("length", "distance of these teeth", default=None, example="1.5 mm")
    flute_length: float = key(
        "length",
        "length of the cutting edges from the tip",
        derive=_form_height,
        rule="that of the teeth",
        example="10 mm",
        quiet=True,
    )

    @property
    def outline(self) -> Outline:
        R, neck = self.radius, 0.5 * self.neck_diameter
        flank = (R - neck) * tan(0.5 * self.angle)
        points: list[Point] = [(0.0, 0.0)]
        for row in range(self.rows):
            h = row * (self.pitch or 0.0)
            points += [(neck, h), (R, h + flank), (R, h + flank + self.crest), (neck, h + 2.0 * flank + self.crest)]
        return points

    @property
    def edges(self) -> Outline:
        return self.outline[1:]

    @property
    def tip_height(self) -> float:
        return _form_height(self)

    def _form_problems(self) -> list[tuple[str, str]]:
        if not self.neck_diameter < self.diameter:
            return [("neck_diameter", "`neck_diameter` has to be less than `diameter`: it leaves no teeth")]
        if not 0.0 < self.angle <= 120.0 * DEG or self.crest < 0.0:
            return [("angle", f"`angle` of {self.angle / DEG:g} deg is no tooth; it is up to 120 deg")]
        if self.rows > 1 and self.pitch is None:
            return [("pitch", "`rows` of teeth need their `pitch`")]
        if self.rows > 1 and self.pitch is not None and self.pitch < _tooth_height(self) - 1e-9:
            tooth = _tooth_height(self) / MM
            return [("pitch", f"`pitch` {self.pitch / MM:g} mm is less than the {tooth:.3f} mm of a tooth")]
        return []
