"""What a printer's control remembers besides the places of its axes."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi

from gcodesim.canon.printing import MotionLimits, Section
from gcodesim.rs274.marlin.said import Key
from gcodesim.rs274.state import ZERO, Vector
from gcodesim.units import MM

FIRST_FEED = 1500.0
"""[mm/min] before the first F; Marlin's default."""


@dataclass(slots=True)
class Printer:
    """State of the extruder, of the planner and of the comments; lengths of filament in mm, as they are written.

    `e` is the position of E, `e_relative` whether E words are steps. `areas` has the section [mm²] by which volumetric
    E words are divided, by tool (M200). `flow` and `pace` are M221 and M220. `retraction` and `recovery` are length
    [mm], speed [mm/min] and lift [mm] of G10 and G11; `is_retracted` whether G10 is in force. `said` has the
    settings in force as lines. `tool` is the nozzle in use, `chosen` the one that a T has chosen (-1: none), `coming`
    the one that it is about to choose. `points` are places [m] that moves with R start from (G60 of RepRapFirmware).
    """

    limits: MotionLimits
    e: float = 0.0
    e_relative: bool = False
    feed: float = FIRST_FEED
    flow: dict[int, float] = field(default_factory=dict)
    pace: float = 1.0
    areas: dict[int, float] = field(default_factory=dict)
    offsets: dict[int, Vector] = field(default_factory=dict)
    tool: int = 0
    chosen: int | None = None
    coming: int | None = None
    points: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    section: Section = field(default_factory=Section)
    layers: int = 0
    said_layers: bool = False
    retraction: tuple[float, float, float] = (3.0, 2700.0, 0.0)
    recovery: tuple[float, float] = (0.0, 480.0)
    is_retracted: bool = False
    said: dict[Key, str] = field(default_factory=dict)
    saved: dict[str, tuple[Vector, bool, bool, float, float]] = field(default_factory=dict)

    def filament(self, delta: float, unit: float) -> float:
        """Filament [m] for a step of E by `delta`, with `unit` [m] of the program."""
        area = self.areas.get(self.tool, 0.0)
        length = delta / area * MM if area > 0.0 else delta * unit
        return length * self.flow.get(self.tool, 1.0)

    def offset_of(self, tool: int) -> Vector:
        return self.offsets.get(tool, ZERO)

    @property
    def speed(self) -> float:
        """The feed in force [program units/min], with M220."""
        return self.feed * self.pace


def area_of(diameter: float) -> float:
    """The section [mm²] of filament of a diameter [mm]."""
    return 0.25 * pi * (diameter * diameter)
