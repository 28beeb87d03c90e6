"""What may differ: one table of quantities, each with its unit and the difference that is tolerated."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from gcodesim.frozen import frozen


@frozen(kw_only=False)
class Tolerance:
    """Allows differences up to ``max(absolute, relative * |old|)``; `absolute` is in the unit of the quantity."""

    absolute: float
    relative: float = 0.0

    def limit(self, old: float) -> float:
        """The greatest difference from `old` that is allowed."""
        return max(self.absolute, self.relative * abs(old))

    def allows(self, old: float, new: float) -> bool:
        # the last bits of decimal numbers in a file are not a difference
        return abs(new - old) <= self.limit(old) * (1.0 + 1e-9) + 1e-12


@frozen
class Compared:
    """A row of the table: `dimension` is one of the cell file's, `unit` what files and messages show."""

    dimension: str
    unit: str
    default: Tolerance
    what: str


QUANTITIES: Final[Mapping[str, Compared]] = {
    "position": Compared(
        dimension="length", unit="mm", default=Tolerance(0.001), what="ends of moves, middles of arcs, tool offsets"
    ),
    "angle": Compared(dimension="angle", unit="deg", default=Tolerance(0.001), what="ends of moves of A, B, C"),
    "feed": Compared(dimension="speed", unit="mm/min", default=Tolerance(0.0, 1e-3), what="feed of a move"),
    "spindle": Compared(dimension="rotational speed", unit="rpm", default=Tolerance(0.0, 1e-3), what="spindle speed"),
    "dwell": Compared(dimension="time", unit="s", default=Tolerance(0.001), what="a dwell of the program"),
    "word": Compared(dimension="ratio", unit="", default=Tolerance(1e-6), what="other numbers of the program"),
    "time": Compared(dimension="time", unit="s", default=Tolerance(0.01, 1e-3), what="all other times of the results"),
    # where a cutter comes in and goes out is known to a step
    "engaged": Compared(
        dimension="time",
        unit="s",
        default=Tolerance(0.05, 5e-3),
        what="how long material is removed or added, which is known to a step",
    ),
    "distance": Compared(dimension="length", unit="mm", default=Tolerance(0.01, 1e-4), what="feed and rapid distance"),
    "volume": Compared(
        dimension="volume", unit="mm³", default=Tolerance(0.5, 1e-3), what="removed, deposited, remaining volume"
    ),
    "surface": Compared(dimension="length", unit="mm", default=Tolerance(0.01), what="height of a stock's surface"),
    "force": Compared(dimension="force", unit="N", default=Tolerance(0.5, 0.01), what="greatest force of a tool"),
    "torque": Compared(dimension="torque", unit="N·m", default=Tolerance(0.01, 0.01), what="torque of a tool"),
    "power": Compared(dimension="power", unit="W", default=Tolerance(1.0, 0.01), what="power of a tool"),
    "joint": Compared(
        dimension="ratio", unit="", default=Tolerance(0.01, 1e-3), what="travel and margin of joints, in deg or mm"
    ),
    "joint_speed": Compared(dimension="ratio", unit="", default=Tolerance(0.01, 0.02), what="greatest joint speeds"),
    "joint_acceleration": Compared(
        dimension="ratio",
        unit="",
        default=Tolerance(1.0, 0.1),
        what="greatest joint accelerations, deg or mm per s²",
    ),
    "joint_effort": Compared(
        dimension="ratio", unit="", default=Tolerance(0.5, 0.02), what="greatest joint efforts, in N·m or N"
    ),
    "path_accuracy": Compared(
        dimension="length", unit="mm", default=Tolerance(0.005, 0.02), what="how far an arm is off its path (ISO 9283)"
    ),
    "film": Compared(dimension="ratio", unit="", default=Tolerance(0.1, 2e-3), what="thickness of a film, in µm"),
    "covered": Compared(
        dimension="ratio", unit="", default=Tolerance(1e-3, 0.01), what="shares and areas of a coat or a target, in mm²"
    ),
    "dose": Compared(dimension="ratio", unit="", default=Tolerance(0.01, 1e-3), what="energies and doses of beams"),
    "count": Compared(dimension="ratio", unit="", default=Tolerance(0.0), what="counts, as of words not simulated"),
    "finding": Compared(dimension="ratio", unit="", default=Tolerance(0.01, 0.02), what="numbers inside findings"),
}

Tolerances = Mapping[str, Tolerance]
DEFAULTS: Final[Tolerances] = {name: quantity.default for name, quantity in QUANTITIES.items()}

# the quantity of a path of the results; the first that matches counts
_PATHS: Final = tuple(
    (re.compile(pattern), name)
    for pattern, name in (
        (r"joints\..*\.(least|most|margin)$", "joint"),
        (r"joints\..*\.max_speed$", "joint_speed"),
        (r"joints\..*\.max_acceleration$", "joint_acceleration"),
        (r"joints\..*\.max_effort$", "joint_effort"),
        (r"^path_accuracy\..*_mm$", "path_accuracy"),
        (r"_um$", "film"),
        (r"^stocks\..*\.doses\..*\.(greatest|total)$|_J(_m2?)?$", "dose"),
        (r"^(coating|target)\..*(share|share_outside|_mm2)$", "covered"),
        (r"_mm3$", "volume"),
        (r"_mm$", "distance"),
        (r"engaged_s$", "engaged"),
        (r"_s$", "time"),
        (r"_N$", "force"),
        (r"_Nm$", "torque"),
        (r"_W$", "power"),
        (r"(^|\.)count$", "count"),
        (r"", "word"),
    )
)


_OF_SETUP: Final = re.compile(r"^setups\.[^.]*\.")


def quantity_of(path: str) -> str:
    """The name in `QUANTITIES` of a path of the results, such as ``stocks.stock.removed_mm3``, also of a set-up."""
    path = _OF_SETUP.sub("", path)
    return next(name for pattern, name in _PATHS if pattern.search(path))
