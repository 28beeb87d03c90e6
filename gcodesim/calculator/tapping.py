"""Tapping: what a tap takes to turn."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.tools.tap import PITCH_DEPTH

_LENGTH = Quantity("length", POSITIVE)


@frozen
class Tapping(CutModel):
    """A cutting tap in a full thread."""

    kind: ClassVar[str] = "tapping"
    says: ClassVar[str] = "torque, power and feed of a tap"
    source: ClassVar[str] = (
        "Sandvik, handbook of threading: M = p^2 D kc / 8 (N·m: p, D in mm, kc in N/mm^2, over 8000)"
    )
    also: ClassVar[tuple[str, ...]] = ("tap", "threading.tap", "tapping.torque", "drilling.tap")
    spellings: ClassVar[dict[str, str]] = {
        "P": "pitch", "p": "pitch", "D": "diameter", "d": "diameter", "nominal_diameter": "diameter", "n": "spindle",
        "rpm": "spindle", "spindle_speed": "spindle", "vc": "cutting_speed", "length": "depth",
        "specific_force": "pressure", "kc_eff": "pressure",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("torque", "torque", "of a full thread", ("Mc", "M", "mean_torque")),
        Result("power", "power", "torque times speed", ("Pc",)),
        Result("feed", "speed", "pitch times speed", ("vf", "feed_rate")),
        Result("feed_per_rev", "length", "the pitch"),
        Result("spindle", "rotational speed", "", ("n", "spindle_speed")),
        Result("cutting_speed", "speed", "at the diameter", ("vc",)),
        Result("core_drill", "length", "diameter less pitch", ("tap_drill", "tap_drill_diameter", "drill_diameter")),
        Result("pitch_diameter", "length", "of a 60 degree thread"),
        Result("time", "time", "in and out of `depth` at this feed"),
    )

    diameter: float = key(_LENGTH, "nominal diameter", example="8 mm")
    pitch: float = key(_LENGTH, "of the thread", example="1.25 mm")
    pressure: float | None = key(
        Quantity("pressure", POSITIVE), "specific cutting force (default: of the law at a chip of 1 mm)", default=None
    )
    spindle: float | None = key("rotational speed", "for the power", default=None, example="400 rpm")
    cutting_speed: float | None = key("speed", "in place of `spindle`", default=None)
    depth: float | None = key(_LENGTH, "of the thread, for the time", default=None)

    def compute(self) -> dict[str, Value]:
        pressure = self.kienzle.kc11 if self.pressure is None else self.pressure
        torque = self.pitch * self.pitch * self.diameter * pressure / 8.0
        found: dict[str, Value] = {
            "torque": torque, "feed_per_rev": self.pitch, "core_drill": self.diameter - self.pitch,
            "pitch_diameter": self.diameter - PITCH_DEPTH * self.pitch,
        }  # fmt: skip
        speed = self.spindle
        if speed is None and self.cutting_speed is not None:
            speed = 2.0 * self.cutting_speed / self.diameter
        if speed is not None:
            feed = self.pitch * speed / (2.0 * pi)
            found |= {
                "power": torque * speed,
                "feed": feed,
                "spindle": speed,
                "cutting_speed": 0.5 * self.diameter * speed,
            }
            if self.depth is not None:
                found["time"] = 2.0 * self.depth / feed
        return found
