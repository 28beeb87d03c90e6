"""Plasma torch: an arc that melts through conducting material."""

from __future__ import annotations

from math import inf
from typing import ClassVar

from gcodesim.arithmetic.scalars import tan
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.heat_beam import HeatBeam, Profile
from gcodesim.units import MM


@frozen
class Plasma(HeatBeam):
    """A torch. `diameter` is the width of its kerf at the tip, `taper` by how much each wall leans inwards below."""

    kind: ClassVar[str] = "plasma"
    process: ClassVar[str] = "ablation"
    gives_off: ClassVar[str] = "flame"

    power: float = key(Quantity("power", POSITIVE), "power of the arc, current times voltage", example="5 kW")
    efficiency: float = key(
        Quantity("ratio", Range(above=0.0, most=1.0)), "share of the power that melts material", default=0.3
    )
    profile: Profile = key(
        Choice(("gaussian", "top_hat", "flat")), "how the power spreads over the kerf", default="flat"
    )
    taper: float = key("angle", "lean of each wall of the kerf, which narrows downwards", default=0.0)
    stand_off: float = key("length", "from the nozzle to the tip, the point that the program moves", default=1.5 * MM)

    @property
    def share(self) -> float:
        """Of the power, what goes into the material."""
        return self.efficiency

    @property
    def rayleigh(self) -> float:
        """It widens by `slope` alone."""
        return inf

    @property
    def slope(self) -> float:
        """Growth of the radius with the distance [-]."""
        return -tan(self.taper)
