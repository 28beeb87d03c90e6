"""The finished part against its target, in the form of `results.json`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.numbers import rounded
from gcodesim.units import MM, MM2, MM3

if TYPE_CHECKING:
    from gcodesim.material.scallops import Scallops

MOST_REGIONS: Final = 100
"""Regions that results tell one by one; the volumes of all are added up."""


@frozen
class MakerLine:
    """A program line that made a face of a region, with the tool number, and its share of the region's volume."""

    span: Span
    tool: int
    share: float

    def as_json(self) -> dict[str, Any]:
        return {"file": self.span.file, "line": self.span.line, "tool": self.tool, "share": rounded(self.share)}


@frozen
class RegionResult:
    """One place out of tolerance: volume [m³], area [m²], depth [m], and `at` in a work `system` [m].

    `lines` made its faces, the one with the greatest share first; `guilty` is the one to look at, with its `tool` and
    path row in program `program`. Where no tool made a face, it is the one that came nearest, up to `gap` [m], or None.
    `others` go through a gouge as well: they would make one there once `guilty` is mended.
    """

    gouge: bool
    volume: float
    area: float
    depth: float
    system: str
    at: tuple[float, float, float]
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    lines: Sequence[MakerLine]
    guilty: Span | None
    tool: int | None
    gap: float | None
    time: float | None
    others: Sequence[Span] = ()

    def as_json(self) -> dict[str, Any]:
        return {
            "kind": "gouge" if self.gouge else "excess",
            "volume_mm3": rounded(self.volume / MM3),
            "area_mm2": rounded(self.area / MM2),
            "depth_mm": rounded(self.depth / MM),
            "system": self.system,
            **{f"{axis}_mm": rounded(value / MM) for axis, value in zip("xyz", self.at, strict=True)},
            "low_mm": [rounded(value / MM) for value in self.low],
            "high_mm": [rounded(value / MM) for value in self.high],
            "file": None if self.guilty is None else self.guilty.file,
            "line": None if self.guilty is None else self.guilty.line,
            "tool": self.tool,
            "gap_mm": None if self.gap is None else rounded(self.gap / MM),
            "lines": [line.as_json() for line in self.lines],
            "others": [{"file": span.file, "line": span.line} for span in self.others],
        }


@frozen
class LooseResult:
    """A loose body of the stock beside the part: volume [m³], a point in it in a work system [m]."""

    volume: float
    system: str
    at: tuple[float, float, float]

    def as_json(self) -> dict[str, Any]:
        return {
            "volume_mm3": rounded(self.volume / MM3),
            "system": self.system,
            **{f"{axis}_mm": rounded(value / MM) for axis, value in zip("xyz", self.at, strict=True)},
        }


@frozen
class TargetResult:
    """A stock against its target: lengths [m], areas [m²], volumes [m³]; `least` below 0 is the deepest gouge."""

    stock: str
    mesh: str
    tolerance: float
    least: float
    most: float
    area: float
    area_outside: float
    gouge: float
    excess: float
    gouges: int
    excesses: int
    regions: Sequence[RegionResult]
    loose: Sequence[LooseResult]
    scallops: Sequence[Scallops] = ()

    @property
    def share_outside(self) -> float:
        return self.area_outside / self.area if self.area > 0.0 else 0.0

    def as_json(self) -> dict[str, Any]:
        return {
            "stock": self.stock,
            "mesh": self.mesh,
            "tolerance_mm": rounded(self.tolerance / MM),
            "least_deviation_mm": rounded(self.least / MM),
            "most_deviation_mm": rounded(self.most / MM),
            "area_mm2": rounded(self.area / MM2),
            "share_outside": rounded(self.share_outside),
            "gouge_mm3": rounded(self.gouge / MM3),
            "excess_mm3": rounded(self.excess / MM3),
            "gouges": self.gouges,
            "excesses": self.excesses,
            "regions": [region.as_json() for region in self.regions],
            "loose": [each.as_json() for each in self.loose],
            "scallops": [
                {
                    "tool": each.work.tool,
                    "operation": each.work.operation,
                    "area_mm2": rounded(each.area / MM2),
                    "typical_mm": rounded(each.typical / MM),
                    "most_mm": rounded(each.most / MM),
                }
                for each in self.scallops
            ],
        }
