"""Moments of inertia of simple solids."""

from __future__ import annotations

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
