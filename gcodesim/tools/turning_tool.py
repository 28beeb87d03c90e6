"""Turning tools and boring bars with one tip."""

from __future__ import annotations

from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.lathe_insert import Insert, insert_of
from gcodesim.tools.lathe_tool import NOSE_CENTRES, ORIENTATION, REACH, LatheTool, behind, wedge
from gcodesim.units import DEG, MM

Array = NDArray[np.float64]

SLIM = 15.0 * DEG
"""Angle of a tip that is not described: a point that goes nearly everywhere."""
LEAST_LEAD: Final = 30.0 * DEG
GREATEST_LEAD: Final = 130.0 * DEG
"""Between these lie the lead angles [rad] of edges that cut."""


@frozen
class TurningTool(LatheTool):
    """A tip with a nose between two edges, by the ISO code of its insert or by its angles.

    Without either it is an ideal point: a slim tip whose front edge stands square to the feed.
    """

    kind: ClassVar[str] = "turning_tool"

    insert: str | None = key("text", "ISO code of the insert", default=None, example="CNMG120408")
    orientation: int = key(ORIENTATION, "where the nose is, 1 to 9 as in LinuxCNC's tool table", default=2)
    nose_radius: float = key(
        "length",
        "radius of the nose",
        derive=lambda tool: 0.0 if tool.iso is None else tool.iso.nose_radius,
        rule="that of the insert, else 0",
        example="0.8 mm",
    )
    tip_angle: float = key(
        "angle",
        "angle between both edges",
        derive=lambda tool: SLIM if tool.iso is None else tool.iso.tip_angle,
        rule="that of the insert, else 15 deg",
        example="80 deg",
    )
    lead_angle: float = key(
        "angle",
        "angle between the front edge and Z (between the edge and X where the tool works on faces, 5 and 7)",
        derive=lambda tool: 90.0 * DEG if tool.iso is None else tool.iso.lead_angle,
        rule="that of the usual holder of the insert, else 90 deg",
        example="95 deg",
    )
    edge: float = key(
        "length",
        "length of the edges",
        derive=lambda tool: REACH if tool.iso is None else tool.iso.edge,
        rule="that of the insert, else 150 mm",
        example="12 mm",
    )
    width: float = key(
        "length",
        "width of the shank; of a boring bar, its diameter; 0: it is not looked at",
        derive=lambda tool: 0.0 if tool.iso is None else 20.0 * MM,
        rule="20 mm with an insert, else 0",
        example="25 mm",
    )

    @property
    def iso(self) -> Insert | None:
        """What the code of the insert says."""
        return None if self.insert is None else insert_of(self.insert)

    @property
    def edges(self) -> tuple[float, float]:
        """Directions [rad] of the front and the back edge away from the nose, from +Z towards +X."""
        ways = NOSE_CENTRES[self.orientation]
        tip, lead = self.tip_angle, self.lead_angle
        half_turn = 180.0 * DEG
        if ways[0] and ways[1]:  # a corner: mirrored from orientation 2
            front = half_turn - lead
            back = front - tip
            if ways[0] < 0:
                front, back = half_turn - front, half_turn - back
            return (front, back) if ways[1] > 0 else (-front, -back)
        middle = (
            90.0 * DEG if ways == (0, 0) else {(0, 1): 90.0, (0, -1): -90.0, (1, 0): 0.0, (-1, 0): 180.0}[ways] * DEG
        )
        return middle + 0.5 * tip, middle - 0.5 * tip

    @property
    def round(self) -> bool:
        """Whether the whole insert is a disc."""
        return self.tip_angle <= 0.0

    @property
    def blade(self) -> Array:
        if self.round:
            return _disc(self.nose_radius, self.orientation)
        return wedge(*self.edges, self.nose_radius, self.edge, self.orientation)[0]

    @property
    def main_edges(self) -> NDArray[np.bool_]:
        if self.round:
            return np.ones(len(self.blade), dtype=bool)
        main = wedge(*self.edges, self.nose_radius, self.edge, self.orientation)[1]
        ways = NOSE_CENTRES[self.orientation]
        if not (ways[0] and ways[1]):  # a tip in the middle cuts to both sides
            main[:-1] = True
        return main

    @property
    def behind(self) -> int:
        ways = NOSE_CENTRES[self.orientation]
        return ways[0] if ways[1] else 0

    @property
    def shank(self) -> Array:
        if self.width <= 0.0 or self.round:
            return np.zeros((0, 2))
        centre = NOSE_CENTRES[self.orientation]
        middle = (centre[0] * self.nose_radius, centre[1] * self.nose_radius)
        return behind(*self.edges, middle, self.nose_radius, self.width)

    def problems(self) -> list[tuple[str, str]]:
        found = LatheTool.problems(self)
        if self.insert is not None and self.iso is None:
            found.append(("insert", f"`insert` {self.insert} is no ISO code of an insert, such as CNMG120408"))
        if self.nose_radius < 0.0:
            found.append(("nose_radius", "`nose_radius` must not be less than 0"))
        if not 0.0 <= self.tip_angle <= 120.0 * DEG or (self.tip_angle == 0.0 and self.nose_radius == 0.0):
            found.append(("tip_angle", f"`tip_angle` of {self.tip_angle / DEG:g} deg is no tip; it is 1 to 120 deg"))
        if not LEAST_LEAD <= self.lead_angle <= GREATEST_LEAD:
            found.append(("lead_angle", f"`lead_angle` of {self.lead_angle / DEG:g} deg is not within 30 to 130 deg"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"edge": self.edge, **LatheTool._positive(self)}


def _disc(radius: float, orientation: int) -> Array:
    """The outline of a round insert."""
    from gcodesim.arithmetic.elementary import cos, sin

    angle = 2.0 * np.pi * np.arange(90) / 90
    ways = NOSE_CENTRES[orientation]
    return np.stack([(ways[0] + cos(angle)) * radius, (ways[1] + sin(angle)) * radius], axis=1)


@frozen
class BoringTool(TurningTool):
    """A turning tool on a bar along the spindle, for the inside."""

    kind: ClassVar[str] = "boring_tool"
    inside: ClassVar[bool] = True

    orientation: int = key(ORIENTATION, "where the nose is, 1 to 9 as in LinuxCNC's tool table", default=3)

    @property
    def shank(self) -> Array:
        if self.width <= 0.0:
            return np.zeros((0, 2))
        side = -1.0 if NOSE_CENTRES[self.orientation][1] < 0 else 1.0
        begin, aside = 1.0 * MM, 0.5 * MM
        r = sorted((side * aside, side * (aside + self.width)))
        return np.array([(begin, r[0]), (REACH, r[0]), (REACH, r[1]), (begin, r[1])])
