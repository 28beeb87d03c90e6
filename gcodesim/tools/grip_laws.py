"""Statics of grips, as numbers: what friction between fingers holds, and what suction cups hold.

Loads are forces that the part exerts on the gripper: m (g - a) of its mass, with the acceleration a of its centre.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms

Array = NDArray[np.float64]


def friction_force(tangential: Array, along: Array, mu: float, fingers: int = 2) -> Array:
    """Force (n,) [N] of each of `fingers` that holds a part by friction alone.

    Coulomb 1785: `sum |F_t| <= mu sum N`. Of `tangential` (n,) [N] all fingers carry a share. A load `along` (n,) [N]
    the way in which they press is carried by those on one side; the others press less by as much, because no finger
    gives more than its force.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        by_friction = np.where(np.abs(tangential) > 0.0, np.abs(tangential) / mu, 0.0)
    force: Array = (by_friction + np.abs(along)) / fingers
    return force


def greatest_friction_load(force: float, mu: float, fingers: int = 2) -> float:
    """Tangential load [N] that fingers of `force` [N] each hold."""
    return mu * fingers * force


def suction_force(vacuum: float, diameter: float, cups: int = 1, leakage: float = 0.0) -> float:
    """Force [N] of suction cups on a plane: F = n dp A, with `vacuum` dp [Pa] below the air around, less `leakage`."""
    return cups * vacuum * (1.0 - leakage) * 0.25 * pi * (diameter * diameter)


def suction_needed(pull: Array, lateral: Array, mu: float) -> Array:
    """Suction (n,) [N] that holds a part which pulls off by `pull` (n,) and aside by `lateral` (n,) [N].

    What the vacuum presses on and the load does not pull off is the normal force of friction: `F_l <= mu (F - F_p)`.
    A negative pull presses the part on.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        aside = np.where(np.abs(lateral) > 0.0, np.abs(lateral) / mu, 0.0)
    needed: Array = np.maximum(pull + aside, 0.0)
    return needed


def peel_needed(pull: Array, moment: Array, places: Array, radius: float) -> Array:
    """Suction (n,) [N] of all cups together with which the cup that is loaded most does not peel off.

    `places` (c, 2) [m] are the cups, each of `radius`; `moment` (n, 2) [N·m] of the load about x and y at the
    origin of the places.
    Cups are springs of equal stiffness on a rigid part (elastic distribution as of bolts, Shigley 2015, 8-12): the pull
    is shared evenly, and what a moment adds grows with the distance from their middle. The cup itself carries a
    moment as long as its rim is pressed on: its own pattern has a second moment of area of c A r²/4.
    """
    count = len(places)
    middle = places.mean(axis=0)
    offset = places - middle
    about_x = moment[:, 0] - pull * middle[1]
    about_y = moment[:, 1] + pull * middle[0]
    own = 0.25 * count * (radius * radius)
    second = (offset * offset).sum(axis=0)
    across_x, across_y = float(second[1]) + own, float(second[0]) + own
    reach_x, reach_y = np.abs(offset[:, 1]) + radius, np.abs(offset[:, 0]) + radius
    share = (
        pull[:, None] / count
        + np.abs(about_x)[:, None] * reach_x[None, :] / across_x
        + np.abs(about_y)[:, None] * reach_y[None, :] / across_y
    )
    worst: Array = np.maximum(count * share.max(axis=1), 0.0)
    return worst


def load_of(mass: float, acceleration: Array, gravity: Array) -> Array:
    """Force (n, 3) [N] that a part of `mass` [kg] exerts on what carries it: m (g - a) (d'Alembert 1743)."""
    load: Array = mass * (gravity - acceleration)
    return load


def speed_of_lift(force: float, mass: float, gravity: float) -> float:
    """The greatest acceleration upwards [m/s²] with which `force` [N] lifts `mass` [kg]."""
    return force / mass - gravity


def tangential_of(load: Array, axis: int) -> tuple[Array, Array]:
    """Loads (n, 3) split into the size across coordinate `axis` (n,) and the component along it (n,)."""
    across = np.delete(load, axis, axis=1)
    return norms(np.column_stack([across, np.zeros(len(load))])), load[:, axis]
