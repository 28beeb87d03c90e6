"""Closed forms of beams that move over a level surface: what the rays of a run come to."""

from __future__ import annotations

from math import pi, sqrt
from typing import Final

from gcodesim.arithmetic.scalars import exp

LINE: Final = sqrt(2.0 / pi)
"""Greatest dose of a Gaussian track over power / (radius · speed)."""


def peak_intensity(power: float, radius: float) -> float:
    """Greatest power per area [W/m²] of a Gaussian beam of `radius` [m], where 1/e² of it is left: 2 P / (pi w²)."""
    return 2.0 * power / (pi * (radius * radius))


def gaussian_at(r: float, radius: float) -> float:
    """Share of the greatest intensity at the distance `r` from the axis [m]: exp(-2 r² / w²)."""
    return exp(-2.0 * (r * r) / (radius * radius))


def track_fluence(power: float, radius: float, speed: float) -> float:
    """Dose [J/m²] in the middle of the track of a Gaussian beam: sqrt(2 / pi) P / (w v)."""
    return LINE * power / (radius * speed)


def jet_depth(rate: float, width: float, feed: float, cosine: float = 1.0) -> float:
    """Depth [m] of the level kerf of a jet that takes `rate` [m³/s]: rate / (width · feed).

    `cosine` is that of its lean across the way, which makes its footprint wider by 1 / cos.
    """
    return rate * cosine / (width * feed)


def energy_rate(power: float, share: float, specific_energy: float) -> float:
    """Volume [m³] that a beam takes each second: share · P / specific energy [J/m³]."""
    return share * power / specific_energy
