"""Chip thinning: the chip of a shallow or slanting cut, and the feed that makes it as thick as wanted."""

from __future__ import annotations

from math import pi
from typing import ClassVar

from gcodesim.arithmetic.elementary import acos, sin
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.chip_load import radial_thinning, round_sine
from gcodesim.units import MM

_LENGTH = Quantity("length", POSITIVE)


@frozen
class ChipThinning(Model):
    """Radial thinning by the width of cut, axial thinning by the angle or the roundness of the edge."""

    kind: ClassVar[str] = "chip_thinning"
    says: ClassVar[str] = "chip thickness of shallow cuts, and the feed that makes up for it"
    source: ClassVar[str] = (
        "h_ex = f_z sin(kappa) 2 sqrt(ae/D - (ae/D)^2) below half the diameter; h_m = f_z sin(kappa) 2 ae/(D phi_s);"
        " round edges: sin(kappa) = 2 sqrt(ap/d - (ap/d)^2)"
    )
    also: ClassVar[tuple[str, ...]] = (
        "milling.chip_thinning",
        "chipthinning",
        "thinning",
        "radial_chip_thinning",
        "chip_load",
    )
    spellings: ClassVar[dict[str, str]] = {
        "D": "diameter", "fz": "feed_per_tooth", "ipt": "feed_per_tooth", "chip_load": "feed_per_tooth",
        "kappa": "lead_angle", "entering_angle": "lead_angle", "kappa_r": "lead_angle", "wanted_chip": "chip_thickness",
        "target_chip": "chip_thickness", "hex": "chip_thickness", "h": "chip_thickness", "target_h": "chip_thickness",
        "target_chip_thickness": "chip_thickness", "desired_chip_thickness": "chip_thickness", "r": "corner_radius",
        "insert_diameter": "edge_diameter",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result(
            "max_chip_thickness", "length", "of `feed_per_tooth`", ("hex", "h_ex", "h_max", "hmax", "chip_thickness")
        ),
        Result("mean_chip_thickness", "length", "over the angle of contact", ("hm", "h_m")),
        Result("factor", "", "chip over feed per tooth, below 1 where it is thinner", ("thinning", "thinning_factor")),
        Result(
            "compensation",
            "",
            "feed per tooth over chip",
            ("feed_factor", "compensation_factor", "rctf", "RCTF", "ctf"),
        ),
        Result(
            "compensated_feed",
            "length",
            "feed per tooth for a chip as thick as `chip_thickness`, or as the feed",
            ("feed_per_tooth", "fz", "compensated_feed_per_tooth", "adjusted_feed_per_tooth", "adjusted_chip_load"),
        ),
        Result("contact_angle", "angle", "phi_s", ("engagement_angle", "phi_s")),
        Result("effective_diameter", "length", "cutting diameter at the top of the cut", ("deff", "d_eff", "D_eff")),
    )

    diameter: float = key(_LENGTH, "cutting diameter", example="10 mm")
    ae: float | None = key(_LENGTH, "width of cut (default: the diameter)", default=None, example="1 mm")
    feed_per_tooth: float | None = key(_LENGTH, "c; or `chip_thickness`", default=None, example="0.05 mm")
    chip_thickness: float | None = key(_LENGTH, "that is wanted", default=None)
    type: str = key(Choice(("flat", "ball", "bull", "round")), "edge", default="flat")
    lead_angle: float = key("angle", "kappa of a straight edge", default=0.5 * pi)
    ap: float | None = key(_LENGTH, "depth of cut of a round edge", default=None)
    corner_radius: float | None = key("length", "of a bull nose", default=None)
    edge_diameter: float | None = key("length", "of round inserts", default=None)

    def compute(self) -> dict[str, Value]:
        ae = self.diameter if self.ae is None else self.ae
        if ae > self.diameter * (1.0 + 1e-12):
            raise CannotComputeError(f"`ae` {ae / MM:g} mm is more than the diameter {self.diameter / MM:g} mm")
        sine, effective = self._edge()
        width = min(ae, effective)
        factor = sine * radial_thinning(width, effective)
        contact = acos(max(1.0 - 2.0 * width / effective, -1.0))
        found: dict[str, Value] = {
            "factor": factor, "compensation": 1.0 / factor, "contact_angle": contact, "effective_diameter": effective,
        }  # fmt: skip
        wanted = self.chip_thickness
        if self.feed_per_tooth is not None:
            found["max_chip_thickness"] = self.feed_per_tooth * factor
            found["mean_chip_thickness"] = self.feed_per_tooth * sine * 2.0 * width / (effective * contact)
            wanted = self.feed_per_tooth if wanted is None else wanted
        if wanted is None:
            raise CannotComputeError("give `feed_per_tooth`, or the `chip_thickness` that is wanted")
        found["compensated_feed"] = wanted / factor
        return found

    def _edge(self) -> tuple[float, float]:
        """Sine of kappa, and the cutting diameter, at the top of the cut."""
        if self.type == "flat":
            return sin(self.lead_angle), self.diameter
        round_ = {
            "ball": self.diameter,
            "bull": None if self.corner_radius is None else 2.0 * self.corner_radius,
            "round": self.edge_diameter,
        }[self.type]
        if round_ is None or self.ap is None:
            raise CannotComputeError(f"a {self.type} edge needs `ap`, and its `corner_radius` or `edge_diameter`")
        sine = round_sine(self.ap, round_)
        return sine, self.diameter - round_ * (1.0 - sine)
