"""An end effector: a tool that is only moved, such as a screwdriver, a stamp, a pointer or half of a tool changer."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.tool import Tool
from gcodesim.units import MM


@frozen
class EndEffector(Tool):
    """A body with a tip. It takes nothing and gives nothing; what it hits, it hits."""

    kind: ClassVar[str] = "end_effector"

    diameter: float = key("length", "diameter of its body", default=40.0 * MM)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The body and the holder."""
        return (cylinder("body", 0.5 * self.diameter, 0.0, self.length), *self._holder_bodies())

    def _positive(self) -> dict[str, float]:
        return {"diameter": self.diameter, **Tool._positive(self)}
