"""Wear by Taylor: an estimate of how long an edge lasts, and of how much of that a cut takes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.arithmetic.elementary import power
from gcodesim.processes.column import LINES, LOG, RESULTS, Column
from gcodesim.units import MINUTE

if TYPE_CHECKING:
    from gcodesim.tools.cutter import Cutter

Array = NDArray[np.float64]

WEAR: Final = Column("wear", "", "sum", LOG | LINES | RESULTS, "share of the edges' life by Taylor, an estimate")


def taylor_life(speed: float, constant: float, exponent: float) -> float:
    """Life [s] of an edge at a cutting `speed` [m/s]: v T^n = C (Taylor 1907), C the speed [m/s] for one minute."""
    return float(MINUTE * power(constant / speed, 1.0 / exponent))


def worn(cutter: Cutter, spindle: Array, cuts: NDArray[np.bool_], dt: float | Array) -> Array:
    """Share (n,) of the life of its edges that steps of `dt` [s] take, in those that it `cuts` (n,).

    Time counts while the tool is in the cut, at the speed of its diameter with the `spindle` (n,) [rad/s]; shares
    add up (Miner's rule). Faces, coolant and what a chip does to an edge by its thickness are left out.
    """
    assert cutter.life is not None
    speed = np.abs(spindle) * cutter.radius
    share = np.zeros(len(speed))
    for value in distinct(speed[cuts & (speed > 0.0)]).tolist():
        share[cuts & (speed == value)] = 1.0 / taylor_life(value, cutter.life.constant, cutter.life.exponent)
    return share * dt
