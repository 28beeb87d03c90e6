"""Grips: what fingers and suction cups hold, by the laws of a run."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import norm
from gcodesim.calculator.model import Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE, Range
from gcodesim.declarations.plain_kinds import Whole
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.grip_laws import (
    friction_force,
    greatest_friction_load,
    peel_needed,
    speed_of_lift,
    suction_force,
    suction_needed,
)

_MASS = Quantity("mass", POSITIVE)
_ACCELERATION = Quantity("acceleration")
GRAVITY = 9.80665


@frozen
class SuctionLoad(Model):
    """Cups on a level face, or on an inclined one, that lift and move a part."""

    kind: ClassVar[str] = "grip.suction"
    says: ClassVar[str] = "force of suction cups, what they lift, and their safety under load"
    source: ClassVar[str] = "F = n dp A; lateral F_l <= mu (F - F_pull); peeling by elastic distribution over the cups"
    also: ClassVar[tuple[str, ...]] = ("suction", "suction.load", "suction.lift")
    spellings: ClassVar[dict[str, str]] = {
        "n": "cups", "diameter": "cup_diameter", "d": "cup_diameter", "dp": "vacuum", "pressure": "vacuum", "m": "mass",
        "gravity": "g", "mu": "friction", "a": "acceleration", "vertical_acceleration": "acceleration",
        "vertical_accel": "acceleration", "accel": "acceleration", "lateral_accel": "lateral_acceleration",
        "horizontal_acceleration": "lateral_acceleration", "safety_factor": "safety",
        "friction_coefficient": "friction",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("force_per_cup", "force", "of one cup", ("cup_force",)),
        Result("total_force", "force", "of all cups", ("holding_force", "suction_force", "force")),
        Result("pull", "force", "load away from the cups", ("normal_load", "pull_off_load")),
        Result("lateral_load", "force", "load along the face", ("shear_load",)),
        Result("needed_force", "force", "that just holds this load", ("force_needed",)),
        Result("required_force", "force", "that, times `safety`", ("required_holding_force",)),
        Result("peel_force", "force", "that keeps the cup loaded most from peeling off", ("needed_against_peel",)),
        Result("safety_figure", "", "force over the force needed", ("safety_factor", "actual_safety")),
        Result("holds", "", "whether that is at least `safety`"),
        Result(
            "max_vertical_accel", "acceleration", "greatest lift off a level face, with `safety`", ("max_acceleration",)
        ),
        Result("max_lateral_accel", "acceleration", "greatest acceleration aside below a level face, with `safety`"),
        Result("max_mass", "mass", "that is held with these accelerations and `safety`, without `lever`"),
        Result("needed_vacuum", "pressure", "that holds this load, times `safety`", ("required_vacuum",)),
    )

    cups: int = key(Whole(POSITIVE), "number of cups", default=1)
    cup_diameter: float = key(Quantity("length", POSITIVE), "of the sealing edge", example="40 mm")
    vacuum: float = key(Quantity("pressure", POSITIVE), "below the air around", example="60 kPa")
    leakage: float = key(Quantity("ratio", Range(least=0.0, below=1.0)), "share of the vacuum lost", default=0.0)
    mass: float = key(_MASS, "of the part", example="8 kg")
    g: float = key(_ACCELERATION, "acceleration of free fall", default=GRAVITY)
    acceleration: float = key(_ACCELERATION, "upwards", default=0.0)
    lateral_acceleration: float = key(_ACCELERATION, "level", default=0.0)
    tilt: float = key("angle", "of the face against level; 90 deg: cups on an upright face", default=0.0)
    friction: float = key(Quantity("ratio", POSITIVE), "between cups and part", default=0.5)
    lever: float = key("length", "from the middle of the cups to the centre of mass, along the face", default=0.0)
    spacing: float = key(
        Quantity("length", NOT_NEGATIVE), "from the middle of the cups to each of two rows of them", default=0.0
    )
    safety: float = key(Quantity("ratio", POSITIVE), "that is asked for", default=1.0)

    def compute(self) -> dict[str, Value]:
        cup = suction_force(self.vacuum, self.cup_diameter, leakage=self.leakage)
        total = self.cups * cup
        per_kg = self._load(1.0)
        pull, aside = (self.mass * part for part in per_kg)
        needed = float(suction_needed(np.array([pull]), np.array([aside]), self.friction)[0])
        unit = float(suction_needed(np.array([per_kg[0]]), np.array([per_kg[1]]), self.friction)[0])
        places = np.array([[self.spacing * (1.0 if i % 2 else -1.0), 0.0] for i in range(self.cups)])
        moment = np.array([[0.0, -pull * self.lever]])
        peel = float(peel_needed(np.array([pull]), moment, places - places.mean(axis=0), 0.5 * self.cup_diameter)[0])
        most = max(needed, peel)
        lift = speed_of_lift(total / self.safety, self.mass, self.g)
        return {
            "force_per_cup": cup,
            "total_force": total,
            "pull": pull,
            "lateral_load": aside,
            "needed_force": most,
            "required_force": self.safety * most,
            "peel_force": peel,
            "safety_figure": total / most if most > 0.0 else float("inf"),
            "holds": total >= self.safety * most,
            "max_vertical_accel": lift,
            "max_lateral_accel": max(self.friction * lift, 0.0),
            "max_mass": total / (self.safety * unit) if unit > 0.0 else float("inf"),
            "needed_vacuum": self.safety * self.vacuum * most / total,
        }

    def _load(self, mass: float) -> tuple[float, float]:
        """Pull off the face and load along it [N]."""
        down, level = mass * (self.g + self.acceleration), mass * self.lateral_acceleration
        c, s = cos(self.tilt), sin(self.tilt)
        return down * c, norm(np.array([down * s, level]))


@frozen
class FrictionGrip(Model):
    """Fingers that hold a part by friction alone."""

    kind: ClassVar[str] = "grip.friction"
    says: ClassVar[str] = "force of fingers that hold a part by friction, and what they hold"
    source: ClassVar[str] = "sum |F_t| <= mu sum N (Coulomb), with the weight and the inertia force"
    also: ClassVar[tuple[str, ...]] = ("friction_grip", "grip.finger", "grip.fingers", "gripping")
    spellings: ClassVar[dict[str, str]] = {
        "n": "fingers", "contacts": "fingers", "m": "mass", "mu": "friction", "gravity": "g", "a": "acceleration",
        "accel": "acceleration", "vertical_acceleration": "acceleration", "vertical_accel": "acceleration",
        "lateral_accel": "lateral_acceleration", "horizontal_acceleration": "lateral_acceleration",
        "grip_force": "force", "finger_force": "force", "force_per_finger": "force", "normal_force": "force",
        "safety_factor": "safety",
        "friction_coefficient": "friction",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("tangential_load", "force", "across the fingers", ("load", "shear_load")),
        Result("needed_force", "force", "of each finger that just holds this load", ("force_needed",)),
        Result("required_force", "force", "that, times `safety`", ("required_grip_force", "required_force_per_finger")),
        Result("friction_capacity", "force", "load that friction holds", ("capacity", "max_load")),
        Result("safety_figure", "", "force over the force needed", ("safety_factor", "actual_safety")),
        Result("holds", "", "whether that is at least `safety`"),
        Result("max_vertical_accel", "acceleration", "greatest lift with `safety`", ("max_acceleration", "max_accel")),
        Result("max_mass", "mass", "that is held with these accelerations and `safety`"),
    )

    fingers: int = key(Whole(POSITIVE), "that press", default=2)
    force: float | None = key(Quantity("force", POSITIVE), "of each finger", default=None, example="40 N")
    mass: float = key(_MASS, "of the part", example="2 kg")
    friction: float = key(Quantity("ratio", POSITIVE), "between finger and part", example="0.5")
    g: float = key(_ACCELERATION, "acceleration of free fall", default=GRAVITY)
    acceleration: float = key(_ACCELERATION, "upwards", default=0.0)
    lateral_acceleration: float = key(_ACCELERATION, "level, across the way in which the fingers press", default=0.0)
    along: float = key(_ACCELERATION, "level, along the way in which they press", default=0.0)
    safety: float = key(Quantity("ratio", POSITIVE), "that is asked for", default=1.0)

    def compute(self) -> dict[str, Value]:
        load = self.mass * norm(np.array([self.g + self.acceleration, self.lateral_acceleration]))
        needed = self._needed(self.mass)
        found: dict[str, Value] = {
            "tangential_load": load,
            "needed_force": needed,
            "required_force": self.safety * needed,
        }
        if self.force is None:
            return found
        capacity = greatest_friction_load(self.force, self.friction, self.fingers)
        return found | {
            "friction_capacity": capacity,
            "safety_figure": self.force / needed if needed > 0.0 else float("inf"),
            "holds": self.force >= self.safety * needed,
            "max_vertical_accel": capacity / (self.safety * self.mass) - self.g,
            "max_mass": self.mass * self.force / (self.safety * needed) if needed > 0.0 else float("inf"),
        }

    def _needed(self, mass: float) -> float:
        load = mass * norm(np.array([self.g + self.acceleration, self.lateral_acceleration]))
        pressed = mass * self.along
        return float(friction_force(np.array([load]), np.array([pressed]), self.friction, self.fingers)[0])
