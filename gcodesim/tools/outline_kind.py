"""How a cell writes the outline of a profile mill: points, and arcs about a centre."""

from __future__ import annotations

from typing import Any, Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Json, Kind, listing
from gcodesim.declarations.nodes import Mapping, Node
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


_ARC: Final = Record(ArcForm, "an arc of the outline")


@frozen(kw_only=False)
class OutlineKind(Kind):
    """Points and arcs, each going on from the one before."""

    @property
    def expected(self) -> str:
        return "a list of points and arcs such as `[[0, 0], {arc: [3, 3], centre: [0, 3]}, [3, 12 mm]]`"

    def read(self, node: Node, to: Reading, path: Path) -> Any:
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
        return {"type": "array", "minItems": 2, "items": {"anyOf": both}}

    def show(self, value: Any) -> Any:
        return [_ARC.show(_written(p)) if isinstance(p, OutlineArc) else _POINT.show(p) for p in value]

    def plain(self, value: Any) -> tuple[str, Any]:
        pairs = [_ARC.plain(_written(p)) if isinstance(p, OutlineArc) else _POINT.plain(p) for p in value]
        return _POINT.plain((0.0, 0.0))[0], [content for _, content in pairs]


def _written(arc: OutlineArc) -> ArcForm:
    return ArcForm(arc=arc.to, centre=arc.centre, hollow=not arc.ccw)


OUTLINE: Final = OutlineKind()
