"""Bodies of revolution by their outlines."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.frames import Array
from gcodesim.solids.solid import Cone, Cylinder, Revolution, Solid, Sphere

BALL_PIECES: Final = 32
"""A quarter of a ball is this many straight pieces: 0.03 % of its radius too thin at most."""


def outline_of(solid: Solid) -> Array:
    """Points (k, 2) from the top down: radius, height [m] in the solid's frame; ValueError: not a body of revolution.

    A ball becomes straight pieces inside the true one.
    """
    match solid:
        case Cylinder(radius=radius, bottom=bottom, top=top):
            return np.array([(radius, top), (radius, bottom)])
        case Cone():
            return np.array([(solid.top_radius, solid.top), (solid.bottom_radius, solid.bottom)])
        case Sphere(radius=radius):
            angle = np.pi * np.arange(2 * BALL_PIECES + 1) / (2 * BALL_PIECES)
            return np.stack([radius * sin(angle), radius * cos(angle)], axis=1)
        case Revolution(outline=outline):
            return np.array(outline)
    raise ValueError(f"a {type(solid).__name__.lower()} is no body of revolution")


def widest(solid: Solid) -> float:
    """The greatest distance [m] from Z."""
    match solid:
        case Cylinder() | Sphere():
            return solid.radius
        case Cone():
            return max(solid.bottom_radius, solid.top_radius)
        case Revolution(outline=outline):
            return max(radius for radius, _ in outline)
    low, high = solid.bounds
    return math.hypot(max(-low[0], high[0]), max(-low[1], high[1]))
