"""Wear by Taylor: an estimate of how long an edge lasts."""

from __future__ import annotations

from gcodesim.arithmetic.elementary import power
from gcodesim.units import MINUTE


def taylor_life(speed: float, constant: float, exponent: float) -> float:
    """Life [s] of an edge at a cutting `speed` [m/s]: v T^n = C (Taylor 1907), C the speed [m/s] for one minute."""
    return float(MINUTE * power(constant / speed, 1.0 / exponent))
