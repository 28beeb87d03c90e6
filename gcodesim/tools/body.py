"""Solids of revolution that represent a tool, for drawing, collision and mass."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from gcodesim.frames import Pose
from gcodesim.frozen import frozen
from gcodesim.solids import Cone, Cylinder, Placed, Sphere, moments, widest

STEEL_DENSITY: Final = 7850.0
"""Density of tool steel [kg/m³]; a solid carbide cutter weighs nearly twice that, so give its `mass`."""


RoundSolid = Cylinder | Cone | Sphere


@frozen(kw_only=False)
class Primitive:
    """One part of a tool: a simple solid on its axis, placed in the tool frame T, so that the body lies below zero.

    `bottom` and `top` are heights above the tip, towards the holder [m]. `part` says what it is: `cutting`, `shank`,
    `holder`, `nozzle` or a name of its own; see `parts`.
    """

    part: str
    placed: Placed

    @property
    def solid(self) -> RoundSolid:
        assert isinstance(self.placed.solid, Cylinder | Cone | Sphere)
        return self.placed.solid

    @property
    def bottom(self) -> float:
        return -(self.solid.bounds[1][2] + float(self.placed.X.p[2]))

    @property
    def top(self) -> float:
        return -(self.solid.bounds[0][2] + float(self.placed.X.p[2]))

    @property
    def widest(self) -> float:
        """The greatest radius [m]."""
        return widest(self.solid)


def cylinder(part: str, radius: float, bottom: float, top: float) -> Primitive:
    """A cylinder of `radius` between two heights [m]."""
    return Primitive(part, Placed(Cylinder(radius=radius, bottom=-top, top=-bottom)))


def sphere(part: str, radius: float, bottom: float) -> Primitive:
    """A ball of `radius` whose lowest point is at `bottom` [m]."""
    return Primitive(part, Placed(Sphere(radius=radius), Pose.from_xyz_rpy((0.0, 0.0, -(bottom + radius)))))


def cone(part: str, lower: float, upper: float, bottom: float, top: float) -> Primitive:
    """A cone from radius `lower` at `bottom` to radius `upper` at `top` [m]."""
    return Primitive(part, Placed(Cone(bottom_radius=upper, top_radius=lower, bottom=-top, top=-bottom)))


@frozen
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
        m = STEEL_DENSITY * body.solid.volume
        transverse, _, axial = moments(body.solid, m)
        rows.append((m, -float(body.placed.X_middle.p[2]), axial, transverse))
    total = sum(row[0] for row in rows)
    if total <= 0.0:
        return MassProperties(mass=mass or 0.0, center=0.0, axial=0.0, transverse=0.0)
    center = sum(m * z for m, z, _, _ in rows) / total
    axial = sum(row[2] for row in rows)
    transverse = sum(t + m * (z - center) * (z - center) for m, z, _, t in rows)
    scale = 1.0 if mass is None else mass / total
    return MassProperties(mass=scale * total, center=center, axial=scale * axial, transverse=scale * transverse)
