"""Touch probe: a ball on a thin stem."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cylinder, sphere
from gcodesim.tools.sizes import exceeds
from gcodesim.tools.tool import Tool

STEM_SHARE = 0.6
"""Of the ball, where the stem's diameter is not given: what styli with a ruby ball have."""


@frozen
class Probe(Tool):
    """A probe whose ball trips when it touches; it takes nothing, and what it touches by other moves may break it."""

    kind: ClassVar[str] = "probe"
    process: ClassVar[str] = "sensing"

    diameter: float = key("length", "diameter of the ball at the tip")
    stem_diameter: float = key(
        "length",
        "diameter of the stem above the ball",
        derive=lambda tool: STEM_SHARE * tool.diameter,
        rule="0.6 of the ball's",
    )

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The ball, the stem up to the holder, the holder."""
        radius = 0.5 * self.diameter
        stem = cylinder("shank", 0.5 * self.stem_diameter, radius, self.length)
        return (sphere("tip", radius, 0.0), stem, *self._holder_bodies())

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        if exceeds(self.stem_diameter, self.diameter):
            found.append(("stem_diameter", "`stem_diameter` is more than that of the ball: the stem would touch first"))
        if self.length <= self.diameter:
            found.append(("length", "`length` must be more than the diameter of the ball"))
        return found

    def _positive(self) -> dict[str, float]:
        return {"diameter": self.diameter, "stem_diameter": self.stem_diameter, **Tool._positive(self)}
