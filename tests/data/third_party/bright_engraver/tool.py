"""The head of the laser, and its lens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from gcodesim.declarations.keys import inline, key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.parts import BodyPart
from gcodesim.tools.tool import Tool

LENS = BodyPart(words="the lens", hint="keep the lens clean and away", color=(0.2, 0.3, 0.9, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class BeamKeys:
    """What the process has to know of the beam."""

    power: float = key(Quantity("power", POSITIVE), "power of the beam", example="40 W")
    full_speed: float = key(
        Quantity("rotational speed", POSITIVE), "the S word at which the beam has its full power", example="1000 rpm"
    )
    focus: float = key("length", "how far below the tip it burns", default=2e-3)
    spot: float = key(Quantity("length", POSITIVE), "diameter of the spot", example="0.4 mm")
    depth: float = key(Quantity("length", POSITIVE), "how deep it burns above its focus", default=5e-4)
    absorbed: float = key(Quantity("ratio", Range(least=0.0, most=1.0)), "share that the material takes", default=0.8)


@dataclass(frozen=True, slots=True, kw_only=True)
class Engraver(Tool):
    """A laser that burns lines into a surface that it does not touch."""

    kind: ClassVar[str] = "laser_engraver"
    process: ClassVar[str] = "engraving"

    beam: BeamKeys = inline(BeamKeys)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        return (cylinder("lens", 6e-3, 0.0, self.length), *self._holder_bodies())
