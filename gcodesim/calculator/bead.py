"""Beads: what a nozzle lays, and how much of it a length of filament is."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.extruder import Extruder
from gcodesim.units import MM

_LENGTH = Quantity("length", POSITIVE)
_ROUND = 1e-9  # a bead that is narrower than high by less than this share is round, and its flow was rounded


def _extruder(width: float, height: float, filament: float = 1.75 * MM) -> Extruder:
    found = Extruder(bead_width=width, bead_height=height, filament_diameter=filament)
    for _, problem in found.problems():
        raise CannotComputeError(problem)
    return found


@frozen
class FilamentLine(Model):
    """One line of a print: its volume, and the filament for it."""

    kind: ClassVar[str] = "additive.fdm"
    says: ClassVar[str] = "section, volume and filament of a printed line"
    source: ClassVar[str] = "A = (w-h) h + pi h^2/4, a rectangle between two half circles; E = A L / (pi d^2/4)"
    also: ClassVar[tuple[str, ...]] = ("fdm", "additive.filament", "printing")
    spellings: ClassVar[dict[str, str]] = {
        "width": "extrusion_width", "line_width": "extrusion_width", "bead_width": "extrusion_width",
        "height": "layer_height", "bead_height": "layer_height", "length": "move",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("bead_area", "area", "section of the bead", ("area", "section")),
        Result("E", "length", "filament that it takes", ("filament_length", "filament")),
        Result("volume", "volume", "of the line"),
        Result("flow", "volume flow", "at `speed`", ("volume_flow",)),
        Result("filament_speed", "speed", "at `speed`", ("feeder_speed",)),
    )

    filament_diameter: float = key(_LENGTH, "of the filament", default=1.75 * MM)
    layer_height: float = key(_LENGTH, "height of the layer", example="0.2 mm")
    extrusion_width: float = key(_LENGTH, "width of the bead", example="0.45 mm")
    move: float = key(_LENGTH, "length of the line", example="40 mm")
    speed: float | None = key("speed", "of the nozzle", default=None, example="60 mm/s")

    def compute(self) -> dict[str, Value]:
        extruder = _extruder(self.extrusion_width, self.layer_height, self.filament_diameter)
        area = extruder.bead_area
        found: dict[str, Value] = {
            "bead_area": area,
            "volume": area * self.move,
            "E": area * self.move / extruder.filament_area,
        }
        if self.speed is not None:
            found |= {"flow": area * self.speed, "filament_speed": area * self.speed / extruder.filament_area}
        return found


@frozen
class BeadSection(Model):
    """A bead by its width and height, or the width that a flow at a speed gives."""

    kind: ClassVar[str] = "additive.bead"
    says: ClassVar[str] = "section of a bead, or its width from flow and speed"
    source: ClassVar[str] = "A = (w-h) h + pi h^2/4 = flow / speed; w = A/h + h (1 - pi/4)"
    also: ClassVar[tuple[str, ...]] = ("bead",)
    spellings: ClassVar[dict[str, str]] = {
        "bead_width": "width", "layer_height": "height", "bead_height": "height", "volume_flow": "flow",
        "flow_rate": "flow", "v": "speed", "travel_speed": "speed", "nozzle_speed": "speed", "print_speed": "speed",
        "length": "path_length", "path": "path_length",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("bead_area", "area", "section of the bead", ("area", "section")),
        Result("bead_width", "length", "its width", ("width",)),
        Result("flow", "volume flow", "that it takes at `speed`", ("volume_flow", "flow_rate")),
        Result("volume", "volume", "of `path_length`"),
        Result("time", "time", "for `path_length` at `speed`"),
    )

    height: float = key(_LENGTH, "of the bead", example="3 mm")
    width: float | None = key(_LENGTH, "of the bead; or `flow` and `speed`", default=None, example="6 mm")
    flow: float | None = key(Quantity("volume flow", POSITIVE), "through the nozzle", default=None)
    speed: float | None = key(Quantity("speed", POSITIVE), "of the nozzle", default=None)
    path_length: float | None = key(_LENGTH, "way on which it is laid", default=None)

    def compute(self) -> dict[str, Value]:
        h = self.height
        if self.width is not None:
            width = self.width
        elif self.flow is not None and self.speed is not None:
            width = self.flow / self.speed / h + h * (1.0 - 0.25 * pi)
            width = h if abs(width - h) <= _ROUND * h else width
        else:
            raise CannotComputeError("how wide is the bead? give `width`, or `flow` and `speed`")
        area = _extruder(width, h).bead_area
        found: dict[str, Value] = {"bead_area": area, "bead_width": width}
        if self.speed is not None:
            found["flow"] = area * self.speed
        if self.path_length is not None:
            found["volume"] = area * self.path_length
            if self.speed is not None:
                found["time"] = self.path_length / self.speed
        return found
