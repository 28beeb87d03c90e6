"""Reamer: opens a bore to its size."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import FormCutter


@frozen
class Reamer(FormCutter):
    """A reamer; its 45 degree lead cuts, the cylinder above it guides, and its face has no edges."""

    kind: ClassVar[str] = "reamer"
    axial: ClassVar[bool] = True
    center_cutting: ClassVar[bool] = False

    flutes: int = key("count", "number of teeth", default=6)
    lead: float = key(
        "length",
        "height of the 45 degree lead",
        derive=lambda cutter: 0.05 * cutter.diameter,
        rule="a twentieth of `diameter`",
        example="0.5 mm",
    )

    @property
    def outline(self) -> Outline:
        R = self.radius
        return [(0.0, 0.0), (R - self.lead, 0.0), (R, self.lead), (R, self.flute_length)]

    @property
    def edges(self) -> Outline:
        return self.outline[1:3]

    @property
    def edge_height(self) -> float:
        return self.lead

    @property
    def tip_height(self) -> float:
        return self.lead

    def _form_problems(self) -> list[tuple[str, str]]:
        return [] if self.lead < self.radius else [("lead", "`lead` has to be less than half of `diameter`")]

    def _positive(self) -> dict[str, float]:
        return {"lead": self.lead, **FormCutter._positive(self)}
