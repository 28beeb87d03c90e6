"""What all cutters share whose edges are on a disc above which there is a neck."""

from __future__ import annotations

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import NeckedCutter
from gcodesim.units import DEG


@frozen
class DiscCutter(NeckedCutter):
    """A disc of `flute_length` height on a neck; it has edges on its rim and on both faces."""

    helix: float = key("angle", "helix angle; positive is right-hand", default=0.0 * DEG, rule="0 deg")

    @property
    def outline(self) -> Outline:
        R, h = self.radius, self.flute_length
        return [(0.0, 0.0), (R, 0.0), (R, h), (0.5 * self.neck_diameter, h)]
