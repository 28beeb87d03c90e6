"""Water jet, with or without abrasive."""

from __future__ import annotations

from math import inf
from typing import ClassVar, Literal

from gcodesim.arithmetic.scalars import tan
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.beam_tool import BeamTool
from gcodesim.units import MM


@frozen
class Jet(BeamTool):
    """A jet that takes `removal_rate` of the stock's material; moving, it goes rate / (diameter · feed) deep."""

    kind: ClassVar[str] = "jet"
    process: ClassVar[str] = "erosion"
    gives_off: ClassVar[str] = "stream"

    removal_rate: float = key(
        Quantity("volume flow", POSITIVE), "what it takes of the stock's material at full flow", example="8 mm^3/s"
    )
    profile: Literal["flat", "top_hat", "gaussian"] = key(
        Choice(("flat", "top_hat", "gaussian")), "how it spreads over its footprint; `flat` leaves a level floor",
        default="flat",
    )  # fmt: skip
    divergence: float = key("angle", "full angle at which the jet widens", default=0.0)
    taper: float = key("angle", "lean of each wall of the kerf, which narrows downwards", default=0.0)
    stand_off: float = key("length", "from the nozzle to the tip, the point that the program moves", default=3.0 * MM)

    @property
    def rayleigh(self) -> float:
        """It widens by `slope` alone."""
        return inf

    @property
    def slope(self) -> float:
        """Growth of the radius with the distance [-]."""
        return tan(0.5 * self.divergence) - tan(self.taper)
