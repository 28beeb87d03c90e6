"""Chuck and tailstock of a lathe as outlines in its half plane."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from gcodesim.material.revolved import Guard


class ChuckSize(Protocol):
    """Lengths [m]."""

    @property
    def diameter(self) -> float: ...
    @property
    def grip(self) -> float: ...
    @property
    def length(self) -> float: ...


class TailstockSize(Protocol):
    """Lengths [m]."""

    @property
    def diameter(self) -> float: ...
    @property
    def length(self) -> float: ...
    @property
    def tip(self) -> float: ...


def guards_of(
    chuck: ChuckSize | None, tailstock: TailstockSize | None, bottom: float, top: float, radius: float
) -> list[Guard]:
    """What no tool may touch about a bar of `radius` from `bottom` to `top` [m]; jaws begin outside of the bar."""
    found = []
    if chuck is not None:
        face, far = bottom + chuck.grip, bottom + chuck.grip - chuck.length
        outer = max(0.5 * chuck.diameter, radius)
        found.append(Guard(name="chuck", outline=np.array([(far, 0.0), (face, 0.0), (face, outer), (far, outer)])))
    if tailstock is not None:
        thick, end = 0.5 * tailstock.diameter, top + tailstock.length
        neck = min(top + tailstock.tip, end)
        outline = np.array([(top, 0.0), (end, 0.0), (end, thick), (neck, thick)])
        found.append(Guard(name="tailstock", outline=outline))
    return found
