"""How a cell writes the outline of a profile mill: points, and arcs about a centre."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.declarations.file_kind import File
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, Kind, listing
from gcodesim.declarations.nodes import Mapping, Node, Scalar
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen
from gcodesim.solids.turned import OutlineArc

_POINT: Final = Vector(Quantity("length"), 2, example="[3, 12.5 mm]")


@frozen
class ArcForm:
    """An arc of an outline as it is written; lengths [m]."""

    arc: tuple[float, float] = key(_POINT, "radius and height where the arc ends")
    centre: tuple[float, float] = key(_POINT, "radius and height of its centre")
    hollow: bool = key("switch", "the edge is hollow: the arc runs clockwise, radius to the right", default=False)


_DRAWING: Final = File("a drawing of the half section, .dxf or .svg, with the axis at x = 0")

_ARC: Final = Record(ArcForm, "an arc of the outline")


@frozen(kw_only=False)
class OutlineKind(Kind):
    """Points and arcs, each going on from the one before."""

    @property
    def expected(self) -> str:
        return (
            "a list of points and arcs such as `[[0, 0], {arc: [3, 3], centre: [0, 3]}, [3, 12 mm]]`, or the name of "
            "a drawing (.dxf, .svg)"
        )

    def read(self, node: Node, to: Reading, path: Path) -> Any:
        if isinstance(node, Scalar) and node.text.lower().endswith((".dxf", ".svg")):
            return _drawn(node, to, path)
        items = listing(self, node, to, path)
        if isinstance(items, Unread):
            return UNREAD
        pieces: list[tuple[float, float] | OutlineArc] = []
        for index, item in enumerate(items):
            at = (*path, index)
            value = _ARC.read(item, to, at) if isinstance(item, Mapping) else _POINT.read(item, to, at)
            if isinstance(value, Unread):
                return UNREAD
            if isinstance(value, ArcForm):
                if not pieces:
                    return to.fault("GS706", item.span, "`outline` begins with a point, not with an arc")
                value = OutlineArc(to=value.arc, centre=value.centre, ccw=not value.hollow)
            else:
                value = (value[0], value[1])
            pieces.append(value)
        return tuple(pieces)

    def schema(self, definitions: dict[str, Json]) -> Json:
        both = [_POINT.schema(definitions), _ARC.schema(definitions)]
        points = {"type": "array", "minItems": 2, "items": {"anyOf": both}}
        return {"anyOf": [points, _DRAWING.schema(definitions)]}

    def show(self, value: Any) -> Any:
        return [_ARC.show(_written(p)) if isinstance(p, OutlineArc) else _POINT.show(p) for p in value]

    def plain(self, value: Any) -> tuple[str, Any]:
        pairs = [_ARC.plain(_written(p)) if isinstance(p, OutlineArc) else _POINT.plain(p) for p in value]
        return _POINT.plain((0.0, 0.0))[0], [content for _, content in pairs]


def _drawn(node: Scalar, to: Reading, path: Path) -> Any:
    """The outline of a drawing that the cell names."""
    from gcodesim.tools.drawing_files import strokes_of
    from gcodesim.tools.outline_file import DrawingError, outline_of

    file = _DRAWING.read(node, to, path)
    if isinstance(file, Unread):
        return UNREAD
    try:
        return outline_of(strokes_of(file.name, to.shelf.sources[file.name].raw))
    except DrawingError as reason:
        return to.fault("GS714", node.span, f"the drawing `{file.name}` is no outline: {reason}")


def _written(arc: OutlineArc) -> ArcForm:
    return ArcForm(arc=arc.to, centre=arc.centre, hollow=not arc.ccw)


OUTLINE: Final = OutlineKind()
