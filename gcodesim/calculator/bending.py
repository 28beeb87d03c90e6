"""Bending of a tool under a side force."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen
from gcodesim.processes.tool_bending import MODULI, BeamSection, tip_compliance

_LENGTH = Quantity("length", POSITIVE)


@frozen
class RoundSection:
    """A part of a tool."""

    diameter: float = key(_LENGTH, "of this part", example="10 mm")
    length: float = key(_LENGTH, "of this part", example="30 mm")


@frozen
class ToolBending(Model):
    """A tool as a cantilever of one or several round sections."""

    kind: ClassVar[str] = "deflection"
    says: ClassVar[str] = "bending of a tool: a cantilever of round sections"
    source: ClassVar[str] = (
        "Euler and Bernoulli: F L^3 / (3 E I) for one section, I = pi d^4/64; several by the unit load"
    )
    also: ClassVar[tuple[str, ...]] = (
        "tool.deflection", "tool_deflection", "deflection.cantilever", "cantilever", "bending", "deflection.tool",
        "endmill.deflection", "deflection.sections", "tool.cantilever", "milling.deflection",
    )  # fmt: skip
    spellings: ClassVar[dict[str, str]] = {
        "F": "force", "side_force": "force", "radial_force": "force", "E": "modulus", "youngs_modulus": "modulus",
        "elastic_modulus": "modulus", "young": "modulus", "D": "diameter", "d": "diameter", "L": "length",
        "overhang": "length", "stickout": "length", "stick_out": "length", "material": "substrate",
        "load_position": "load_height", "segments": "sections", "force_height": "load_height",
        "flute_factor": "diameter_ratio", "equivalent_diameter_ratio": "diameter_ratio", "order": "first",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result(
            "deflection", "length", "way of the tip", ("tip_deflection", "delta", "displacement", "tip_displacement")
        ),
        Result("stiffness", "stiffness", "force over that way", ("tip_stiffness", "k")),
    )

    force: float = key("force", "from the side", example="200 N")
    sections: tuple[RoundSection, ...] = key(
        ListOf(Record(RoundSection, "the section")),
        "parts, in the order of `first`; or `diameter` and `length`",
        default=(),
    )
    first: str = key(Choice(("tip", "holder")), "which of the sections is named first", default="tip")
    diameter: float | None = key(_LENGTH, "of a tool of one section", default=None, example="10 mm")
    length: float | None = key(_LENGTH, "from the tip to the holder", default=None, example="40 mm")
    diameter_ratio: float = key(
        Quantity("ratio", POSITIVE), "equivalent over cutting diameter; 0.8 for fluted parts", default=1.0
    )
    substrate: str = key(Choice(tuple(MODULI)), "what it is made of", default="carbide")
    modulus: float | None = key(
        Quantity("pressure", POSITIVE), "Young's modulus (default: of the substrate)", default=None, example="600 GPa"
    )
    load_height: float = key(Quantity("length", NOT_NEGATIVE), "of the force above the tip", default=0.0)

    def compute(self) -> dict[str, Value]:
        parts = [BeamSection(part.diameter * self.diameter_ratio, part.length) for part in self.sections]
        if self.first == "holder":
            parts.reverse()
        if not parts:
            if self.diameter is None or self.length is None:
                raise CannotComputeError("how does the tool look? give `diameter` and `length`, or `sections`")
            parts = [BeamSection(self.diameter * self.diameter_ratio, self.length)]
        if self.load_height >= sum(part.length for part in parts):
            raise CannotComputeError("`load_height` is above the whole tool")
        modulus = MODULI[self.substrate] if self.modulus is None else self.modulus
        compliance = tip_compliance(parts, modulus, self.load_height)
        return {"deflection": self.force * compliance, "stiffness": 1.0 / compliance}
