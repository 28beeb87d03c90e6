"""Force sensor between flange and tool."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.sensors.outputs import Output, Wrench
from gcodesim.sensors.sensor import PERIOD, Sensor, Sight


@frozen
class ForceSensor(Sensor):
    """Feels what the tool does to the flange: the process, its weight, and its inertia."""

    kind: ClassVar[str] = "force_sensor"
    outputs: ClassVar[Mapping[str, type]] = {"wrench": Wrench}
    sees: ClassVar[bool] = False
    on_flange: ClassVar[bool] = True

    period: float | None = key(PERIOD, "time from one reading to the next", default=0.02)
    noise: float = key(
        Quantity("force", NOT_NEGATIVE), "standard deviation of a force", default=0.0, quiet=True, example="0.5 N"
    )
    torque_noise: float = key(
        Quantity("torque", NOT_NEGATIVE), "standard deviation of a torque", default=0.0, quiet=True, example="0.02 N·m"
    )

    def read(self, sight: Sight) -> Mapping[str, Output]:
        load = sight.load
        if self.noise > 0.0 or self.torque_noise > 0.0:
            load = load + np.repeat([self.noise, self.torque_noise], 3) * sight.noise.normal(6)
        return {"wrench": Wrench(values=load)}
