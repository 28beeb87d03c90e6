"""Chip thinning: how much thinner than the feed per tooth the chips of a shallow or slanting cut are."""

from __future__ import annotations

from math import sqrt


def radial_thinning(width: float, diameter: float) -> float:
    """Greatest chip thickness over feed per tooth: 2 sqrt(ae/D - (ae/D)^2) below half the diameter, else 1."""
    share = width / diameter
    return 1.0 if share >= 0.5 else 2.0 * sqrt(max(share - share * share, 0.0))


def round_sine(depth: float, edge_diameter: float) -> float:
    """Sine of kappa at the top of a cut `depth` deep of a round edge: 2 sqrt(ap/d - (ap/d)^2), 1 from its middle on."""
    return radial_thinning(depth, edge_diameter)
