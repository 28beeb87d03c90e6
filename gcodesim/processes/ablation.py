"""Ablation: a laser or a plasma torch takes material by the energy that it gives.

Energy balance: volume = share · power · time / specific energy, where the share is the absorptivity of a laser or the
efficiency of a torch. A Gaussian spot of radius w (1/e²) that moves at the speed v gives the middle of its track
sqrt(2 / pi) P / (w v) for each area, so it goes share · that / specific energy deep. What a place gets before its
`threshold` takes nothing. Heat that is conducted away is part of the specific energy; nothing is warmed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.processes.beam import GENERAL, Beam, BeamSetting, switched
from gcodesim.processes.column import LINES, LOG, RESULTS, Column
from gcodesim.processes.melting import melted
from gcodesim.processes.signal import BEAM, BEAM_POWER, FEED, GAS, LASER_MODE, SPINDLE, Signal
from gcodesim.processes.window import Window

if TYPE_CHECKING:
    from gcodesim.processes.materials import Material
    from gcodesim.tools.laser import Laser
    from gcodesim.tools.plasma import Plasma

Array = NDArray[np.float64]


@frozen(slots=False, eq=False)
class Ablation(Beam):
    """What a laser or a torch does to a stock; `specific_energy` [J/m³] None: it only gives a dose."""

    kind: ClassVar[str] = "ablation"
    dose: ClassVar[str] = "fluence"
    given: ClassVar[str] = "beam_energy"
    landed: ClassVar[str] = "landed_energy"
    reads: ClassVar[tuple[Signal, ...]] = (BEAM, BEAM_POWER, GAS, SPINDLE, FEED, LASER_MODE)
    writes: ClassVar[tuple[Column, ...]] = (
        *GENERAL,
        Column("beam_energy", "J", "sum", LOG | LINES | RESULTS, "energy of the beam", together="greatest"),
        Column("landed_energy", "J", "sum", LOG | RESULTS, "of that, what met material"),
        Column("fluence", "J/m^2", "greatest", LOG | LINES | RESULTS, "dose of the place that got most so far"),
    )

    tool: Laser | Plasma
    specific_energy: float | None

    @classmethod
    def of(cls, tool: Laser | Plasma, material: Material | None) -> Ablation:
        """The tool's own specific energy counts, else that which melts the material."""
        return cls(tool=tool, specific_energy=tool.specific_energy or melted(material))

    @property
    def threshold(self) -> float:
        return self.tool.threshold

    def setting(self, window: Window) -> BeamSetting:
        """Power by the words of the cell; in grbl's laser mode by S, none in rapids, after M4 with the speed."""
        signals, full = window.signals, self.tool.power
        asked = signals["power"]
        on = switched(window, ~np.isnan(asked))
        mode = signals["laser_mode"]
        driven = mode > 0.0
        spindle = signals["spindle"]
        by_speed = full * np.minimum(np.abs(spindle) / np.where(driven, mode, 1.0), 1.0)
        asked = np.where(np.isnan(asked), np.where(driven, by_speed, full), asked)
        on = np.where(driven & np.isnan(signals["beam"]), spindle != 0.0, on) & ~(driven & window.rapid)
        feed = signals["feed"]
        scaled = driven & (spindle < 0.0) & np.isfinite(feed) & (feed > 0.0)
        ratio = norms(window.velocity) / np.where(scaled, feed, 1.0)
        power = np.clip(asked, 0.0, full) * np.where(scaled, np.minimum(ratio, 1.0), 1.0)
        takes = 0.0 if self.specific_energy is None else self.tool.share / self.specific_energy
        lit = on & (power > 0.0)
        beyond = np.where(lit & (asked > full * (1.0 + 1e-9)), asked, 0.0)
        gas = np.asarray(signals["gas"] > 0.0, dtype=bool)
        return BeamSetting(on=lit, gives=power, takes=power * takes, gas=gas, beyond=beyond)
