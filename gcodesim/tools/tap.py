"""Tap: cuts or forms a thread in a bore."""

from __future__ import annotations

from typing import ClassVar, Final

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.solids.turned import Outline
from gcodesim.tools.form_cutter import FormCutter
from gcodesim.units import MM

PITCH_DEPTH: Final = 0.649519
"""Nominal less pitch diameter of a 60 degree thread over its pitch, 3/8 of its sharp height twice (ISO 68-1)."""


@frozen
class ThreadTap(FormCutter):
    """A tap for a 60 degree thread: it takes a cylinder of the pitch diameter, as much as the thread, without force."""

    kind: ClassVar[str] = "tap"
    axial: ClassVar[bool] = True
    center_cutting: ClassVar[bool] = False

    pitch: float = key("length", "pitch of the thread", example="1.25 mm")

    @property
    def outline(self) -> Outline:
        r = 0.5 * self.diameter - 0.5 * PITCH_DEPTH * self.pitch
        return [(0.0, 0.0), (r, 0.0), (r, self.flute_length)]

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        return []

    @property
    def shank_diameter(self) -> float:
        return self.diameter - PITCH_DEPTH * self.pitch

    def _form_problems(self) -> list[tuple[str, str]]:
        if self.pitch < 0.5 * self.diameter:
            return []
        return [("pitch", f"`pitch` {self.pitch / MM:g} mm is too coarse for `diameter` {self.diameter / MM:g} mm")]

    def _positive(self) -> dict[str, float]:
        return {"pitch": self.pitch, **FormCutter._positive(self)}
