"""What a machine tool's axis and an external axis become in a chain: a joint, and the link that it moves."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from gcodesim.arithmetic.matrices import norm
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Inertial, Joint, JointKind, Link


class DrivenAxis(Protocol):
    """Limits of an axis, as in `Joint`, and the mass [kg] that it moves if that is known."""

    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    @property
    def speed(self) -> float: ...
    @property
    def acceleration(self) -> float | None: ...
    @property
    def jerk(self) -> float | None: ...
    @property
    def effort(self) -> float: ...
    @property
    def moving_mass(self) -> float | None: ...


def joint_of(axis: DrivenAxis, name: str, kind: JointKind, ends: tuple[str, str], X: Array, vector: Array) -> Joint:
    """The joint `name` from link to link, at X (4, 4) of the first, along or about `vector` (3,) of any length."""
    return Joint(
        name=name,
        kind=kind,
        parent=ends[0],
        child=ends[1],
        X=X,
        axis=vector / norm(vector),
        lower=axis.lower,
        upper=axis.upper,
        speed=axis.speed,
        acceleration=axis.acceleration,
        jerk=axis.jerk,
        effort=axis.effort,
    )


def link_of(axis: DrivenAxis, name: str) -> Link:
    """The link that the axis moves, with its mass in the link's frame, or without any."""
    mass = axis.moving_mass
    return Link(
        name=name, inertial=None if mass is None else Inertial(mass=mass, com=np.zeros(3), inertia=np.zeros((3, 3)))
    )
