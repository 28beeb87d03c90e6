"""Light barrier: a beam between two points, and whether something is in it."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import WITHIN_REACH
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen
from gcodesim.sensors.switch import SightSwitch


@frozen
class LightBarrier(SightSwitch):
    """A beam from a sender, which is in the place of the sensor, to a receiver or a reflector.

    The beam is a line: a real one has some width, and switches when about half of it is covered.
    """

    kind: ClassVar[str] = "light_barrier"
    order: ClassVar[tuple[str, str]] = ("barrier", "read")
    noticed: ClassVar[str] = "broken"
    where: ClassVar[str] = "in its beam"

    beam: tuple[float, float, float] = key(
        Vector(Quantity("length", WITHIN_REACH), 3),
        "from the sender to the receiver, in the frame of the sensor",
        default=(0.0, 0.0, 1.0),
        example="[0, 400 mm, 0]",
    )

    @property
    def sightline(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        return (0.0, 0.0, 0.0), self.beam

    def problems(self) -> list[tuple[str, str]]:
        if not any(self.beam):
            return [("beam", "sender and receiver are at the same place, so there is no beam")]
        return []
