"""Turning: one edge in a cut of constant size."""

from __future__ import annotations

from math import pi, sqrt
from typing import ClassVar

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import CannotComputeError, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut import chip_force
from gcodesim.units import DEG

_LENGTH = Quantity("length", POSITIVE)


@frozen
class TurningCut(CutModel):
    """A straight edge at an entering angle; the nose matters only for the roughness."""

    kind: ClassVar[str] = "turning"
    says: ClassVar[str] = "forces, power and roughness in turning"
    source: ClassVar[str] = (
        "Kienzle 1952, or linear-edge, with h = f sin(kappa), b = ap / sin(kappa); feed force F_n sin(kappa) and"
        " passive force F_n cos(kappa) from the normal force; roughness f^2 / (8 r) of a round nose, Ra of that profile"
    )
    also: ClassVar[tuple[str, ...]] = ("turning.kienzle", "turning.force", "turn")
    spellings: ClassVar[dict[str, str]] = {
        "f": "feed_per_rev", "feed": "feed_per_rev", "feed_per_revolution": "feed_per_rev", "D": "diameter",
        "d": "diameter", "kappa": "entering_angle", "kappa_r": "entering_angle", "lead_angle": "entering_angle",
        "approach_angle": "entering_angle", "vc": "cutting_speed", "n": "spindle", "rpm": "spindle",
        "spindle_speed": "spindle", "depth": "ap", "depth_of_cut": "ap", "r": "nose_radius", "r_eps": "nose_radius",
        "corner_radius": "nose_radius",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("Fc", "force", "cutting force", ("F_c", "main_force", "cutting_force", "Ft")),
        Result("Ff", "force", "feed force", ("F_f", "feed_force", "feeding_force")),
        Result("Fp", "force", "passive force, square to the turned face", ("F_p", "passive_force")),
        Result("kc", "pressure", "specific cutting force"),
        Result("chip_thickness", "length", "h", ("h",)),
        Result("chip_width", "length", "b", ("b",)),
        Result("Pc", "power", "cutting power", ("power", "P_c", "cutting_power")),
        Result("torque", "torque", "of the spindle, at `diameter`", ("Mc",)),
        Result("mrr", "volume flow", "removal rate", ("MRR", "Q")),
        Result("spindle", "rotational speed", "", ("n", "spindle_rpm")),
        Result("cutting_speed", "speed", "", ("vc",)),
        Result("feed_speed", "speed", "feed of a turn times speed", ("vf",)),
        Result("roughness_rt", "length", "f^2 / (8 r)", ("Rt", "Rz", "Rth", "Rmax")),
        Result("roughness_ra", "length", "mean roughness of that profile", ("Ra",)),
    )

    ap: float = key(_LENGTH, "depth of cut", example="2 mm")
    feed_per_rev: float = key(_LENGTH, "feed of a turn", example="0.25 mm")
    entering_angle: float = key("angle", "kappa_r, between edge and feed", default=90.0 * DEG, example="95 deg")
    diameter: float | None = key("length", "of the work, for torque and speed", default=None, example="50 mm")
    cutting_speed: float | None = key("speed", "for the power", default=None, example="180 m/min")
    spindle: float | None = key("rotational speed", "in place of `cutting_speed`", default=None)
    nose_radius: float | None = key("length", "for the roughness", default=None, example="0.8 mm")

    def compute(self) -> dict[str, Value]:
        if not 0.0 < self.entering_angle < pi:
            raise CannotComputeError(f"`entering_angle` is {self.entering_angle / DEG:g} deg; it is above 0, below 180")
        law, kappa = self.law, self.entering_angle
        h, b = self.feed_per_rev * sin(kappa), self.ap / sin(kappa)
        fc, fn, fa = chip_force(law, width=b, chip=h)
        found: dict[str, Value] = {
            "kc": law.specific_force(h), "chip_thickness": h, "chip_width": b, "Fc": fc,
            "Ff": fn * sin(kappa) + fa * cos(kappa), "Fp": fn * cos(kappa) - fa * sin(kappa),
        }  # fmt: skip
        speed = self.cutting_speed
        if speed is None and self.spindle is not None and self.diameter is not None:
            speed = 0.5 * self.diameter * self.spindle
        if self.diameter is not None:
            found["torque"] = 0.5 * self.diameter * fc
        if speed is not None:
            found |= {"Pc": fc * speed, "mrr": self.ap * self.feed_per_rev * speed, "cutting_speed": speed}
        turn = self.spindle
        if turn is None and speed is not None and self.diameter is not None:
            turn = 2.0 * speed / self.diameter
        if turn is not None:
            found |= {"spindle": turn, "feed_speed": self.feed_per_rev * turn / (2.0 * pi)}
        if self.nose_radius is not None:
            deep = self.feed_per_rev * self.feed_per_rev / (8.0 * self.nose_radius)
            found |= {"roughness_rt": deep, "roughness_ra": deep * 4.0 / (9.0 * sqrt(3.0))}
        return found
