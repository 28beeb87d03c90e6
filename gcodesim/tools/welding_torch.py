"""Welding torch: an arc that melts a wire onto the work."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, ClassVar, Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cone, cylinder, sphere
from gcodesim.tools.tool import Tool
from gcodesim.units import MM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_SHARE: Final = Quantity("ratio", Range(above=0.0, most=1.0))
_SPEED: Final = Quantity("speed", Range(least=0.0))


@frozen
class WeldingTorch(Tool):
    """A torch for gas metal arc welding. Its tip is the end of the wire, which the program moves."""

    kind: ClassVar[str] = "welding_torch"
    process: ClassVar[str] = "arc_welding"

    wire_diameter: float = key(Quantity("length", POSITIVE), "of the wire", default=1.2 * MM)
    wire_speed: float = key(
        _SPEED, "of the wire while the arc burns and no signal `wire_speed` says otherwise", example="8 m/min"
    )
    yield_: float = key(_SHARE, "share of the wire that stays in the bead", name="yield", default=0.97)
    voltage: float | None = key(Quantity("voltage", POSITIVE), "of the arc, for the heat", default=None, example="22 V")
    current: float | None = key(Quantity("current", POSITIVE), "of the arc", default=None, example="180 A")
    efficiency: float = key(_SHARE, "share of the arc's heat that gets into the work (EN 1011-1)", default=0.8)
    aspect: float = key(Quantity("ratio", POSITIVE), "width of a bead over its height", default=3.0)
    bead_width: float | None = key(
        Quantity("length", POSITIVE), "width of the bead; without it, by `aspect` and flow", default=None
    )
    reach: float = key("length", "how far above or below the tip the arc meets the work", default=10.0 * MM)

    @property
    def wire_area(self) -> float:
        """Cross-section of the wire [m²]."""
        return 0.25 * pi * (self.wire_diameter * self.wire_diameter)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The wire that stands out, a gas cup and a barrel; for drawing and collisions."""
        out, cup = min(12.0 * MM, 0.3 * self.length), 10.0 * MM
        height = min(out + 30.0 * MM, 0.7 * self.length)
        wire = 0.5 * self.wire_diameter
        tip = (cone("nozzle", wire, 0.8 * cup, 0.0, out), cone("nozzle", 0.8 * cup, cup, out, height))
        bodies = (*tip, cylinder("nozzle", cup, height, self.length))
        return (*bodies, *self._holder_bodies())

    @property
    def plume(self) -> tuple[Primitive, ...]:
        """The arc at the end of the wire."""
        return (sphere("flame", 2.0 * self.wire_diameter, -2.0 * self.wire_diameter),)

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        if (self.voltage is None) != (self.current is None):
            missing = "current" if self.current is None else "voltage"
            found.append((missing, "`voltage` and `current` belong together: both, or none"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"wire_diameter": self.wire_diameter, "reach": self.reach, **Tool._positive(self)}

    def widths_of(self, section: Array) -> Array:
        """Widths (c,) [m] of beads with sections (c,) [m²], parabolas: A = 2/3 w h, h = w / aspect."""
        import numpy as np

        if self.bead_width is not None:
            return np.full(len(section), self.bead_width)
        widths: Array = np.sqrt(1.5 * self.aspect * section)
        return widths
