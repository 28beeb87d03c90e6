"""Mesh files that a cell names, with their unit: read for their size, and for faults."""

from __future__ import annotations

from pathlib import Path as FilePath

from gcodesim.declarations.file_kind import FileValue
from gcodesim.declarations.kind import Json, Kind, scalar, short
from gcodesim.declarations.mesh_size import MESH_SUFFIXES, bounds
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.units import find, names
from gcodesim.diagnostics import Diagnostic
from gcodesim.frozen import frozen
from gcodesim.solids import Mesh, MeshFile, Point


@frozen
class MeshShape:
    """A mesh file of the cell: its points times `scale` are metres; `lower` and `upper` are its corners [m]."""

    name: str
    path: FilePath
    scale: float
    lower: Point
    upper: Point

    @property
    def solid(self) -> Mesh:
        return Mesh(source=MeshFile(path=self.path, scale=(self.scale, self.scale, self.scale)))


@frozen(kw_only=False)
class _LengthUnit(Kind):
    """The unit of a mesh file, as its factor."""

    @property
    def expected(self) -> str:
        return f"a unit of length ({', '.join(names('length'))})"

    def read(self, node: Node, to: Reading, path: Path) -> str | Unread:
        text = scalar(self, node, to, path)
        if isinstance(text, Unread):
            return UNREAD
        unit = find(text.text, "length")
        if unit is None:
            return to.fault("GS709", text.span, f"`{path[-1]}` is `{short(text.text)}`; {self.expected} is expected")
        return unit.name

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"enum": list(names("length"))}


LENGTH_UNIT = _LengthUnit()


def mesh_shape(file: FileValue, unit: str | None, to: Reading, path: Path) -> MeshShape | Unread:
    """The shape of the file that the key `mesh` at `path` names, in the unit that the key `unit` beside it names."""
    span = to.span((*path, "mesh"))
    if FilePath(file.name).suffix.lower() not in MESH_SUFFIXES:
        return to.fault(
            "GS716",
            span,
            f"`{short(file.name)}` is no mesh file that is read",
            f"these are: {', '.join(MESH_SUFFIXES)}",
        )
    corners = bounds(file.path, to.shelf.sources[file.name].raw)
    if isinstance(corners, str):
        return to.fault("GS716", span, f"`{short(file.name)}` is no sound mesh: {corners}")
    scale = find(unit or "mm", "length")
    assert scale is not None
    lower = (corners[0][0] * scale.factor, corners[0][1] * scale.factor, corners[0][2] * scale.factor)
    upper = (corners[1][0] * scale.factor, corners[1][1] * scale.factor, corners[1][2] * scale.factor)
    if unit is None:
        size = " x ".join(f"{(high - low) / 1e-3:.6g}" for low, high in zip(lower, upper, strict=True)) + " mm"
        to.findings.add(
            Diagnostic(
                code="GS717",
                span=span,
                message=f"`{short(file.name)}` has no `unit`; in mm it is {size}",
                hint="write `unit: mm` (or `m`, `in`) beside it",
            )
        )
        to.default((*path, "unit"), "mm", "assumed")
    return MeshShape(name=file.name, path=file.path, scale=scale.factor, lower=lower, upper=upper)
