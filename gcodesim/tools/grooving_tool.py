"""Blades for grooves and for parting off."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.declarations.keys import key
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.frozen import frozen
from gcodesim.tools.lathe_tool import REACH, LatheTool
from gcodesim.units import MM

Array = NDArray[np.float64]


@frozen
class GroovingTool(LatheTool):
    """A blade with a straight edge along Z (along X for grooves in a face) that is driven by one of its corners."""

    kind: ClassVar[str] = "grooving_tool"

    width: float = key("length", "width of the blade", default=3.0 * MM, example="3 mm")
    corner: Literal["left", "right", "middle"] = key(
        Choice(("left", "right", "middle")), "the corner that is driven; left is towards -Z", default="left"
    )
    side: Literal["outside", "inside", "face"] = key(
        Choice(("outside", "inside", "face")), "what the blade points at", default="outside"
    )
    reach: float = key("length", "how deep it can cut", default=REACH, rule="150 mm", example="20 mm")

    @property
    def blade(self) -> Array:
        begin = {"left": 0.0, "middle": -0.5, "right": -1.0}[self.corner] * self.width
        end, deep = begin + self.width, self.reach
        if self.side == "face":
            return np.array([(deep, end), (0.0, end), (0.0, begin), (deep, begin)])
        if self.side == "inside":
            return np.array([(begin, -deep), (end, -deep), (end, 0.0), (begin, 0.0)])
        return np.array([(end, deep), (begin, deep), (begin, 0.0), (end, 0.0)])

    @property
    def main_edges(self) -> NDArray[np.bool_]:
        main = np.ones(4, dtype=bool)
        main[{"face": 3, "inside": 0, "outside": 0}[self.side]] = False
        return main

    def problems(self) -> list[tuple[str, str]]:
        return LatheTool.problems(self)

    def _positive(self) -> dict[str, float]:
        return {"width": self.width, "reach": self.reach, **LatheTool._positive(self)}


@frozen
class PartingTool(GroovingTool):
    """A blade that parts the work off."""

    kind: ClassVar[str] = "parting_tool"
