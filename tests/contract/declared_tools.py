"""Tools as other packages may add them: with units that no tool here has, lists, choices, files and groups."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import ClassVar, Literal

from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.file_kind import File, FileValue
from gcodesim.declarations.keys import inline, key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.tools.tool import Tool


@dataclass(frozen=True, slots=True, kw_only=True)
class Finger:
    """A finger of a gripper."""

    width: float = key("length", "width of a finger", example="20 mm")
    friction: float = key(Quantity("ratio", NOT_NEGATIVE), "friction at its face", default=0.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Gripper(Tool):
    """Two fingers that press."""

    kind: ClassVar[str] = "test_gripper"

    force: float = key(Quantity("force", POSITIVE), "greatest force of the fingers", example="60 N")
    power: float | None = key("power", "what the drive takes", default=None)
    pressure: float = key("pressure", "of the air", default=6e5)
    closing: float = key("time", "time from open to closed", default=0.2)
    stiffness: float | None = key(
        "stiffness", "of the fingers", derive=lambda tool: tool.force / 1e-3, rule="the force at 1 mm"
    )
    openings: tuple[float, ...] = key(Vector(Quantity("length"), 2), "narrowest and widest", default=(0.0, 0.04))
    forces: tuple[float, ...] = key(ListOf(Quantity("force", POSITIVE)), "forces of the steps", default=())
    mode: Literal["parallel", "angular"] = key(Choice(("parallel", "angular")), "how they move", default="parallel")
    senses: bool = key("switch", "whether it feels what it holds", default=False)
    jaw: FileValue | None = key(File("a mesh of the jaw"), "shape of a jaw", default=None)
    finger: Finger | None = key(Finger, "the fingers; none: points", default=None)

    def problems(self) -> list[tuple[str, str]]:
        found = Tool.problems(self)
        if self.openings[0] >= self.openings[1]:
            found.append(("openings", "`openings` must grow"))
        return found


@dataclass(frozen=True, slots=True, kw_only=True)
class SprayKeys:
    """What a process of spraying asks of its tool: the process declares it, the tool lays it among its own keys."""

    flow: float = key("flow", "what leaves the nozzle", example="300 mm^3/s")
    cone: float = key("angle", "full angle of the cone", default=0.25 * pi)
    powder: float | None = key("mass flow", "powder in it", default=None)
    temperature: float = key(
        Quantity("temperature", Range(least=173.15, most=1273.15)), "of what leaves the nozzle", default=293.15
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SprayGun(Tool):
    """A nozzle that sprays."""

    kind: ClassVar[str] = "test_spray_gun"

    spray: SprayKeys = inline(SprayKeys)
