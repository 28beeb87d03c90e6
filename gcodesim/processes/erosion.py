"""Erosion: a water jet or a blasting gun takes material at a rate of its own.

A jet of `diameter` that takes `rate` of volume for each time and moves at the speed v goes rate / (diameter · v) deep,
all of its width if its profile is `flat`. A jet that leans takes the same volume over a footprint that is longer by
1 / cos, so it goes less deep where it leans across its way.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from gcodesim.frozen import frozen
from gcodesim.processes.beam import GENERAL, Beam, BeamSetting, switched
from gcodesim.processes.column import LINES, LOG, RESULTS, Column
from gcodesim.processes.signal import ABRASIVE, BEAM, Signal
from gcodesim.processes.window import Window

if TYPE_CHECKING:
    from gcodesim.processes.materials import Material
    from gcodesim.tools.jet import Jet


@frozen(slots=False, eq=False)
class Erosion(Beam):
    """What a jet or a blasting gun does to a stock."""

    kind: ClassVar[str] = "erosion"
    dose: ClassVar[str] = "wear"
    given: ClassVar[str] = "jet_capacity"
    landed: ClassVar[str] = "jet_landed"
    reads: ClassVar[tuple[Signal, ...]] = (BEAM, ABRASIVE)
    writes: ClassVar[tuple[Column, ...]] = (
        *GENERAL,
        Column("jet_capacity", "m^3", "sum", RESULTS, "volume that the jet could take", together="greatest"),
        Column("jet_landed", "m^3", "sum", RESULTS, "of that, what met material"),
        Column("wear", "m", "greatest", LOG | LINES | RESULTS, "depth that the place that got most could be worn by"),
    )

    tool: Jet

    @classmethod
    def of(cls, tool: Jet, material: Material | None) -> Erosion:
        """The rate belongs to tool and material together, so the cell gives it with the tool."""
        return cls(tool=tool)

    def setting(self, window: Window) -> BeamSetting:
        """On by a word of the cell; its rate follows the share of abrasive that flows."""
        n = window.steps
        on = switched(window, np.zeros(n, dtype=bool))
        rate = self.tool.removal_rate * np.maximum(window.signals["abrasive"], 0.0)
        yes = np.ones(n, dtype=bool)
        return BeamSetting(on=on & (rate > 0.0), gives=rate, takes=rate, gas=yes, beyond=np.zeros(n))
