"""Cutters, shanks and holders as arrays: the bodies of revolution that kernels sweep through a stock.

A shape is eight numbers:

    0  kind: 0 cylinder, 1 ball, 2 bull nose, 3 cone
    1  radius [m] of the whole
    2  corner radius [m] (ball: the radius)
    3  radius [m] of the flat at the bottom
    4  rise of the cone, dz / drho [-]
    5  height [m] of the lowest point above the tip
    6  height [m] of the top above the tip
    7  unused, 0

Below its top a shape is a cylinder of the radius that ends in that underside; it is convex.
"""

from __future__ import annotations

from math import pi, tan

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SHAPE_SIZE = 8

_FACETS = 24


def _shape(*values: float) -> Array:
    return np.array([*values, *[0.0] * (SHAPE_SIZE - len(values))])


def flat(diameter: float, length: float) -> Array:
    """Flat end mill of `diameter` that cuts up to `length` above its tip [m]."""
    return cylinder(diameter, 0.0, length)


def cylinder(diameter: float, bottom: float, top: float) -> Array:
    """A round section from `bottom` to `top` above the tip [m]: shank, holder, or a flat cutter (bottom 0)."""
    return _shape(0.0, diameter / 2.0, 0.0, diameter / 2.0, 0.0, bottom, top)


def ball(diameter: float, length: float) -> Array:
    """Ball end mill: a half sphere below a cylinder; lengths [m]."""
    return _shape(1.0, diameter / 2.0, diameter / 2.0, 0.0, 0.0, 0.0, max(length, diameter / 2.0))


def bull_nose(diameter: float, corner_radius: float, length: float) -> Array:
    """End mill with rounded corners; lengths [m]. No corner gives a flat, half the diameter a ball."""
    radius = diameter / 2.0
    if not 0.0 <= corner_radius <= radius * (1.0 + 1e-12):
        raise ValueError(f"corner radius {corner_radius} of a cutter of radius {radius}")
    if corner_radius == 0.0:
        return flat(diameter, length)
    if corner_radius >= radius:
        return ball(diameter, length)
    return _shape(2.0, radius, corner_radius, radius - corner_radius, 0.0, 0.0, max(length, corner_radius))


def cone(diameter: float, point_angle: float, length: float, tip_diameter: float = 0.0) -> Array:
    """Drill or chamfer mill: a cone of `point_angle` [rad, whole angle], from `tip_diameter` outwards [m]."""
    if point_angle >= pi - 1e-9 or tip_diameter >= diameter:
        return flat(diameter, length)
    rise = 1.0 / tan(point_angle / 2.0)
    height = (diameter - tip_diameter) / 2.0 * rise
    return _shape(3.0, diameter / 2.0, 0.0, tip_diameter / 2.0, rise, 0.0, max(length, height))


def no_bodies() -> Array:
    """The empty list of shapes (0, 8)."""
    return np.zeros((0, SHAPE_SIZE))


def section_volume(shape: Array) -> float:
    """Volume [m^3] of a shape, from its closed form."""
    radius, corner, flat_radius, rise = shape[1], shape[2], shape[3], shape[4]
    height = shape[6] - shape[5]
    if shape[0] in (1.0, 2.0):
        body = pi * radius**2 * (height - corner)
        # a half torus tube around a disc (Pappus)
        nose = pi * flat_radius**2 * corner + pi**2 / 2 * flat_radius * corner**2 + 2 / 3 * pi * corner**3
        return float(body + nose)
    if shape[0] == 3.0:
        point = (radius - flat_radius) * rise
        frustum = pi * point / 3 * (radius**2 + radius * flat_radius + flat_radius**2)
        return float(pi * radius**2 * (height - point) + frustum)
    return float(pi * radius**2 * height)


def profile(shape: Array) -> tuple[Array, Array]:
    """Radii (m,) and heights (m,) above the tip [m] of the body from its lowest point up; rounded corners as facets."""
    radius, corner, flat_radius, rise = (float(shape[k]) for k in (1, 2, 3, 4))
    bottom, top = float(shape[5]), float(shape[6])
    radii, heights = [flat_radius], [bottom]
    if shape[0] in (1.0, 2.0):
        angles = np.arange(1, _FACETS + 1) * (pi / 2.0 / _FACETS)
        radii += [flat_radius + corner * float(np.sin(t)) for t in angles]
        heights += [bottom + corner * (1.0 - float(np.cos(t))) for t in angles]
    elif shape[0] == 3.0:
        radii.append(radius)
        heights.append(bottom + (radius - flat_radius) * rise)
    if top > heights[-1]:
        radii.append(radius)
        heights.append(top)
    return np.array(radii), np.array(heights)
