"""Closed forms of processes that lay, spray, cut at a distance or grip: the truth for their tests."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt


@dataclass(frozen=True, slots=True, kw_only=True)
class SprayStripe:
    """Film left by one straight pass: thickness in its middle [m], section across the pass [m²]."""

    center_thickness: float
    section: float


def spray_stripe(*, flow: float, solids: float, efficiency: float, speed: float, sigma: float) -> SprayStripe:
    """One pass of a gun with a Gaussian spray of standard deviation `sigma` [m] at `speed` [m/s] over a plane.

    section = flow solids efficiency / speed, with paint `flow` [m³/s], volume share of `solids` [-] and transfer
    `efficiency` [-]; the middle of a Gaussian of that area is section / (sigma sqrt(2 pi)).
    """
    section = flow * solids * efficiency / speed
    return SprayStripe(center_thickness=section / (sigma * sqrt(2.0 * pi)), section=section)


@dataclass(frozen=True, slots=True, kw_only=True)
class JetKerf:
    """Depth that a jet reaches [m], at most the plate; feed at which it just separates the plate [m/s]."""

    depth: float
    separation_feed: float


def jet_kerf(*, rate: float, width: float, feed: float, thickness: float) -> JetKerf:
    """A jet that removes `rate` [m³/s] in a kerf of `width` [m] at `feed` [m/s] from a plate of `thickness` [m].

    depth = rate / (width feed): all removed material comes from a rectangular kerf.
    """
    return JetKerf(depth=min(rate / (width * feed), thickness), separation_feed=rate / (width * thickness))


@dataclass(frozen=True, slots=True, kw_only=True)
class SuctionGrip:
    """Holding force of a cup and of all cups [N], upward acceleration at which the part is just held [m/s²]."""

    cup_force: float
    force: float
    vertical_acceleration: float


def suction_grip(*, cups: int, diameter: float, vacuum: float, mass: float, gravity: float = 9.81) -> SuctionGrip:
    """`cups` suction cups of `diameter` [m] under `vacuum` [Pa] below ambient lift a part of `mass` [kg] from above.

    F = n dp A; a = F / m - g. Without leakage and without safety factor.
    """
    cup = vacuum * 0.25 * pi * diameter**2
    return SuctionGrip(cup_force=cup, force=cups * cup, vertical_acceleration=cups * cup / mass - gravity)


def bead_area(width: float, height: float) -> float:
    """Section [m²] of a bead `width` wide and `height` high [m]: a rectangle between two half circles."""
    return (width - height) * height + 0.25 * pi * height**2


def filament_length(volume: float, diameter: float) -> float:
    """Length [m] of filament of `diameter` [m] that holds `volume` [m³]; what an E word counts."""
    return volume / (0.25 * pi * diameter**2)
