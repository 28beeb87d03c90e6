"""A round wall that is printed in one spiral, as a vase."""

from __future__ import annotations

from math import pi, sqrt
from typing import ClassVar

from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.extruder import Extruder
from gcodesim.units import MM

_LENGTH = Quantity("length", POSITIVE)


@frozen
class SpiralWall(Model):
    """One bead that rises by a layer in each turn."""

    kind: ClassVar[str] = "additive.spiral"
    says: ClassVar[str] = "path, volume and time of a round wall laid as a spiral"
    source: ClassVar[str] = (
        "turns = H/h, path = turns sqrt((pi D)^2 + h^2), volume = path times the section of the bead"
    )
    also: ClassVar[tuple[str, ...]] = (
        "spiral",
        "additive.spiral_wall",
        "spiral_wall",
        "additive.vase",
        "additive.helix",
    )
    spellings: ClassVar[dict[str, str]] = {
        "radius": "wall_radius", "D": "diameter", "wall_diameter": "diameter", "height": "wall_height",
        "H": "wall_height",
        "bead_height": "layer_height", "pitch": "layer_height", "width": "bead_width", "extrusion_width": "bead_width",
        "wall_thickness": "bead_width", "v": "speed", "print_speed": "speed", "layers": "turns",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("turns", "", "of the spiral"),
        Result("path_length", "length", "of the spiral", ("length", "path")),
        Result("bead_area", "area", "section of the bead", ("area",)),
        Result("volume", "volume", "of the wall", ("wall_volume",)),
        Result("E", "length", "filament that it takes", ("filament_length", "filament")),
        Result("time", "time", "at `speed`", ("print_time",)),
        Result("flow", "volume flow", "at `speed`", ("volume_flow",)),
    )

    diameter: float | None = key(_LENGTH, "of the middle of the wall", default=None, example="80 mm")
    wall_radius: float | None = key(_LENGTH, "half of that, in its place", default=None)
    layer_height: float = key(_LENGTH, "by which a turn rises", example="0.3 mm")
    bead_width: float = key(_LENGTH, "of the bead", example="0.6 mm")
    wall_height: float | None = key(_LENGTH, "of the wall; or `turns`", default=None, example="60 mm")
    turns: float | None = key(Quantity("ratio", POSITIVE), "of the spiral", default=None)
    filament_diameter: float = key(_LENGTH, "of the filament", default=1.75 * MM)
    speed: float | None = key(Quantity("speed", POSITIVE), "of the nozzle", default=None)

    def compute(self) -> dict[str, Value]:
        across = self.diameter if self.diameter is not None else 2.0 * (self.wall_radius or 0.0)
        if not across:
            raise CannotComputeError("how wide is the wall? give `diameter`")
        turns = self.turns
        if turns is None:
            if self.wall_height is None:
                raise CannotComputeError("how high is the wall? give `wall_height` or `turns`")
            turns = self.wall_height / self.layer_height
        extruder = Extruder(
            bead_width=self.bead_width, bead_height=self.layer_height, filament_diameter=self.filament_diameter
        )
        for _, problem in extruder.problems():
            raise CannotComputeError(problem)
        round_ = pi * across
        path = turns * sqrt(round_ * round_ + self.layer_height * self.layer_height)
        area = extruder.bead_area
        found: dict[str, Value] = {
            "turns": turns,
            "path_length": path,
            "bead_area": area,
            "volume": area * path,
            "E": area * path / extruder.filament_area,
        }
        if self.speed is not None:
            found |= {"time": path / self.speed, "flow": area * self.speed}
        return found
