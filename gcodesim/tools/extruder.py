"""Extruder: a nozzle that lays a bead."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.arithmetic.scalars import tan
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Range
from gcodesim.declarations.plain_kinds import Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone, cylinder, sphere
from gcodesim.tools.paste import WITHOUT_DATA, Paste
from gcodesim.tools.tool import Tool
from gcodesim.units import MM


def _without(name: str, like: str | None) -> str:
    """What is told of a paste without a constant."""
    if like in WITHOUT_DATA:
        return f"`paste` has no `{name}`, and there are no data of {like}: they differ by the water and the maker"
    return f"`paste` has no `{name}`, and is like none that is known"


@frozen
class RayCone:
    """Rays from the nozzle, evenly over a cone about its axis; each carries a particle to where it strikes first."""

    angle: float = key(Quantity("angle", Range(least=0.0, most=2.8)), "full opening of the cone", example="20 deg")
    distance: float = key(Quantity("length", POSITIVE), "how far a particle flies", example="50 mm")
    number: int = key(Whole(Range(least=1, most=10_000)), "of rays in each step of the simulation", default=20)
    seed: int = key(Whole(NOT_NEGATIVE), "of the random numbers that place them", default=1)


@frozen
class Extruder(Tool):
    """A nozzle with its bead: a rectangle with round ends, `bead_width` wide and `bead_height` high [m]."""

    kind: ClassVar[str] = "extruder"
    process: ClassVar[str] = "extrusion"

    bead_width: float = key("length", "width of a laid bead", example="4 mm")
    bead_height: float = key("length", "height of a laid bead, from the layer below to the nozzle", example="2 mm")
    filament_diameter: float = key("length", "diameter of the filament that E words count", default=1.75 * MM)

    flow: float | None = key(
        Quantity("volume flow", Range(least=0.0)),
        "what a pump gives while the tool is on and no signal `flow` says otherwise; the bead then follows from flow "
        "and speed, otherwise it always has its size",
        default=None,
        example="800 mm^3/s",
    )

    rays: RayCone | None = key(
        RayCone, "throws particles along rays in place of laying a bead, also where the tool leans", default=None
    )

    paste: Paste | None = key(
        Paste,
        "what it lays stands as a paste does, such as concrete or clay: beads that slump, or yield below others, are "
        "told",
        default=None,
    )

    @property
    def bead_area(self) -> float:
        """Cross-section of the bead [m²]: (w - h) h + pi h²/4."""
        height = self.bead_height
        return (self.bead_width - height) * height + 0.25 * pi * (height * height)

    @property
    def filament_area(self) -> float:
        """Cross-section of the filament [m²]."""
        return 0.25 * pi * (self.filament_diameter * self.filament_diameter)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """A nozzle cone of the bead's width below a barrel; the sizes above the tip are for drawing only."""
        mouth, barrel = 0.5 * self.bead_width, max(2.0 * self.bead_width, 10.0 * MM)
        height = min(0.3 * self.length, 2.0 * barrel)
        bodies = (cone("nozzle", mouth, barrel, 0.0, height), cylinder("nozzle", barrel, height, self.length))
        return (*bodies, *self._holder_bodies())

    @property
    def plume(self) -> tuple[Primitive, ...]:
        """A drop as wide as the bead at the mouth of the nozzle, or the cone of particles that it throws."""
        mouth = 0.5 * self.bead_width
        if self.rays is None:
            return (sphere("strand", mouth, -mouth),)
        wide = mouth + self.rays.distance * tan(0.5 * self.rays.angle)
        return (cone("spray", wide, mouth, -self.rays.distance, 0.0),)

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        if self.bead_height > self.bead_width:
            found.append(
                (
                    "bead_height",
                    f"`bead_height` {self.bead_height / MM:g} mm is more than `bead_width` "
                    f"{self.bead_width / MM:g} mm: a bead is at least as wide as high",
                )
            )
        if self.paste is not None:
            missing = self.paste.missing
            found += [("paste", _without(name, self.paste.like)) for name in missing]
        return found

    def _positive(self) -> dict[str, float]:
        return {
            "bead_width": self.bead_width,
            "bead_height": self.bead_height,
            "filament_diameter": self.filament_diameter,
            **Tool._positive(self),
        }
