"""How far the tip of a tool bends aside: a cantilever of round sections, clamped in the holder.

Euler and Bernoulli's beam: the curvature is M / (E I), I = pi d^4 / 64; shear and what the clamping gives way are left
out. Fluted parts count with 0.8 of their diameter (Kops and Vo 1990: the equivalent diameter of end mills).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Final

from gcodesim.frozen import frozen

FLUTED: Final = 0.8
"""Equivalent over cutting diameter of a fluted part (Kops and Vo 1990)."""

MODULI: Final = {"carbide": 600e9, "hss": 220e9, "steel": 210e9}
"""Young's modulus [Pa] of what tools are made of; cemented carbide with about 10 % cobalt."""


@frozen(kw_only=False)
class BeamSection:
    """A round part of a tool: diameter and length [m]."""

    diameter: float
    length: float


def tip_way_of_moment(sections: Sequence[BeamSection], modulus: float) -> float:
    """Way of the tip for a moment there [m/(N·m)]: the integral of z / (E I); `sections` from the tip to the holder."""
    found, z0 = 0.0, 0.0
    for section in sections:
        z1 = z0 + section.length
        square = section.diameter * section.diameter
        found += 0.5 * (z1 * z1 - z0 * z0) / (modulus * pi * square * square / 64.0)
        z0 = z1
    return found


def tip_compliance(sections: Sequence[BeamSection], modulus: float, load_height: float = 0.0) -> float:
    """Way of the tip for a side force [m/N] at `load_height` [m] above it; `sections` from the tip to the holder.

    By the unit load: the integral of (z - c) z / (E I) over the part above the force.
    """
    found, z0 = 0.0, 0.0
    for section in sections:
        z1 = z0 + section.length
        a = max(z0, load_height)
        if z1 > a:
            square = section.diameter * section.diameter
            inertia = pi * square * square / 64.0
            cubes = (z1 * z1 * z1 - a * a * a) / 3.0
            squares = 0.5 * (z1 * z1 - a * a)
            found += (cubes - load_height * squares) / (modulus * inertia)
        z0 = z1
    return found
