"""What lasers and plasma torches have in common: power that melts or burns material away."""

from __future__ import annotations

from typing import Literal

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.beam_tool import BeamTool

Profile = Literal["gaussian", "top_hat", "flat"]


@frozen
class HeatBeam(BeamTool):
    """A beam of heat: it removes what its energy suffices for."""

    specific_energy: float | None = key(
        Quantity("energy per volume", POSITIVE),
        "what it takes to remove material",
        default=None,
        rule="to melt the stock's material; of materials without data nothing is removed",
    )
    threshold: float = key(
        Quantity("energy per area", NOT_NEGATIVE), "dose that a place takes up before material goes", default=0.0
    )
    profile: Profile = key(
        Choice(("gaussian", "top_hat", "flat")), "how the power spreads over the beam", default="gaussian"
    )
