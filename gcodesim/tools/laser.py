"""Laser: a beam that heats, engraves and cuts."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.heat_beam import HeatBeam
from gcodesim.units import UM


def _rayleigh(diameter: float, beam_quality: float, wavelength: float) -> float:
    """Distance [m] from the focus at which the spot has twice the area."""
    return 0.25 * pi * (diameter * diameter) / (beam_quality * wavelength)


@frozen
class Laser(HeatBeam):
    """A laser. `diameter` is that at which a Gaussian beam has 1/e² of its greatest intensity (ISO 11146)."""

    kind: ClassVar[str] = "laser"
    process: ClassVar[str] = "ablation"

    power: float = key(Quantity("power", POSITIVE), "full power of the beam", example="40 W")
    absorptivity: float = key(
        Quantity("ratio", Range(above=0.0, most=1.0)), "share of the power that the material takes up", default=1.0
    )
    wavelength: float = key(Quantity("length", POSITIVE), "wavelength of the light", default=1.06 * UM)
    beam_quality: float = key(
        Quantity("ratio", Range(least=1.0)),
        "M²: how much faster it widens than an ideal beam",
        default=1.0,
        example="1.3",
    )
    rayleigh: float = key(
        Quantity("length", POSITIVE),
        "distance from the focus at which the spot has twice the area",
        derive=lambda tool: round(_rayleigh(tool.diameter, tool.beam_quality, tool.wavelength), 9),  # as it is shown
        rule="pi radius² / (M² wavelength)",
    )
    tolerance: float = key(
        "length",
        "how far before or behind its focus it may strike",
        derive=lambda tool: tool.rayleigh,
        rule="the Rayleigh length",
    )

    @property
    def share(self) -> float:
        """Of the power, what goes into the material."""
        return self.absorptivity

    @property
    def slope(self) -> float:
        """A laser widens by its Rayleigh length alone."""
        return 0.0
