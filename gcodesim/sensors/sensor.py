"""What every sensor has: when it reads, and what it may know."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from gcodesim.declarations.keys import fill_derived, key
from gcodesim.declarations.kind import Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.sensors.noise import Noise
from gcodesim.sensors.scenery import Scenery

if TYPE_CHECKING:
    from gcodesim.frames import Array
    from gcodesim.sensors.outputs import Output

ORDER: Final = ("sensor", "read")
"""Target and verb of an M-code at which every sensor reads that names nothing of its own."""

PERIOD: Final = Quantity("time", Range(least=1e-6, most=1e6), example="0.2 s")


@frozen(eq=False)
class Sight:
    """What there is at one moment: `scenery` in the world, the sensor at `X_WC` (4, 4), and its noise.

    `load` (6,) is the force [N] and torque [N·m] on the flange that carries the sensor, at the sensor and in its axes;
    zero where it stands on no flange.
    """

    X_WC: Array
    scenery: Scenery
    noise: Noise
    load: Array = field(default_factory=lambda: np.zeros(6))


@frozen
class Sensor:
    """A sensor. Its frame C: Z out of the sensor, X to the right of what it sees, Y down.

    `outputs` names what `read` gives, each with the class of `outputs` that it is; topics, files and results go by
    these names. `order`, target and verb, is what an M-code of the cell says to have it read; its topics and its frame
    in the log begin with the target. A sensor that does not need the scenery says so by `sees`: then it may read at
    every step at little cost. One with `on_flange` can only stand on a flange, and is given its `load`.
    """

    kind: ClassVar[str] = ""
    outputs: ClassVar[Mapping[str, type]] = {}
    order: ClassVar[tuple[str, str]] = ORDER
    sees: ClassVar[bool] = True
    on_flange: ClassVar[bool] = False

    period: float | None = key(
        PERIOD, "time from one reading to the next", default=None, rule="it reads when a word says so"
    )
    save: bool = key("switch", "write what it reads into the folder of the run as well", default=False, quiet=True)

    def __post_init__(self) -> None:
        fill_derived(self)

    def read(self, sight: Sight) -> Mapping[str, Output]:
        """One reading, by the names of `outputs`. The same sight gives the same bits."""
        raise NotImplementedError

    def problems(self) -> list[tuple[str, str]]:
        """What makes this sensor impossible, as pairs (key, message); empty for a sound one."""
        return []
