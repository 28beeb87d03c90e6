"""One chip: the force on an edge from its thickness and width."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import CannotComputeError, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut import chip_force
from gcodesim.processes.laws import LinearEdge


@frozen
class OneChip(CutModel):
    """The base of both laws for one chip."""

    spellings: ClassVar[dict[str, str]] = {"h": "chip_thickness", "b": "width", "vc": "cutting_speed"}

    chip_thickness: float = key(Quantity("length", NOT_NEGATIVE), "thickness h of the chip", example="0.1 mm")
    width: float = key(Quantity("length", POSITIVE), "width b of the chip", example="5 mm")
    cutting_speed: float | None = key("speed", "for the power", default=None, example="120 m/min")

    def _with_power(self, found: dict[str, Value], force: float) -> dict[str, Value]:
        if self.cutting_speed is not None:
            found["Pc"] = force * self.cutting_speed
        return found


_POWER = Result("Pc", "power", "cutting power, force times `cutting_speed`", ("power", "cutting_power"))


@frozen
class KienzleChip(OneChip):
    """Specific cutting force and force on one edge."""

    kind: ClassVar[str] = "kienzle"
    says: ClassVar[str] = "force of one chip by Kienzle's law"
    source: ClassVar[str] = "Kienzle 1952: kc = kc1.1 (h / 1 mm)^-mc, F = kc b h"
    gives: ClassVar[tuple[Result, ...]] = (
        Result("kc", "pressure", "specific cutting force at this thickness"),
        Result("Fc", "force", "cutting force", ("Ft", "F")),
        Result("Fn", "force", "normal force", ("Fr", "Ff")),
        Result("Fa", "force", "force along the edge", ("Fp",)),
        _POWER,
    )

    def compute(self) -> dict[str, Value]:
        law = self.kienzle
        if self.chip_thickness <= 0.0:
            raise CannotComputeError("Kienzle's law has no specific force for a chip without thickness")
        fc, fn, fa = chip_force(law, width=self.width, chip=self.chip_thickness)
        kc = law.specific_force(self.chip_thickness)
        return self._with_power({"kc": kc, "Fc": fc, "Fn": fn, "Fa": fa}, fc)


@frozen
class LinearEdgeChip(OneChip):
    """Force on one edge by the linear-edge law."""

    kind: ClassVar[str] = "linear_edge"
    says: ClassVar[str] = "force of one chip by the linear-edge law"
    source: ClassVar[str] = "Altintas 2012, eq. 2.72: dF = (Kc h + Ke) b, for each of t, r, a"
    also: ClassVar[tuple[str, ...]] = ("linear-edge", "linearedge", "linear")
    gives: ClassVar[tuple[Result, ...]] = (
        Result("Ft", "force", "tangential force", ("Fc",)),
        Result("Fr", "force", "radial force", ("Fn",)),
        Result("Fa", "force", "axial force"),
        _POWER,
    )

    def compute(self) -> dict[str, Value]:
        law = self.law
        if not isinstance(law, LinearEdge):
            raise CannotComputeError("this model needs `Ktc`, `Kte`, `Krc`, `Kre`")
        ft, fr, fa = chip_force(law, width=self.width, chip=self.chip_thickness)
        return self._with_power({"Ft": ft, "Fr": fr, "Fa": fa}, ft)
