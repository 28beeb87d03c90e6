"""Spray gun: a cone of paint or powder from its tip, along its axis."""

from __future__ import annotations

from itertools import pairwise
from typing import ClassVar, Final

from gcodesim.arithmetic.scalars import atan, tan
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone, cylinder
from gcodesim.tools.tool import Tool
from gcodesim.units import DEG, MM

PROFILES: Final = ("gaussian", "parabola", "uniform")

USUAL: Final = 30.0 * DEG
"""Cone of a gun for which neither that nor a footprint is given."""

_SHARE: Final = Quantity("ratio", Range(above=0.0, most=1.0))
_FACTOR: Final = Quantity("ratio", Range(least=0.0, most=10.0))
_OPENING: Final = Quantity("angle", Range(above=0.0, most=2.8))  # rad; 160 degrees
_THICK: Final = Quantity("ratio", Range(least=0.0, most=1e6))
_WIDE: Final = Quantity("length", Range(least=0.0, most=10.0))


@frozen
class Footprint:
    """What the gun leaves on a plane in front of it while it stands still: thickness at some radii."""

    radius: tuple[float, ...] = key(Vector(_WIDE), "from the axis outwards, rising", example="[0, 20, 40 mm]")
    thickness: tuple[float, ...] = key(Vector(_THICK), "of the film there; only their ratio counts")


@frozen
class Fading:
    """How the transfer efficiency changes with distance: straight between these points, even beyond them."""

    distance: tuple[float, ...] = key(Vector(_WIDE), "to the surface, rising", example="[150, 200, 300 mm]")
    factor: tuple[float, ...] = key(Vector(_FACTOR), "of `efficiency` there")


@frozen
class SprayGun(Tool):
    """A gun that sprays along its axis, from the tip; `flow` [m³/s] is liquid, of which `solids` stay as film."""

    kind: ClassVar[str] = "spray_gun"
    process: ClassVar[str] = "spraying"

    efficiency: float = key(_SHARE, "share of the solids meeting a surface that stays there", example="0.65")
    cone: tuple[float, ...] = key(
        ListOf(_OPENING, single=True),
        "full angle of the cone, or two of them along X and Y of the tool; of `gaussian`, two standard deviations to "
        "either side",
        derive=lambda tool: (_cone_of(tool),),
        rule="that of `footprint`, else 30 deg",
    )
    profile: str = key(Choice(PROFILES), "how thickness falls off across the cone", default="gaussian")
    footprint: Footprint | None = key(Footprint, "a measured one at `distance`, in place of `profile`", default=None)
    flow: float = key(
        Quantity("volume flow", Range(least=0.0)),
        "what leaves the nozzle while the gun is on and no signal `flow` says otherwise",
        default=0.0,
        example="2 cm^3/s",
    )
    solids: float = key(_SHARE, "share of the volume that stays when it is dry", default=1.0)
    distance: float = key(
        Quantity("length", Range(above=0.0, most=10.0)), "from the nozzle to the surface", default=200.0 * MM
    )
    distances: tuple[float, float] = key(
        Vector(Quantity("length", Range(least=0.0, most=10.0)), 2),
        "least and greatest distance that is right",
        example="[150, 250 mm]",
        derive=lambda tool: (0.5 * tool.distance, 1.5 * tool.distance),
        rule="half of `distance` and one and a half of it",
    )
    fading: Fading | None = key(Fading, "efficiency by distance; none: the same everywhere", default=None)
    rebound: float = key(
        Quantity("ratio", Range(least=0.0, most=20.0)),
        "efficiency falls with the cosine of the angle of incidence to this power",
        default=0.0,
    )
    nozzle_diameter: float = key("length", "of the air cap, for drawing and collisions", default=30.0 * MM)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """An air cap before a barrel."""
        cap = 0.5 * self.nozzle_diameter
        height = min(0.3 * self.length, 2.0 * cap)
        bodies = (cone("nozzle", 0.4 * cap, cap, 0.0, height), cylinder("nozzle", cap, height, self.length))
        return (*bodies, *self._holder_bodies())

    @property
    def plume(self) -> tuple[Primitive, ...]:
        """The cone up to the surface for which the gun is set; of two angles the wider one."""
        mouth, wide = 0.2 * self.nozzle_diameter, self.distance * tan(0.5 * max(self.cone))
        return (cone("spray", max(mouth, wide), mouth, -self.distance, 0.0),)

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        if not 1 <= len(self.cone) <= 2:
            found.append(("cone", "`cone` is one angle, or two"))
        if self.distances[0] >= self.distances[1]:
            found.append(("distances", "`distances` must grow"))
        for name, steps in (("footprint", self.footprint), ("fading", self.fading)):
            if steps is None:
                continue
            at = steps.radius if isinstance(steps, Footprint) else steps.distance
            values = steps.thickness if isinstance(steps, Footprint) else steps.factor
            if len(at) < 2 or len(at) != len(values):
                found.append((name, f"`{name}` needs two lists of the same length, of two values or more"))
            elif any(b <= a for a, b in pairwise(at)):
                found.append((name, f"`{name}`: its first list must rise"))
            elif not max(values) > 0.0:
                found.append((name, f"`{name}`: one of its values must be greater than 0"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"nozzle_diameter": self.nozzle_diameter, **Tool._positive(self)}

    @property
    def reach(self) -> float:
        return self.distances[1]


def _cone_of(gun: SprayGun) -> float:
    """The full angle [rad] of a gun for which none is given."""
    if gun.footprint is None:
        return USUAL
    return 2.0 * atan(gun.footprint.radius[-1] / gun.distance)
