"""Lollipop mill: a ball on a thin neck."""

from __future__ import annotations

from math import sqrt
from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline, OutlineArc
from gcodesim.tools.form_cutter import NeckedCutter


def _ball_height(cutter: LollipopMill) -> float:
    R, neck = cutter.radius, min(0.5 * cutter.neck_diameter, cutter.radius)
    return R + sqrt(R * R - neck * neck)


@frozen
class LollipopMill(NeckedCutter):
    """An undercutting ball; its edges reach up to the neck."""

    kind: ClassVar[str] = "lollipop_mill"

    flute_length: float = key(
        "length",
        "length of the cutting edges from the tip",
        derive=_ball_height,
        rule="up to the neck",
        example="9 mm",
        quiet=True,
    )

    @property
    def outline(self) -> Outline:
        R, neck = self.radius, 0.5 * self.neck_diameter
        to = (neck, _ball_height(self))
        return [(0.0, 0.0), OutlineArc(to=to, centre=(0.0, R), ccw=True), (neck, self.flute_length)]

    @property
    def edges(self) -> Outline:
        return self.outline[:2]

    @property
    def tip_height(self) -> float:
        return _ball_height(self)
