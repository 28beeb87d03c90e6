"""Arc welding with a wire: section of the bead, heat for each length, rate of deposition."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.calculator.model import Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen

_SPEED = Quantity("speed", POSITIVE)
_LENGTH = Quantity("length", POSITIVE)
_SHARE = Quantity("ratio", Range(above=0.0, most=1.0))


@frozen
class ArcWeld(Model):
    """A bead of molten wire."""

    kind: ClassVar[str] = "additive.weld"
    says: ClassVar[str] = "bead, heat input and deposition of arc welding with a wire"
    source: ClassVar[str] = (
        "A = (pi d^2/4) v_wire / v, times what does not spatter; E = eta U I / v (EN 1011-1: eta 0.8 for MAG); a"
        " parabolic bead has A = 2/3 w h"
    )
    also: ClassVar[tuple[str, ...]] = (
        "weld",
        "arc_weld",
        "additive.arc_weld",
        "weld.arc",
        "additive.waam",
        "waam",
        "welding",
    )
    spellings: ClassVar[dict[str, str]] = {
        "wire_feed": "wire_speed", "wire_feed_speed": "wire_speed", "wfs": "wire_speed", "v_wire": "wire_speed",
        "weld_speed": "travel_speed", "welding_speed": "travel_speed", "speed": "travel_speed", "v": "travel_speed",
        "U": "voltage", "I": "current", "arc_efficiency": "efficiency", "thermal_efficiency": "efficiency",
        "eta": "efficiency", "bead_width": "width", "bead_height": "height", "length": "weld_length",
        "wire_density": "density", "process_efficiency": "efficiency", "deposition_yield": "deposition_efficiency",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("bead_area", "area", "section of the bead", ("area", "section")),
        Result("wire_ratio", "", "wire over travel speed"),
        Result("heat_input", "energy per length", "for each length of the bead", ("E", "heat_input_per_length")),
        Result("arc_power", "power", "voltage times current", ("power",)),
        Result("volume_rate", "volume flow", "that stays in the bead", ("volume_flow", "deposition_volume_rate")),
        Result("deposition_rate", "mass flow", "that stays in the bead", ("mass_rate",)),
        Result("mass_per_length", "", "kg for each metre of the bead"),
        Result("bead_height", "length", "of a parabola as wide as `width`", ("height",)),
        Result("bead_width", "length", "of a parabola as high as `height`", ("width",)),
        Result("volume", "volume", "of `weld_length`"),
        Result("time", "time", "for `weld_length`"),
    )

    wire_diameter: float = key(_LENGTH, "of the wire", example="1.2 mm")
    wire_speed: float = key(_SPEED, "of the wire", example="8 m/min")
    travel_speed: float = key(_SPEED, "of the torch", example="500 mm/min")
    deposition_efficiency: float = key(_SHARE, "share of the wire that stays", default=1.0)
    voltage: float | None = key(Quantity("voltage", POSITIVE), "of the arc", default=None, example="22 V")
    current: float | None = key(Quantity("current", POSITIVE), "of the arc", default=None, example="180 A")
    efficiency: float = key(_SHARE, "share of the arc's heat that gets into the work", default=0.8)
    density: float = key(Quantity("density", POSITIVE), "of the wire", default=7850.0)
    width: float | None = key(_LENGTH, "of the bead, for its height", default=None)
    height: float | None = key(_LENGTH, "of the bead, for its width", default=None)
    weld_length: float | None = key(_LENGTH, "for volume and time", default=None)

    def compute(self) -> dict[str, Value]:
        wire = 0.25 * pi * self.wire_diameter * self.wire_diameter
        rate = wire * self.wire_speed * self.deposition_efficiency
        area = rate / self.travel_speed
        found: dict[str, Value] = {
            "bead_area": area,
            "wire_ratio": self.wire_speed / self.travel_speed,
            "volume_rate": rate,
            "deposition_rate": rate * self.density,
            "mass_per_length": area * self.density,
        }
        if self.voltage is not None and self.current is not None:
            found["arc_power"] = self.voltage * self.current
            found["heat_input"] = self.efficiency * self.voltage * self.current / self.travel_speed
        if self.width is not None:
            found["bead_height"] = 1.5 * area / self.width
        if self.height is not None:
            found["bead_width"] = 1.5 * area / self.height
        if self.weld_length is not None:
            found |= {"volume": area * self.weld_length, "time": self.weld_length / self.travel_speed}
        return found
