"""Pairs of bodies that may touch, as a robot's description names pairs that collision checks leave out."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gcodesim.declarations.kind import Json, Kind, listing, scalar
from gcodesim.declarations.nodes import Node
from gcodesim.declarations.reading import UNREAD, Path, Reading, Unread, suggestion
from gcodesim.frozen import frozen
from gcodesim.kinematics.chain import BASE

if TYPE_CHECKING:
    from gcodesim.cell.cell import Cell


@frozen(kw_only=False)
class PairKind(Kind):
    """`[arm/link_4, post]`."""

    @property
    def expected(self) -> str:
        return "two names of bodies in brackets"

    def read(self, node: Node, to: Reading, path: Path) -> tuple[str, str] | Unread:
        items = listing(self, node, to, path, count=2)
        if isinstance(items, Unread):
            return UNREAD
        one, other = (scalar(self, item, to, (*path, index)) for index, item in enumerate(items))
        if isinstance(one, Unread) or isinstance(other, Unread):
            return UNREAD
        return one.text, other.text

    def schema(self, definitions: dict[str, Json]) -> Json:
        return {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}

    def show(self, value: Any) -> Any:
        return list(value)

    def plain(self, value: Any) -> tuple[str, Any]:
        return "", list(value)


def check_touching(cell: Cell, to: Reading) -> None:
    """GS712 for each name of `limits: {may_touch: …}` that is no body of the cell."""
    movers = [*cell.robots, *(["machine"] if cell.machine is not None else [])]
    known = [*cell.link_names, *(f"{name}/{BASE}" for name in movers)]
    known += [tool.name for tool in cell.tools.values()]
    known += [*cell.fixtures, *cell.stocks, *cell.parts, *cell.devices]
    for index, pair in enumerate(cell.limits.may_touch):
        for place, name in enumerate(pair):
            if name not in known:
                span = to.span(("limits", "may_touch", index, place))
                to.fault("GS712", span, f"there is no body `{name}`", suggestion(name, known))
