"""What lasers, jets, torches and blasting guns have in common: a nozzle, and a beam that acts beyond it."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone, cylinder
from gcodesim.tools.tool import Tool
from gcodesim.units import MM

SLIMMEST = 1.0 * MM
"""Radius of the nozzle's mouth, at least: it is for drawing and collisions only."""

THINNEST = 0.3 * MM
"""Radius of a beam as it is drawn, at least."""


@frozen
class BeamTool(Tool):
    """A tool that acts at a distance. Its tip, which the program moves, is where the beam is as wide as `diameter`.

    The nozzle ends `stand_off` before the tip. Whoever programs the height of the nozzle says `stand_off: 0` and
    gives the distance as `focus`.
    """

    gives_off: ClassVar[str] = "light"
    """The part that is drawn while it is on."""

    diameter: float = key("length", "diameter of the beam where it is meant to strike", example="0.2 mm")
    stand_off: float = key("length", "from the nozzle to the tip, the point that the program moves", default=5.0 * MM)
    focus: float = key("length", "how far beyond the tip the beam is as wide as `diameter`", default=0.0)
    reach: float = key("length", "how far beyond the tip it acts", default=200.0 * MM)
    tolerance: float = key(
        "length",
        "how far before or behind that place it may strike",
        derive=lambda tool: max(tool.stand_off + tool.focus, 1.0 * MM),
        rule="the distance from the nozzle, at least 1 mm",
    )

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """A nozzle cone and a barrel, from the stand-off up; their widths are for drawing and collisions only."""
        mouth, begin = max(0.5 * self.diameter, SLIMMEST), max(self.stand_off, 0.0)
        barrel = max(2.0 * mouth, 10.0 * MM)
        height = begin + 0.3 * (self.length - begin)
        bodies = (cone("nozzle", mouth, barrel, begin, height), cylinder("nozzle", barrel, height, self.length))
        return (*bodies, *self._holder_bodies())

    @property
    def plume(self) -> tuple[Primitive, ...]:
        """From the nozzle to where it is meant to strike, wide enough to be seen."""
        if self.stand_off + self.focus <= 0.0:
            return ()
        return (cylinder(self.gives_off, max(0.5 * self.diameter, THINNEST), -self.focus, self.stand_off),)

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        if not 0.0 <= self.stand_off < self.length:
            found.append(("stand_off", "`stand_off` must be 0 or more, and less than `length`"))
        if not 0.0 <= self.focus < self.reach:
            found.append(("focus", "`focus` must be 0 or more, and less than `reach`"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"diameter": self.diameter, "reach": self.reach, "tolerance": self.tolerance, **Tool._positive(self)}
