"""Proximity switch: whether something is near in front of it."""

from __future__ import annotations

from typing import ClassVar

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.sensors.switch import SightSwitch


@frozen
class ProximitySwitch(SightSwitch):
    """A switch that notices what comes within its range along its Z: inductive, capacitive, ultrasonic or by light.

    It takes everything for the same, metal or not, and looks along its axis only; hysteresis is not modelled.
    """

    kind: ClassVar[str] = "proximity_switch"
    order: ClassVar[tuple[str, str]] = ("switch", "read")
    noticed: ClassVar[str] = "detected"
    where: ClassVar[str] = "in front of it"

    range: float = key(
        Quantity("length", Range(above=0.0, most=100.0)),
        "how far it senses, from its face along its Z",
        default=0.01,
        example="8 mm",
    )

    @property
    def sightline(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        return (0.0, 0.0, 0.0), (0.0, 0.0, self.range)

    def figures(self, share: float) -> dict[str, float]:
        return {**SightSwitch.figures(self, share), "distance_m": self.range * min(share, 1.0)}
