"""Motion: times of moves from rest to rest, and corners that are rounded within a tolerance."""

from __future__ import annotations

from math import inf, pi, sqrt
from typing import ClassVar

import numpy as np

from gcodesim.arithmetic.elementary import cos
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.canon import LinearFeed, PathMode
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.diagnostics import Span
from gcodesim.frozen import frozen
from gcodesim.units import DEG

_SPEED = Quantity("speed", POSITIVE)
_ACCELERATION = Quantity("acceleration", POSITIVE)


@frozen
class Trapezoid(Model):
    """Moves along one axis from rest to rest, by the time law of a run."""

    kind: ClassVar[str] = "motion.trapezoid"
    says: ClassVar[str] = "time of moves from rest to rest"
    source: ClassVar[str] = "t = L/v + v/a if L >= v^2/a, else 2 sqrt(L/a); computed by the time law of a run"
    also: ClassVar[tuple[str, ...]] = ("trapezoid", "motion.move")
    spellings: ClassVar[dict[str, str]] = {
        "v": "feed", "speed": "feed", "a": "acceleration", "accel": "acceleration", "lengths": "moves", "move": "moves",
        "length": "moves", "distance": "moves", "distances": "moves",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("times", "time", "of each move"),
        Result("total", "time", "of all of them", ("total_time", "time", "t")),
        Result("peak_speeds", "speed", "greatest speed of each", ("top_speeds",)),
    )

    feed: float = key(_SPEED, "v, at most", example="50 mm/s")
    acceleration: float = key(_ACCELERATION, "a, at most", example="0.4 m/s^2")
    moves: tuple[float, ...] = key(Vector(Quantity("length", POSITIVE)), "lengths of the moves", example="[100, 4 mm]")

    def compute(self) -> dict[str, Value]:
        times = [self._time(length) for length in self.moves]
        peaks = [min(self.feed, sqrt(self.acceleration * length)) for length in self.moves]
        return {"times": times, "total": float(sum(times)), "peak_speeds": peaks}

    def _time(self, length: float) -> float:
        from gcodesim.motion import build_tool_path
        from gcodesim.motion.blend import blend
        from gcodesim.motion.pieces import AxisLimits
        from gcodesim.motion.timing import time_law

        limits = AxisLimits(speed=np.full(6, inf), acceleration=np.full(6, self.acceleration))
        place = Span("move", 1, 1, 1, 2)
        move = LinearFeed(span=place, end=(length, 0.0, 0.0, 0.0, 0.0, 0.0), feed=self.feed)
        path = build_tool_path([PathMode(span=place, mode="exact_stop"), move])
        return float(time_law(blend(path, limits)).duration)


@frozen
class RoundedCorner(Model):
    """A corner between two lines, rounded by an arc that misses it by the tolerance."""

    kind: ClassVar[str] = "motion.corner"
    says: ClassVar[str] = "radius and speed of a corner that is rounded within a tolerance"
    source: ClassVar[str] = (
        "R = P s/(1-s), v = sqrt(a R), s the sine of half the included angle; a run keeps half of `a` for the way"
        " along the arc, so that its bend has sqrt(3)/2 of it"
    )
    also: ClassVar[tuple[str, ...]] = ("corner", "motion.blend")
    spellings: ClassVar[dict[str, str]] = {
        "P": "tolerance", "v": "feed", "speed": "feed", "a": "acceleration", "accel": "acceleration",
        "angle": "turn_angle",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("corner_radius", "length", "R of the arc", ("radius",)),
        Result("corner_speed", "speed", "with all of the acceleration for the bend", ("speed",)),
        Result("run_speed", "speed", "as in a run, which keeps some acceleration for the way along the arc"),
    )

    tolerance: float = key(Quantity("length", POSITIVE), "P of G64", example="0.02 mm")
    feed: float = key(_SPEED, "programmed", example="80 mm/s")
    acceleration: float = key(_ACCELERATION, "a", example="1.5 m/s^2")
    turn_angle: float | None = key("angle", "by which the path turns; 0 is straight on", default=None, example="90 deg")
    included_angle: float | None = key("angle", "between the lines, in place of `turn_angle`", default=None)

    def compute(self) -> dict[str, Value]:
        from gcodesim.motion.corner_kernels import corner_radius

        turn = self.turn_angle
        if turn is None:
            if self.included_angle is None:
                raise CannotComputeError("how sharp is the corner? give `turn_angle` or `included_angle`")
            turn = pi - self.included_angle
        if not 0.0 < turn < pi:
            raise CannotComputeError(f"the path turns by {turn / DEG:g} deg; a corner is above 0 and below 180 deg")
        radius = float(corner_radius(0.5 * (pi - turn), self.tolerance, inf, inf))  # lines that end nowhere near
        fast = sqrt(self.acceleration * radius)
        in_run = sqrt(cos(30.0 * DEG)) * fast
        return {"corner_radius": radius, "corner_speed": min(fast, self.feed), "run_speed": min(in_run, self.feed)}
