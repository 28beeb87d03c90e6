"""Moments of inertia of simple solids."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots
from gcodesim.frames import Array
from gcodesim.frozen import frozen
from gcodesim.solids.solid import Box, Cone, Cylinder, Sphere


def moments(solid: Box | Cylinder | Cone | Sphere, mass: float) -> tuple[float, float, float]:
    """Moments of inertia [kg·m²] of a solid of `mass` [kg] about axes x, y, z through its middle.

    A cone counts as a cylinder of its own mean section.
    """
    match solid:
        case Box(size=(x, y, z)):
            return (mass * (y * y + z * z) / 12.0, mass * (x * x + z * z) / 12.0, mass * (x * x + y * y) / 12.0)
        case Sphere(radius=radius):
            ball = 0.4 * mass * (radius * radius)
            return (ball, ball, ball)
        case Cylinder(radius=radius):
            return _round(mass, radius, radius, solid.length)
        case Cone():
            return _round(mass, solid.bottom_radius, solid.top_radius, solid.length)


def _round(mass: float, a: float, b: float, length: float) -> tuple[float, float, float]:
    square = (a * a + a * b + b * b) / 3.0
    across = 0.25 * mass * square + mass * (length * length) / 12.0
    return (across, across, 0.5 * mass * square)


@frozen(eq=False)
class MassOfSkin:
    """Mass [kg], centre of mass (3,) [m], and inertia (3, 3) [kg·m²] about it, in the frame of the skin."""

    mass: float
    center: Array
    inertia: Array


def mass_of_skin(points: Array, faces: NDArray[np.int32], mass: float) -> MassOfSkin:
    """Of a body of even density within triangles (t, 3) over points (v, 3), as a sum of tetrahedra (Tonon 2004).

    A skin that encloses nothing counts as its corners.
    """
    a, b, c = (points[faces[:, k]] for k in range(3))
    volume = dots(a, np.cross(b, c)) / 6.0
    total = float(volume.sum())
    if abs(total) < 1e-15:
        middle = points.mean(axis=0)
        return MassOfSkin(mass=mass, center=middle, inertia=np.eye(3) * 1e-9 * mass)
    s = a + b + c
    center = (volume[:, None] * s).sum(axis=0) / (4.0 * total)
    second = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            terms = a[:, i] * a[:, j] + b[:, i] * b[:, j] + c[:, i] * c[:, j] + s[:, i] * s[:, j]
            second[i, j] = float((volume * terms).sum()) / 20.0
    second = second * (mass / total) - mass * np.outer(center, center)
    return MassOfSkin(mass=mass, center=center, inertia=np.trace(second) * np.eye(3) - second)
