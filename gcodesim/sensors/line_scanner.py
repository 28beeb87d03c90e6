"""Laser line scanner: a profile of what a plane of light meets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, Range
from gcodesim.declarations.plain_kinds import Whole
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen
from gcodesim.sensors.optics import Optics
from gcodesim.sensors.outputs import Output, Points
from gcodesim.sensors.sensor import Sensor, Sight
from gcodesim.units import DEG


@frozen
class LineScanner(Sensor):
    """A fan of light in the plane of X and Z, and the points that it meets first.

    The points are those that a row of pixels sees: at equal steps of x / z. What hides a point from the light hides it;
    that a real scanner looks from beside the light, and so loses points in steep grooves, is not modelled.
    """

    kind: ClassVar[str] = "line_scanner"
    outputs: ClassVar[Mapping[str, type]] = {"profile": Points}
    order: ClassVar[tuple[str, str]] = ("scanner", "scan")

    points: int = key(Whole(Range(least=2, most=8192)), "points of a profile", default=640)
    field_of_view: float = key(
        Quantity("angle", Range(above=0.0, most=170.0 * DEG), example="30 deg"), "angle of the fan", default=30.0 * DEG
    )
    range: tuple[float, float] = key(
        Vector(Quantity("length", NOT_NEGATIVE), 2, "[50, 500 mm]"),
        "least and greatest depth that it measures",
        default=(0.01, 1.0),
    )
    noise: float = key(
        Quantity("length", NOT_NEGATIVE), "standard deviation of a depth", default=0.0, quiet=True, example="20 um"
    )

    def read(self, sight: Sight) -> Mapping[str, Output]:
        optics = Optics.of_view(self.points, 1, self.field_of_view, near=max(self.range[0], 1e-6))
        depth = optics.exposure(sight.X_WC, sight.scenery).depth[0]
        if self.noise > 0.0:
            depth = depth + self.noise * sight.noise.normal(len(depth))
        seen = (depth >= self.range[0]) & (depth <= self.range[1])
        depth = np.where(seen, depth, np.nan)
        across = (np.arange(self.points) - optics.cx) / optics.fx
        profile = np.stack([across * depth, np.where(seen, 0.0, np.nan), depth], axis=1)
        return {"profile": Points(points=profile.astype(np.float32))}

    def problems(self) -> list[tuple[str, str]]:
        if not self.range[0] < self.range[1]:
            return [("range", "`range` must begin below its end")]
        return []
