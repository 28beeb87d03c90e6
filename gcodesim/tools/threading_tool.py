"""Tools that cut threads by many passes in step with the spindle."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.elementary import tan
from gcodesim.declarations.keys import key
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.frozen import frozen
from gcodesim.tools.lathe_tool import LatheTool
from gcodesim.units import DEG, MM

Array = NDArray[np.float64]


@frozen
class ThreadingTool(LatheTool):
    """A tip with the profile of a thread, driven by its middle."""

    kind: ClassVar[str] = "threading_tool"

    angle: float = key("angle", "angle of the profile", default=60.0 * DEG, rule="60 deg", example="55 deg")
    flat: float = key("length", "width of the flat at the tip", default=0.0, example="0.15 mm")
    height: float = key("length", "height of the profile", default=5.0 * MM, rule="5 mm")
    side: Literal["outside", "inside"] = key(Choice(("outside", "inside")), "where the thread is", default="outside")

    @property
    def blade(self) -> Array:
        half, top = 0.5 * self.flat, 0.5 * self.flat + self.height * tan(0.5 * self.angle)
        sign = 1.0 if self.side == "outside" else -1.0
        points = [(top, sign * self.height), (-top, sign * self.height), (-half, 0.0)]
        if half > 0.0:
            points.append((half, 0.0))
        return np.array(points if sign > 0.0 else points[::-1], dtype=float)

    @property
    def main_edges(self) -> NDArray[np.bool_]:
        return np.ones(len(self.blade), dtype=bool)

    def problems(self) -> list[tuple[str, str]]:
        found = LatheTool.problems(self)
        if not 5.0 * DEG <= self.angle <= 120.0 * DEG:
            found.append(("angle", f"`angle` of {self.angle / DEG:g} deg is no thread; it is 5 to 120 deg"))
        if self.flat < 0.0:
            found.append(("flat", "`flat` must not be less than 0"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"height": self.height, **LatheTool._positive(self)}
