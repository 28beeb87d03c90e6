"""What the control of a printer is set to: the limits of its planner, until the program sets others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.reading import Path, Reading, Unread
from gcodesim.frozen import frozen

_AXES: Final = 4  # X, Y, Z and the filament E


@frozen
class Firmware:
    """Limits [m, s] that stand in place of the defaults of the dialect; None: as the dialect has it."""

    speed: tuple[float, ...] | None = key(
        Vector(Quantity("speed", POSITIVE), _AXES, "[500, 500, 12, 60 mm/s]"),
        "greatest speed of X, Y, Z and the filament (M203)",
        default=None,
    )
    acceleration: tuple[float, ...] | None = key(
        Vector(Quantity("acceleration", POSITIVE), _AXES, "[5000, 5000, 200, 10000 mm/s^2]"),
        "greatest acceleration of X, Y, Z and the filament (M201)",
        default=None,
    )
    printing: float | None = key(
        Quantity("acceleration", POSITIVE), "acceleration of moves that extrude (M204 P)", default=None
    )
    travel: float | None = key(
        Quantity("acceleration", POSITIVE), "acceleration of moves that do not (M204 T)", default=None
    )
    retracting: float | None = key(
        Quantity("acceleration", POSITIVE), "acceleration of the filament alone (M204 R)", default=None
    )
    jerk: tuple[float, ...] | None = key(
        Vector(Quantity("speed", NOT_NEGATIVE), _AXES, "[10, 10, 0.3, 5 mm/s]"),
        "by how much the speed of X, Y, Z and the filament may step in a corner: classic jerk (M205 X Y Z E)",
        default=None,
    )
    junction_deviation: float | None = key(
        Quantity("length", POSITIVE),
        "corners by junction deviation: of Marlin in place of jerk (M205 J), of grbl (`$11`)",
        default=None,
    )
    corner_speed: float | None = key(
        Quantity("speed", POSITIVE), "speed through a right angle: Klipper's square corner velocity", default=None
    )

    def checked(self, to: Reading, path: Path) -> Firmware | Unread:
        if self.junction_deviation is not None and self.corner_speed is not None:
            return to.fault(
                "GS719",
                to.key((*path, "corner_speed")),
                "corners go by `junction_deviation` or by `corner_speed`, not by both",
                "give the one that the control has",
            )
        return self

    @property
    def limits(self) -> Mapping[str, Any]:
        """What is said, by the names of `canon.MotionLimits`. Who says how corners are passed says it wholly."""
        said = {name: getattr(self, name) for name in ("speed", "acceleration", "printing", "travel", "retracting")}
        if (self.jerk, self.junction_deviation, self.corner_speed) != (None, None, None):
            said |= {"jerk": self.jerk, "deviation": self.junction_deviation or 0.0, "corner": self.corner_speed or 0.0}
        return {name: value for name, value in said.items() if value is not None}
