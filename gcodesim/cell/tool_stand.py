"""Stands of a quick-change system: where an arm sets its tools down and takes others."""

from __future__ import annotations

from typing import Final

from gcodesim.cell.placing import POINT, Place
from gcodesim.cell.tooling import TOOL_NUMBERS
from gcodesim.declarations.keys import inline, key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen


@frozen
class StandSpec:
    """One stand. Its place is that of the flange while the tool is coupled there: Z points into the tool."""

    place: Place = inline(Place)
    approach: float = key(
        Quantity("length", POSITIVE),
        "how far back along Z the flange waits without the tool",
        default=0.1,
        example="100 mm",
    )
    slide: tuple[float, float, float] = key(
        POINT,
        "how the tool leaves the stand, in axes of what the stand stands in",
        default=(0.0, 0.0, 0.1),
        example="[0, -120, 0 mm]",
    )


STANDS: Final = MapOf(
    TOOL_NUMBERS,
    Record(StandSpec, "the stand"),
    "stands by the numbers of their tools, such as `2: {in: rack, xyz: [0, 150, 200], rpy: [180, 0, 0]}`",
)
