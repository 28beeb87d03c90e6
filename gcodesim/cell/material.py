"""Custom materials: constants of a cutting-force law, as printed in tables."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Json, Kind, Range
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.plain_kinds import Text
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen
from gcodesim.processes.laws import DEFAULT_AXIAL_RATIO, DEFAULT_NORMAL_RATIO, Kienzle, LinearEdge
from gcodesim.processes.materials import Material
from gcodesim.tools.teeth import RAKE

_CUTTING = Quantity("pressure", NOT_NEGATIVE)
_EDGE = Quantity("force per length", NOT_NEGATIVE)
_RATIO = Quantity("ratio", NOT_NEGATIVE)
_KIENZLE = ("kc11", "mc")
_LINEAR = ("Ktc", "Kte", "Krc", "Kre")


@frozen
class MaterialForm:
    """A material by Kienzle's constants (`kc11`, `mc`) or the linear-edge law (`Ktc`, `Kte`, `Krc`, `Kre` …)."""

    kc11: float | None = key(
        Quantity("pressure", POSITIVE), "specific cutting force at 1 mm chip thickness", default=None
    )
    mc: float | None = key(Quantity("ratio", Range(least=0.0, below=1.0)), "its exponent", default=None, example="0.25")
    normal_ratio: float | None = key(_RATIO, "normal over tangential force", default=None)
    axial_ratio: float | None = key(_RATIO, "axial over tangential force", default=None, example="0.2")
    Ktc: float | None = key(_CUTTING, "tangential cutting coefficient", default=None, example="630 N/mm^2")
    Kte: float | None = key(_EDGE, "tangential edge coefficient", default=None)
    Krc: float | None = key(_CUTTING, "radial cutting coefficient", default=None, example="100 N/mm^2")
    Kre: float | None = key(_EDGE, "radial edge coefficient", default=None, example="10 N/mm")
    Kac: float | None = key(_CUTTING, "axial cutting coefficient", default=None, example="50 N/mm^2")
    Kae: float | None = key(_EDGE, "axial edge coefficient", default=None, example="2 N/mm")
    rake: float | None = key(
        RAKE, "of the edges that the constants hold for; a tool with another one is corrected", default=None
    )
    source: str = key(Text(), "source of the constants", default="", quiet=True)

    def checked(self, to: Reading, path: Path) -> Material | Unread:
        kienzle = [name for name in (*_KIENZLE, "normal_ratio", "axial_ratio") if getattr(self, name) is not None]
        linear = [name for name in (*_LINEAR, "Kac", "Kae") if getattr(self, name) is not None]
        if kienzle and linear:
            message = f"`{linear[0]}` belongs to the linear-edge law, `{kienzle[0]}` to Kienzle's"
            return to.fault("GS719", to.key((*path, linear[0])), message, "a material has one law")
        wanted = _LINEAR if linear else _KIENZLE
        missing = [name for name in wanted if getattr(self, name) is None]
        if missing:
            names = ", ".join(f"`{name}`" for name in missing)
            return to.fault(
                "GS705",
                to.span(path),
                f"material `{path[-1]}` lacks {names}",
                "give `kc11` and `mc`, or `Ktc`, `Kte`, `Krc`, `Kre`",
            )
        return self._linear_edge(to, path) if linear else self._kienzle(to, path)

    def _kienzle(self, to: Reading, path: Path) -> Material:
        assert self.kc11 is not None and self.mc is not None
        normal, axial = self.normal_ratio, self.axial_ratio
        assumed = []
        if normal is None:
            normal = DEFAULT_NORMAL_RATIO
            assumed.append(f"normal force {normal:g} of the tangential")
            to.default((*path, "normal_ratio"), normal, "assumed")
        if axial is None:
            axial = DEFAULT_AXIAL_RATIO
            assumed.append(f"axial force {axial:g} of the tangential")
            to.default((*path, "axial_ratio"), axial, "assumed")
        law = Kienzle.from_ratios(kc11=self.kc11, mc=self.mc, normal_ratio=normal, axial_ratio=axial)
        return self._material(law, tuple(assumed), path)

    def _linear_edge(self, to: Reading, path: Path) -> Material:
        assert self.Ktc is not None and self.Kte is not None and self.Krc is not None and self.Kre is not None
        assumed: tuple[str, ...] = ()
        if self.Kac is None and self.Kae is None:
            assumed = ("no axial force",)
            to.default((*path, "Kac"), 0.0, "assumed")
        law = LinearEdge(
            ktc=self.Ktc, kte=self.Kte, krc=self.Krc, kre=self.Kre, kac=self.Kac or 0.0, kae=self.Kae or 0.0
        )
        return self._material(law, assumed, path)

    def _material(self, law: Kienzle | LinearEdge, assumed: tuple[str, ...], path: Path) -> Material:
        name = str(path[-1])
        source = self.source or "own, without a source"
        return Material(id=name, name=name, law=law, source=source, assumed=assumed, rake=self.rake)


_FORM: Final = Record(MaterialForm, "the material")


@frozen(kw_only=False)
class MaterialKind(Kind):
    """A custom material."""

    @property
    def expected(self) -> str:
        return "a material such as `{kc11: 1700 N/mm^2, mc: 0.25}`"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        return _FORM.read(node, to, path)

    def schema(self, definitions: dict[str, Json]) -> Json:
        return _FORM.schema(definitions)

    def show(self, value: Any) -> Any:
        return _FORM.show(written_as(value))

    def plain(self, value: Any) -> tuple[str, Any]:
        return _FORM.plain(written_as(value))


def written_as(material: Material) -> MaterialForm:
    """The keys that give this material."""
    law = material.law
    assert law is not None  # only the library has materials without one
    if isinstance(law, Kienzle):
        ratios = {"normal_ratio": law.kn11 / law.kc11, "axial_ratio": law.ka11 / law.kc11}
        return MaterialForm(kc11=law.kc11, mc=law.mc, **ratios, rake=material.rake, source=material.source)
    constants = {"Ktc": law.ktc, "Kte": law.kte, "Krc": law.krc, "Kre": law.kre, "Kac": law.kac, "Kae": law.kae}
    return MaterialForm(**constants, rake=material.rake, source=material.source)
