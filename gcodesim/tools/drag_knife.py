"""Drag knife: a blade that is drawn through sheets and does not turn."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.tools.conical_cutter import ConicalCutter
from gcodesim.units import DEG


@frozen
class DragKnife(ConicalCutter):
    """A blade on a swivel: it takes what its point covers on its way, whichever way it looks, and feels no force."""

    kind: ClassVar[str] = "drag_knife"
    turns: ClassVar[bool] = False

    angle: float = key("angle", "included angle of the blade", default=60.0 * DEG, rule="60 deg")
    flutes: int = key("count", "number of edges", default=1)

    def _edge_pieces(self) -> list[tuple[float, ...]]:
        return []
