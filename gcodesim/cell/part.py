"""`parts:` of the cell: rigid things that grippers, conveyors and hands carry."""

from __future__ import annotations

from typing import ClassVar, Final

from gcodesim.cell.placing import Place, names_of
from gcodesim.cell.stock import Fixture
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.map_of import MapOf
from gcodesim.declarations.quantity import Quantity
from gcodesim.declarations.record import Record
from gcodesim.frozen import frozen


@frozen
class PartSpec(Fixture):
    """A rigid thing that is carried. Where it stands at the start is its place; `goal` is where it is meant to end."""

    what: ClassVar[str] = "part"

    mass: float | None = key(
        Quantity("mass", POSITIVE), "its mass", default=None, rule="that of steel of this size", example="2 kg"
    )
    friction: float | None = key(
        Quantity("ratio", NOT_NEGATIVE),
        "between it and whatever holds it; of two coefficients the lesser counts",
        default=None,
        rule="that of the gripper",
        example="0.4",
    )
    goal: Place | None = key(
        Record(Place, "a place"),
        "where its frame is meant to be at the end; the results say how far off it is",
        default=None,
        quiet=True,
    )


PARTS: Final = MapOf(
    names_of("part"),
    Record(PartSpec, "the part"),
    "parts by name, such as `plate: {box: [100, 60, 20], mass: 2 kg, in: table}`",
    lenient=True,
)
