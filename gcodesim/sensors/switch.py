"""Sensors that answer yes or no: what an input of the program may be wired to."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.declarations.keys import key
from gcodesim.frozen import frozen
from gcodesim.sensors.outputs import Numbers, Output
from gcodesim.sensors.sensor import Sensor, Sight

if TYPE_CHECKING:
    from gcodesim.frames import Array


@frozen
class SightSwitch(Sensor):
    """A sensor that looks along a straight line and switches when something is on it.

    `sightline` is that line. `noticed` is the word of the log for what it does when something is there, `where` that of
    messages for the place of what it looks for.
    """

    outputs: ClassVar[Mapping[str, type]] = {"state": Numbers}
    noticed: ClassVar[str] = "detected"
    where: ClassVar[str] = "before it"

    normally_closed: bool = key(
        "switch", "its input reads 1 while nothing is there, and 0 when something is", default=False, quiet=True
    )

    @property
    def sightline(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Where its line begins and ends, in its frame [m]."""
        raise NotImplementedError

    def signal(self, shares: Array) -> Array:
        """What the input reads (n,) where something is at these shares (n,) of the line; infinite: nothing."""
        there = np.isfinite(shares)
        read: Array = (there != self.normally_closed).astype(np.float64)
        return read

    def line_in(self, X: Array) -> tuple[Array, Array]:
        """Begin and way (n, 3) [m] of its line where the sensor stands at X (n, 4, 4)."""
        begin, end = (np.array(point) for point in self.sightline)
        starts = applied(X[:, :3, :3], np.broadcast_to(begin, (len(X), 3))) + X[:, :3, 3]
        ends = applied(X[:, :3, :3], np.broadcast_to(end, (len(X), 3))) + X[:, :3, 3]
        return starts, ends - starts

    def read(self, sight: Sight) -> Mapping[str, Output]:
        from gcodesim.sensors.sightline_kernels import first_met

        starts, ways = self.line_in(sight.X_WC[None])
        shares = np.empty(1)
        first_met(np.ascontiguousarray(sight.scenery.triangles), starts, ways, shares)
        return {"state": Numbers(values=self.figures(float(shares[0])))}

    def figures(self, share: float) -> dict[str, float]:
        """What the log shows when something is at this share of the line; infinite: nothing."""
        return {self.noticed: float(np.isfinite(share)), "input": float(self.signal(np.array([share]))[0])}
