"""Inputs that say how a material resists: a name of the library, or constants of a law as tables print them."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.calculator.model import CannotComputeError, Model
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.laws import DEFAULT_AXIAL_RATIO, DEFAULT_NORMAL_RATIO, Kienzle, LinearEdge, with_rake
from gcodesim.processes.materials import LIBRARY
from gcodesim.tools.teeth import RAKE

_PRESSURE = Quantity("pressure", NOT_NEGATIVE)
_EDGE = Quantity("force per length", NOT_NEGATIVE)
_EXPONENT = Quantity("ratio", Range(least=0.0, below=1.0))


@frozen
class CutModel(Model):
    """The base of models of cutting."""

    spellings: ClassVar[dict[str, str]] = {
        "kc": "kc11", "kc1": "kc11", "kc1_1": "kc11", "kn": "kn11", "ka": "ka11", "id": "material", "name": "material",
        "gamma": "rake", "rake_angle": "rake", "gamma0": "table_rake", "base_rake": "table_rake",
    }  # fmt: skip

    material: str | None = key("text", "a material of the library (`gcodesim list materials`)", default=None)
    kc11: float | None = key(
        Quantity("pressure", POSITIVE), "Kienzle: specific force at 1 mm chip thickness", default=None
    )
    mc: float | None = key(_EXPONENT, "its exponent", default=None, example="0.25")
    kn11: float | None = key(_PRESSURE, "the same for the normal force", default=None)
    mn: float | None = key(_EXPONENT, "its exponent; `mc`", default=None)
    ka11: float | None = key(_PRESSURE, "the same for the axial force", default=None)
    ma: float | None = key(_EXPONENT, "its exponent; `mc`", default=None)
    normal_ratio: float = key("ratio", "normal over tangential force without `kn11`", default=DEFAULT_NORMAL_RATIO)
    axial_ratio: float = key("ratio", "axial over tangential force without `ka11`", default=DEFAULT_AXIAL_RATIO)
    Ktc: float | None = key(_PRESSURE, "linear-edge law: tangential cutting coefficient", default=None)
    Kte: float | None = key(_EDGE, "tangential edge coefficient", default=None)
    Krc: float | None = key(_PRESSURE, "radial cutting coefficient", default=None)
    Kre: float | None = key(_EDGE, "radial edge coefficient", default=None)
    Kac: float | None = key(_PRESSURE, "axial cutting coefficient", default=None)
    Kae: float | None = key(_EDGE, "axial edge coefficient", default=None)

    rake: float | None = key(
        RAKE, "of the edges; forces change by 1 % a degree", default=None, rule="that of the table"
    )
    table_rake: float | None = key(
        RAKE, "of the edges that the constants hold for", default=None, rule="what the library says of `material`"
    )

    @property
    def law(self) -> Kienzle | LinearEdge:
        """The law of force on these edges; CannotComputeError where the inputs name none, or two."""
        law, of_table = self._table_law, self.table_rake
        if self.rake is None:
            return law
        named = self.kc11 is None and self.Ktc is None
        if of_table is None and named and self.material is not None:
            of_table = LIBRARY[self.material].rake
        if of_table is None:
            raise CannotComputeError("for which rake do the constants hold? give `table_rake`, or leave out `rake`")
        return with_rake(law, self.rake, of_table)

    @property
    def _table_law(self) -> Kienzle | LinearEdge:
        if self.Ktc is not None:
            if self.kc11 is not None:
                raise CannotComputeError("`Ktc` belongs to the linear-edge law, `kc11` to Kienzle's: give one of them")
            return LinearEdge(
                ktc=self.Ktc, kte=self.Kte or 0.0, krc=self.Krc or 0.0, kre=self.Kre or 0.0, kac=self.Kac or 0.0,
                kae=self.Kae or 0.0,
            )  # fmt: skip
        if self.kc11 is not None:
            mc = 0.0 if self.mc is None else self.mc
            return Kienzle(
                kc11=self.kc11,
                mc=mc,
                kn11=self.normal_ratio * self.kc11 if self.kn11 is None else self.kn11,
                mn=mc if self.mn is None else self.mn,
                ka11=self.axial_ratio * self.kc11 if self.ka11 is None else self.ka11,
                ma=mc if self.ma is None else self.ma,
            )
        if self.material is None:
            raise CannotComputeError(
                "no material: give `material` (a name of the library), `kc11` and `mc`, or `Ktc`, `Kte`, `Krc`, `Kre`"
            )
        if self.material not in LIBRARY:
            near = ", ".join(LIBRARY.suggest(self.material))
            told = f"; is it one of {near}?" if near else ""
            raise CannotComputeError(f"there is no material {self.material}{told}")
        law = LIBRARY[self.material].law
        if law is None:
            raise CannotComputeError(f"{LIBRARY[self.material].name}: its force is not known")
        return law

    @property
    def kienzle(self) -> Kienzle:
        """The law, which has to be Kienzle's."""
        law = self.law
        if not isinstance(law, Kienzle):
            raise CannotComputeError("this model needs Kienzle's constants, `kc11` and `mc`")
        return law

    def remarks(self) -> list[str]:
        if self.kc11 is None and self.Ktc is None and self.material is not None and self.material in LIBRARY:
            found = LIBRARY[self.material]
            return [f"{found.name}: {found.source}", *(f"assumed: {what}" for what in found.assumed)]
        if self.kc11 is not None and self.kn11 is None:
            return [f"assumed: normal force {self.normal_ratio:g}, axial {self.axial_ratio:g} of the tangential one"]
        return []
