"""Drilling into solid material."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import CannotComputeError, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut import plunge_forces
from gcodesim.tools.drill import Drill
from gcodesim.units import DEG


@frozen
class Drilling(CutModel):
    """A twist drill: torque, thrust, power."""

    kind: ClassVar[str] = "drill"
    says: ClassVar[str] = "torque, thrust and power of a drill"
    source: ClassVar[str] = (
        "two lips: kappa = point angle / 2, b = D/(2 sin kappa), h = f_z sin kappa; torque from F_t at D/4, thrust from"
        " F_n sin kappa; with `chisel_edge` the factors of Machinery's Handbook"
    )
    also: ClassVar[tuple[str, ...]] = ("drilling", "drill.thrust", "drilling.torque")
    spellings: ClassVar[dict[str, str]] = {
        "D": "diameter", "d": "diameter", "f": "feed_per_rev", "feed_per_revolution": "feed_per_rev",
        "fz": "feed_per_tooth",
        "lips": "flutes", "teeth": "flutes", "n": "spindle", "spindle_speed": "spindle", "rpm": "spindle",
        "vf": "feed", "vc": "cutting_speed", "tip_angle": "point_angle",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("torque", "torque", "of the spindle", ("mean_torque", "Mc")),
        Result(
            "thrust",
            "force",
            "along the axis, against the feed",
            ("thrust_force", "Fz", "mean_Fz", "axial_force", "Ff"),
        ),
        Result("Ft_per_lip", "force", "tangential force on one lip", ("Fc_per_lip", "Ft")),
        Result("power", "power", "torque times speed", ("mean_power", "Pc")),
        Result("mrr", "volume flow", "removal rate", ("MRR", "Q")),
        Result("feed", "speed", "of the drill", ("vf", "feed_rate")),
        Result("cutting_speed", "speed", "at the diameter", ("vc",)),
        Result("chip_thickness", "length", "h = f_z sin(kappa)", ("h",)),
        Result("chip_width", "length", "b of one lip", ("b",)),
    )

    diameter: float = key(Quantity("length", POSITIVE), "diameter of the drill", example="8 mm")
    point_angle: float = key("angle", "angle of the point, lip to lip", default=118.0 * DEG, example="140 deg")
    flutes: int = key("count", "number of lips", default=2)
    chisel_edge: float = key(
        Quantity("length", NOT_NEGATIVE),
        "length of the chisel edge across its web, usually 0.18 of the diameter; 0: lips reach the axis",
        default=0.0,
    )
    feed_per_rev: float | None = key("length", "feed of a turn; or `feed_per_tooth`, or `feed`", default=None)
    feed_per_tooth: float | None = key("length", "feed of a lip", default=None)
    feed: float | None = key("speed", "of the drill", default=None, example="200 mm/min")
    spindle: float | None = key("rotational speed", "for power and removal rate", default=None, example="1200 rpm")
    cutting_speed: float | None = key("speed", "in place of `spindle`", default=None)

    @property
    def speed(self) -> float:
        """Of the spindle [rad/s]; 0 where the inputs do not say."""
        if self.spindle is not None:
            return self.spindle
        return 0.0 if self.cutting_speed is None else 2.0 * self.cutting_speed / self.diameter

    def compute(self) -> dict[str, Value]:
        drill = Drill(
            diameter=self.diameter, flutes=self.flutes, point_angle=self.point_angle, chisel_edge=self.chisel_edge
        )
        for _, problem in drill.problems():
            raise CannotComputeError(problem)
        turn = self._feed_of_a_turn()
        found = plunge_forces(drill, self.law, feed_per_rev=turn, spindle=self.speed)
        lip = float(drill.edge[:, 5].sum())
        values: dict[str, Value] = {
            "torque": found.torque,
            "thrust": float(found.force[2]),
            "Ft_per_lip": found.torque / (self.flutes * 0.25 * self.diameter),
            "chip_thickness": turn / self.flutes * 0.5 * self.diameter / lip,
            "chip_width": lip,
        }
        if self.speed:
            values |= {
                "power": found.power, "mrr": found.mrr, "feed": turn * self.speed / (2.0 * pi),
                "cutting_speed": 0.5 * self.diameter * self.speed,
            }  # fmt: skip
        return values

    def _feed_of_a_turn(self) -> float:
        if self.feed_per_rev is not None:
            return self.feed_per_rev
        if self.feed_per_tooth is not None:
            return self.feed_per_tooth * self.flutes
        if self.feed is None or not self.speed:
            raise CannotComputeError("how far does it go in a turn? give `feed_per_rev`, or `feed` and `spindle`")
        return self.feed * 2.0 * pi / self.speed
