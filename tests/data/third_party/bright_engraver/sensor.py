"""A gauge that measures how far it is along its axis to whatever is there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gcodesim.sensors.optics import Optics
from gcodesim.sensors.outputs import Numbers, Output
from gcodesim.sensors.sensor import Sensor, Sight


@dataclass(frozen=True, slots=True, kw_only=True)
class BeamGauge(Sensor):
    """One beam: a picture of one pixel, of which only the depth counts; 0 where nothing is met."""

    kind: ClassVar[str] = "beam_gauge"
    outputs: ClassVar[Mapping[str, type]] = {"distance": Numbers}

    def read(self, sight: Sight) -> Mapping[str, Output]:
        optics = Optics(width=1, height=1, fx=1.0, fy=1.0, cx=0.0, cy=0.0)
        depth = float(optics.exposure(sight.X_WC, sight.scenery).depth[0, 0])
        return {"distance": Numbers(values={"distance_m": depth if np.isfinite(depth) else 0.0})}
