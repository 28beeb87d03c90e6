"""Cutting data as catalogues compute them, in metric units and in inches."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import CannotComputeError, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut import ConstantCut, handbook_pressure

_LENGTH = Quantity("length", POSITIVE)


@frozen
class CuttingData(CutModel):
    """Speed, feed, removal rate, power and torque of a mill from what a catalogue recommends."""

    kind: ClassVar[str] = "cutting_data"
    says: ClassVar[str] = "speed, feed, removal rate and power as catalogues have them (also SFM, IPT, hp)"
    source: ClassVar[str] = (
        "n = vc/(pi D), vf = fz z n, Q = ap ae vf, Pc = kc Q / efficiency; kc at the mean chip, or `pressure`"
    )
    also: ClassVar[tuple[str, ...]] = (
        "handbook", "milling.handbook", "handbook_power", "milling.power", "vendor", "speeds_feeds",
        "milling.handbook_power",
        "power", "milling.vendor",
    )  # fmt: skip
    spellings: ClassVar[dict[str, str]] = {
        "D": "diameter", "teeth": "flutes", "z": "flutes", "N": "flutes", "fz": "feed_per_tooth",
        "ipt": "feed_per_tooth",
        "vc": "cutting_speed", "surface_speed": "cutting_speed", "sfm": "cutting_speed", "n": "spindle",
        "rpm": "spindle", "spindle_speed": "spindle", "vf": "feed", "unit_power": "pressure", "eta": "efficiency",
        "specific_power": "pressure", "specific_force": "pressure", "kc_at_h": "pressure", "hp_per_in3_min": "pressure",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("spindle", "rotational speed", "n", ("n", "spindle_speed", "spindle_rpm")),
        Result("cutting_speed", "speed", "vc", ("vc", "surface_speed")),
        Result("feed", "speed", "vf", ("vf", "table_feed", "feed_rate")),
        Result("feed_per_rev", "length", "of a turn", ("fn",)),
        Result("mrr", "volume flow", "Q", ("MRR", "Q", "removal_rate")),
        Result("mean_chip_thickness", "length", "", ("hm", "h_m")),
        Result("kc", "pressure", "specific cutting force that was used"),
        Result("power", "power", "at the tool", ("Pc", "cutting_power", "mean_power")),
        Result("motor_power", "power", "power over efficiency", ("spindle_power", "machine_power", "Pmot")),
        Result("torque", "torque", "", ("Mc", "mean_torque")),
    )

    diameter: float = key(_LENGTH, "cutting diameter", example="0.5 in")
    flutes: int = key("count", "number of teeth", default=1)
    cutting_speed: float | None = key("speed", "or `spindle`", default=None, example="400 sfm")
    spindle: float | None = key("rotational speed", "or `cutting_speed`", default=None)
    feed_per_tooth: float | None = key(_LENGTH, "or `feed`", default=None, example="0.002 ipt")
    feed: float | None = key("speed", "of the table", default=None)
    ap: float | None = key(_LENGTH, "depth, for removal rate and power", default=None)
    ae: float | None = key(_LENGTH, "width", default=None)
    pressure: float | None = key(
        Quantity("pressure", POSITIVE),
        "specific force or unit power, in place of a law",
        default=None,
        example="1 hp·min/in^3",
    )
    efficiency: float = key(Quantity("ratio", Range(above=0.0, most=1.0)), "of the spindle", default=1.0)

    def compute(self) -> dict[str, Value]:
        speed = self.spindle
        if speed is None:
            if self.cutting_speed is None:
                raise CannotComputeError("how fast does it turn? give `cutting_speed` or `spindle`")
            speed = 2.0 * self.cutting_speed / self.diameter
        found: dict[str, Value] = {"spindle": speed, "cutting_speed": 0.5 * self.diameter * speed}
        chip = self.feed_per_tooth
        if chip is None and self.feed is not None:
            chip = self.feed * 2.0 * pi / (self.flutes * speed)
        if chip is None:
            return found
        feed = chip * self.flutes * speed / (2.0 * pi)
        found |= {"feed": feed, "feed_per_rev": chip * self.flutes}
        if self.ap is None or self.ae is None:
            return found
        if self.ae > self.diameter * (1.0 + 1e-12):
            raise CannotComputeError("`ae` is more than the diameter")
        mrr = self.ap * self.ae * feed
        found["mrr"] = mrr
        if self.pressure is None and self.kc11 is None and self.material is None:
            return found
        if self.pressure is not None:
            kc = self.pressure
        else:
            cut = ConstantCut(mode="up", ap=self.ap, ae=self.ae, feed_per_tooth=chip, spindle=speed)
            h, kc = handbook_pressure(self.kienzle, self.diameter, cut)
            found["mean_chip_thickness"] = h
        power = kc * mrr
        found |= {"kc": kc, "power": power, "motor_power": power / self.efficiency, "torque": power / speed}
        return found
