"""What programs of 3D printers say besides moves: limits of the firmware's planner, and what is being printed."""

from __future__ import annotations

from typing import NamedTuple

Four = tuple[float, float, float, float]
"""Values for X, Y, Z [m] and for the filament E [m of filament]."""


class MotionLimits(NamedTuple):
    """Limits that the planner of a printer or of grbl keeps, as its program leaves them; SI, E in metres of filament.

    `speed`, `acceleration` and `jerk` are those of the axes. `printing`, `retracting` and `travel` are the
    accelerations [m/s²] of moves that extrude, of E alone, and of moves that do not. Corners are passed by `corner`
    [m/s], the speed through a right angle (Klipper's square corner velocity), else by `deviation` [m] (Marlin's
    junction deviation), else by `jerk`, the step in speed of each axis. The planner looks `buffer` moves ahead. grbl's
    is `plain`: rapids pass corners as other moves do, and short moves have no law of their own.
    """

    speed: Four
    acceleration: Four
    jerk: Four
    printing: float
    retracting: float
    travel: float
    deviation: float = 0.0
    corner: float = 0.0
    buffer: int = 16
    plain: bool = False


class Section(NamedTuple):
    """What slicers' comments say is printed: layer (from 1; 0: before it), feature, size of bead [m] (0: unsaid)."""

    layer: int = 0
    feature: str = ""
    width: float = 0.0
    height: float = 0.0
