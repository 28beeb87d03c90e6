"""The state that a control keeps between blocks.

Lengths are in the program's active unit (`unit` [m]), angles in degrees:
expressions read positions back, and G21's 10 must read as exactly 10. Events
are SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from gcodesim.canon import Axes, Event

# X Y Z A B C U V W in program units and degrees
Vector = tuple[float, float, float, float, float, float, float, float, float]

ZERO: Vector = (0.0,) * 9
LINEAR = (True, True, True, False, False, False, True, True, True)
AXES = "xyzabcuvw"
_SWITCHES = {"feed": True, "speed": True, "adaptive": False, "hold": True}


@dataclass(slots=True)
class Modes:
    """The modes that M70 saves and M72 restores."""

    plane: int = 170
    incremental: bool = False
    centre_absolute: bool = False
    feed_mode: int = 940
    retract: int = 990
    path: int = 640
    path_tolerance: float = 0.0  # [m]
    path_naive: float = 0.0  # [m]
    diameter: bool = False  # G7
    surface_speed: bool = False  # G96
    surface_speed_cap: float | None = None
    feed_override: bool = True
    speed_override: bool = True
    adaptive_feed: bool = False
    feed_hold: bool = True
    flood: bool = False
    mist: bool = False


@dataclass(slots=True)
class ModalState(Modes):
    """The whole modal state. Copied before a block that may fail half-way, so vectors are replaced, never changed."""

    unit: float = 1e-3  # [m] per program unit: G21 or G20
    current: Vector = ZERO  # in the active work system
    origin: Vector = ZERO  # of the active work system
    rotation: float = 0.0  # of the active work system [deg]
    system: int = 1
    g92: Vector = ZERO
    tool_offset: Vector = ZERO
    point_control: bool = False  # moves are those of the tip in the work
    motion: int = -1
    feed: float = 0.0  # the F word as written
    feed_unit: float = 1e-3  # [m], the unit when it was written
    speed: float = 0.0  # the S word as written
    speed_unit: float = 1e-3  # [m], the unit when it was written
    spindle: int = 0  # +1 M3, -1 M4
    oriented: bool = False  # M19 holds the spindle until M3, M4 or M5
    tool: int = 0
    selected: int = -1  # T word waiting for M6
    # canned cycles: the sticky words of the running chain, and where the chain began
    cycle: int = -1
    cycle_words: tuple[tuple[str, float], ...] = ()
    cycle_start: float = 0.0
    cycle_dwell: float = 0.0  # the last P of a cycle, which G74 and G84 take when they have none
    switches: Mapping[str, bool] = field(default_factory=lambda: _SWITCHES)  # of overrides, as the machine has them
    # after G88 the program believes it is where the operator brings the tool: the block, and the real position
    strayed: tuple[int, Axes] | None = None
    # cutter compensation: side +1 left, -1 right; `comp_first` until its first move is made
    side: int = 0
    comp_radius: float = 0.0
    comp_orientation: int = 0
    comp_first: bool = True
    comp_leaving: bool = False
    comp_programmed: Vector = ZERO
    comp_normal: tuple[float, float] = (0.0, 0.0)
    comp_endpoint: tuple[float, float] | None = None  # where the move before the held one ended
    comp_emitted: Vector = ZERO
    held: tuple[Event, ...] = ()  # moves that wait for the next corner, and the events after them
    # G5: end tangent of the spline before, G5.2: control points collected so far
    spline_tangent: tuple[float, float] | None = None
    nurbs_order: int = 0
    nurbs_points: tuple[tuple[float, float, float], ...] = ()

    @property
    def turning(self) -> int:
        """The direction in which the spindle really turns: +1 as M3, -1 as M4, 0 at rest or held by M19."""
        return 0 if self.oriented else self.spindle

    def copy(self) -> Self:
        """An independent copy of the state."""
        twin = object.__new__(type(self))
        twin.restore(self)
        return twin

    def restore(self, earlier: ModalState) -> None:
        """Take all values from `earlier`."""
        for name in self.__dataclass_fields__:  # of subclasses too
            setattr(self, name, getattr(earlier, name))


def add(a: Vector, b: Vector) -> Vector:
    return tuple(map(float.__add__, a, b))  # type: ignore[return-value]


def subtract(a: Vector, b: Vector) -> Vector:
    return tuple(map(float.__sub__, a, b))  # type: ignore[return-value]


def scaled(a: Vector, factor: float) -> Vector:
    """Linear components times `factor`; rotary ones as they are."""
    x, y, z, p, q, r, u, v, w = a
    return (x * factor, y * factor, z * factor, p, q, r, u * factor, v * factor, w * factor)
