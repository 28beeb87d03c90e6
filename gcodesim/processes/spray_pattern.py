"""How a gun's spray is spread: the pattern of its tool, and the closed forms of what one pass leaves on a plane.

A run and `gcodesim process` both take these.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from gcodesim.arithmetic.elementary import cos, exp, sin, tan
from gcodesim.frames import Array
from gcodesim.material.film import Pattern
from gcodesim.tools.spray_gun import SprayGun

if TYPE_CHECKING:
    from gcodesim.tools.tool import Tool

STEPS: Final = 512
"""Even steps of the radius in which a density is kept; between them it is straight."""

FAR: Final = 2.0
"""Radius, in units of the cone, at which a Gaussian pattern ends: four standard deviations."""


def pattern_of(gun: SprayGun) -> Pattern:
    """The pattern of a gun, whose shares add up to 1 over the whole cone."""
    wide, tall = tan(0.5 * gun.cone[0]), tan(0.5 * gun.cone[-1])
    reach = FAR if gun.profile == "gaussian" and gun.footprint is None else 1.0
    radius: Array = np.linspace(0.0, reach, STEPS + 1)
    density = _density(gun, radius)
    fading = gun.fading
    distance = np.array([gun.distance] if fading is None else fading.distance, dtype=float)
    efficiency = gun.efficiency * np.array([1.0] if fading is None else fading.factor, dtype=float)
    return Pattern(
        density=density / _over_disc(density, reach),
        reach=reach,
        wide=wide,
        tall=tall,
        distance=distance,
        efficiency=np.minimum(efficiency, 1.0),
        rebound=gun.rebound,
        least=gun.distances[0],
        most=gun.distances[1],
    )


def _density(gun: SprayGun, radius: Array) -> Array:
    """The fall of thickness across the cone, at radii (k,) in units of it; of any size."""
    if gun.footprint is not None:
        known = np.array(gun.footprint.radius) / gun.footprint.radius[-1]
        return np.asarray(np.interp(radius, known, gun.footprint.thickness))
    if gun.profile == "gaussian":
        return np.array([exp(-2.0 * r * r) for r in radius.tolist()])
    if gun.profile == "parabola":
        return 1.0 - radius * radius
    return np.ones_like(radius)


def _over_disc(density: Array, reach: float) -> float:
    """The integral over the disc of a density that is straight between even steps of the radius."""
    radius = np.linspace(0.0, reach, len(density))
    a, b = radius[:-1], radius[1:]
    return float(np.pi / 3.0 * ((b - a) * (density[:-1] * (2.0 * a + b) + density[1:] * (a + 2.0 * b))).sum())


def narrowest(pattern: Pattern, distance: float) -> float:
    """Half of the width [m] of the spot at a distance, across its narrower side; of a Gaussian, to two sigma."""
    return min(pattern.wide, pattern.tall) * distance


def finest(tools: Iterable[Tool]) -> float:
    """Greatest edge [m] of the faces of a film that shows what these guns lay: a third of the finest spread."""
    guns = [tool for tool in tools if isinstance(tool, SprayGun)]
    return min(narrowest(pattern_of(gun), gun.distance) for gun in guns) / 6.0


class Stripe(NamedTuple):
    """What one straight pass leaves on a plane: thickness in its middle [m], and section across it [m²]."""

    middle: float
    section: float


def gaussian_stripe(*, flow: float, solids: float, efficiency: float, speed: float, sigma: float) -> Stripe:
    """One pass of a gun with a Gaussian spot of standard deviation `sigma` [m], at `speed` [m/s].

    section = flow solids efficiency / speed, with `flow` [m³/s] of liquid and shares [-]; thickness falls across the
    stripe as the normal distribution, so that of the middle is section / (sigma sqrt(2 pi)). The run's own pattern ends
    at four sigma, 0.03 % off.
    """
    section = flow * solids * efficiency / speed
    return Stripe(section / (sigma * float(np.sqrt(2.0 * np.pi))), section)


def passes(stripe: Stripe, sigma: float, pitch: float, offsets: Array) -> Array:
    """Thickness (n,) [m] between many parallel Gaussian stripes `pitch` [m] apart, `offsets` (n,) [m] from one of them.

    The sum of the normal distributions of all stripes that matter.
    """
    count = int(np.ceil(9.0 * sigma / pitch)) + 1
    total: Array = np.zeros(len(offsets))
    for k in range(-count, count + 1):
        away = (offsets - k * pitch) / sigma
        total += stripe.middle * np.array([exp(-0.5 * a * a) for a in away.tolist()])
    return total


class Ellipse(NamedTuple):
    """Where a round cone meets a plane: semi-axes of its edge [m], and the height [m] of its tip over the plane.

    `shift` [m] is how far the middle of the edge lies from where the axis meets the plane.
    """

    along: float
    across: float
    shift: float
    height: float


def tilted_cone(*, half_angle: float, distance: float, tilt: float) -> Ellipse:
    """The edge of a round cone of `half_angle` [rad] on a plane that its axis meets at `distance` [m], at `tilt`.

    In the plane of the tilt the edge lies at h tan(tilt ± half_angle) from the foot of the nozzle, h = distance
    cos(tilt); across it, the section of a cone by a plane gives b² = a² - e² with the focus's e = a sin(tilt) /
    cos(half_angle). ValueError if the cone does not meet the plane all round.
    """
    if not half_angle + abs(tilt) < 0.5 * np.pi:
        raise ValueError("the cone does not meet the plane all round")
    height = distance * cos(tilt)
    near, far = height * tan(tilt - half_angle), height * tan(tilt + half_angle)
    along = 0.5 * (far - near)
    eccentric = sin(tilt) / cos(half_angle)
    across = along * float(np.sqrt(1.0 - eccentric * eccentric))
    return Ellipse(along, across, 0.5 * (far + near) - height * tan(tilt), height)
