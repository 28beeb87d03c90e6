"""Solids of revolution that stand for a tool: for drawing, collision and mass."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import pi
from typing import Final, Literal

STEEL_DENSITY: Final = 7850.0
"""Density of tool steel [kg/m³]; a solid carbide cutter weighs nearly twice that, `mass` says so."""


@dataclass(frozen=True, slots=True)
class Primitive:
    """A simple body on the tool axis; `bottom` and `top` are heights above the tip, towards the holder [m].

    A sphere has its centre half-way between both. A cone runs from `radius_bottom` to `radius`; a cylinder has
    both equal. `part` says what it is: `cutting`, `shank`, `holder`, `nozzle` or a name of its own; see `parts`.
    """

    kind: Literal["cylinder", "sphere", "cone"]
    part: str
    radius: float
    bottom: float
    top: float
    radius_bottom: float

    @property
    def volume(self) -> float:
        """Volume [m³]."""
        length = self.top - self.bottom
        if self.kind == "sphere":
            return pi * length**3 / 6.0
        a, b = self.radius_bottom, self.radius
        return pi * length * (a * a + a * b + b * b) / 3.0


def cylinder(part: str, radius: float, bottom: float, top: float) -> Primitive:
    """A cylinder of `radius` between two heights [m]."""
    return Primitive("cylinder", part, radius, bottom, top, radius)


def sphere(part: str, radius: float, bottom: float) -> Primitive:
    """A ball of `radius` whose lowest point is at `bottom` [m]."""
    return Primitive("sphere", part, radius, bottom, bottom + 2.0 * radius, radius)


def cone(part: str, lower: float, upper: float, bottom: float, top: float) -> Primitive:
    """A cone from radius `lower` at `bottom` to radius `upper` at `top` [m]."""
    return Primitive("cone", part, upper, bottom, top, lower)


@dataclass(frozen=True, slots=True, kw_only=True)
class MassProperties:
    """Mass [kg], height of the centre of mass above the tip [m], and inertia about it [kg·m²].

    `axial` is about the tool axis, `transverse` about any axis through the centre of mass across it.
    """

    mass: float
    center: float
    axial: float
    transverse: float


def mass_properties(primitives: Iterable[Primitive], mass: float | None = None) -> MassProperties:
    """Mass properties of bodies on one axis, of steel unless the whole `mass` [kg] is known.

    Each body counts as a cylinder of its own mean section, spheres as spheres; where a sphere and a cylinder
    overlap (the end of a ball nose) the overlap counts twice, which is below 2 % of a tool.
    """
    rows: list[tuple[float, float, float, float]] = []
    for body in primitives:
        m = STEEL_DENSITY * body.volume
        length, middle = body.top - body.bottom, 0.5 * (body.top + body.bottom)
        if body.kind == "sphere":
            axial = transverse = 0.4 * m * body.radius**2
        else:
            square = (body.radius**2 + body.radius * body.radius_bottom + body.radius_bottom**2) / 3.0
            axial = 0.5 * m * square
            transverse = 0.25 * m * square + m * length**2 / 12.0
        rows.append((m, middle, axial, transverse))
    total = sum(row[0] for row in rows)
    if total <= 0.0:
        return MassProperties(mass=mass or 0.0, center=0.0, axial=0.0, transverse=0.0)
    center = sum(m * z for m, z, _, _ in rows) / total
    axial = sum(row[2] for row in rows)
    transverse = sum(t + m * (z - center) ** 2 for m, z, _, t in rows)
    scale = 1.0 if mass is None else mass / total
    return MassProperties(mass=scale * total, center=center, axial=scale * axial, transverse=scale * transverse)
