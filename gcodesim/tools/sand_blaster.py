"""Sand blaster: a spray of grains that wears a surface away."""

from __future__ import annotations

from typing import ClassVar, Literal

from gcodesim.declarations.keys import key
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.frozen import frozen
from gcodesim.tools.jet import Jet
from gcodesim.units import DEG, MM


@frozen
class SandBlaster(Jet):
    """A blasting gun. `diameter` is that of its spot at the tip; in a Gaussian one, where it has 1/e² of the most."""

    kind: ClassVar[str] = "sand_blaster"
    process: ClassVar[str] = "erosion"
    gives_off: ClassVar[str] = "spray"

    profile: Literal["flat", "top_hat", "gaussian"] = key(
        Choice(("flat", "top_hat", "gaussian")), "how the grains spread over the spot", default="gaussian"
    )
    divergence: float = key("angle", "full angle at which the spray widens", default=15.0 * DEG)
    stand_off: float = key("length", "from the nozzle to the tip, the point that the program moves", default=80.0 * MM)
