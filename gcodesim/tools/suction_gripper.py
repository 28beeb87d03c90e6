"""Suction gripper: cups in one plane across the tool, at its tip."""

from __future__ import annotations

from typing import ClassVar, Final

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.declarations.composed import ListOf
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.declarations.record import Record
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.tools.body import Primitive, cylinder
from gcodesim.tools.gripper import Gripper
from gcodesim.units import MM

_RIM: Final = 8  # points of a rim that have to be on the part
_COLLAR: Final = 3.0 * MM


@frozen
class Cup:
    """One cup: where its middle is in the plane of the tip, and how wide its sealing edge."""

    at: tuple[float, float] = key(Vector(Quantity("length"), 2), "place in X and Y of the tool", default=(0.0, 0.0))
    diameter: float = key(Quantity("length", POSITIVE), "of the sealing edge", example="40 mm")


@frozen
class SuctionGripper(Gripper):
    """Cups that hold by a vacuum; a cup that is not wholly on the part holds nothing."""

    kind: ClassVar[str] = "suction_gripper"

    cups: tuple[Cup, ...] = key(
        ListOf(Record(Cup, "a cup")), "the cups, such as `[{at: [-30, 0], diameter: 40}, {at: [30, 0], diameter: 40}]`"
    )
    vacuum: float = key(
        Quantity("pressure", POSITIVE), "below the pressure of the air around", default=60e3, example="60 kPa"
    )
    leakage: float = key(
        Quantity("ratio", Range(least=0.0, below=1.0)), "share of the vacuum that is lost", default=0.0
    )
    reach: float = key(Quantity("length", POSITIVE), "by which a cup gives or stretches", default=2.0 * MM)

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """The cups below the plate that carries them."""
        high = min(20.0 * MM, 0.5 * self.length)
        cups = []
        for cup in self.cups:
            body = cylinder("cup", 0.5 * cup.diameter, 0.0, high)
            cups.append(Primitive(body.part, body.placed.at(Pose.from_xyz_rpy((*cup.at, 0.0)))))
        stem = cylinder("gripper", max(0.25 * max(cup.diameter for cup in self.cups), 5.0 * MM), high, self.length)
        return (*cups, stem, *self._holder_bodies())

    @property
    def plume(self) -> tuple[Primitive, ...]:
        """A collar round the edge of each cup, so that one sees that the vacuum is on."""
        high = min(_COLLAR, 0.25 * self.length)
        collars = [cylinder("suction", 0.5 * cup.diameter + _COLLAR, 0.5 * high, 1.5 * high) for cup in self.cups]
        places = [Pose.from_xyz_rpy((*cup.at, 0.0)) for cup in self.cups]
        return tuple(Primitive(own.part, own.placed.at(X)) for own, X in zip(collars, places, strict=True))

    def has(self, contacts: Array) -> float:
        from gcodesim.tools.grip_laws import suction_force

        return sum(suction_force(self.vacuum, width, leakage=self.leakage) for width in contacts[:, 3].tolist())

    def needs(self, load: Array, moment: Array, mu: float, contacts: Array) -> Array:
        """Of all cups together; the greater of what lifting and friction need and of what keeps a cup from peeling."""
        from gcodesim.arithmetic.matrices import norms
        from gcodesim.tools.grip_laws import peel_needed, suction_needed

        pull, lateral = load[:, 2], norms(np.column_stack([load[:, :2], np.zeros(len(load))]))
        radius = 0.5 * float(contacts[:, 3].min())
        return np.maximum(suction_needed(pull, lateral, mu), peel_needed(pull, moment[:, :2], contacts[:, :2], radius))

    def contacts(self, skin: Array, opening: float) -> tuple[Array, float] | None:
        rows = []
        angle = 2.0 * np.pi * np.arange(_RIM) / _RIM
        around = np.concatenate([np.zeros((1, 2)), np.stack([cos(angle), sin(angle)], axis=1)])
        for cup in self.cups:
            heights = _heights(skin, np.array(cup.at) + 0.5 * cup.diameter * (1.0 - 1e-6) * around)
            if (np.abs(heights) <= self.reach + 1e-9).all():
                rows.append([*cup.at, float(heights.mean()), cup.diameter])
        return (np.array(rows), opening) if rows else None

    def problems(self) -> list[tuple[str, str]]:
        found = Gripper.problems(self)
        if not self.cups:
            found.append(("cups", "`cups` must have at least one cup"))
        return found


def _heights(skin: Array, places: Array) -> Array:
    """Where lines (k, 2) along Z first meet triangles (t, 3, 3) on the way from the holder; inf where they do not."""
    a, e, f = skin[:, 0], skin[:, 1] - skin[:, 0], skin[:, 2] - skin[:, 0]
    area = e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]
    flat = np.abs(area) > 1e-18
    a, e, f, area = a[flat], e[flat], f[flat], area[flat]
    d = places[:, None] - a[None, :, :2]
    u = (d[..., 0] * f[:, 1] - d[..., 1] * f[:, 0]) / area
    v = (e[:, 0] * d[..., 1] - e[:, 1] * d[..., 0]) / area
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9)
    z: Array = np.where(inside, a[:, 2] + u * e[:, 2] + v * f[:, 2], np.inf).min(axis=1, initial=np.inf)
    return z
