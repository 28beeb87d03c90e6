"""A rotating cutter in a cut of known size: forces, torque, power, chip thickness, over a revolution."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from gcodesim.arithmetic.matrices import norms
from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import CannotComputeError, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import NOT_NEGATIVE, POSITIVE
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity, Vector
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut import (
    MODES,
    ConstantCut,
    OneTurn,
    RunOut,
    end_mill_forces,
    handbook_power,
    instantaneous_forces,
    mean_chip_thickness,
    revolution,
    tooth_chips,
)
from gcodesim.processes.laws import Kienzle
from gcodesim.tools import TOOLS
from gcodesim.units import DEG, MM

if TYPE_CHECKING:
    from gcodesim.tools.cutter import Cutter

_KINDS = {
    "flat": "flat_end_mill", "flat_end_mill": "flat_end_mill", "square": "flat_end_mill", "face": "flat_end_mill",
    "face_mill": "flat_end_mill", "ball": "ball_end_mill", "ball_nose": "ball_end_mill",
    "ball_end_mill": "ball_end_mill",
    "ballnose": "ball_end_mill", "bull": "bull_nose_end_mill", "bull_nose": "bull_nose_end_mill",
    "bullnose": "bull_nose_end_mill", "bull_nose_end_mill": "bull_nose_end_mill", "torus": "bull_nose_end_mill",
}  # fmt: skip
_MODES = {
    "conventional": "up", "climb": "down", "full": "slot", "slotting": "slot", "center": "centred",
    "centered": "centred", "central": "centred", "symmetric": "centred", "face": "centred",
}  # fmt: skip
_NOT_NEGATIVE = Quantity("length", NOT_NEGATIVE)
_LENGTH = Quantity("length", POSITIVE)


@frozen
class EndMill(CutModel):
    """A flat, ball or bull nose mill, also with edges at a lead angle, uneven teeth, or with run-out."""

    kind: ClassVar[str] = "endmill"
    says: ClassVar[str] = "forces, torque, power and chips of a mill over a revolution"
    source: ClassVar[str] = (
        "Altintas 2012, sec. 2.8, over teeth, heights and angles: h = c sin(phi) sin(kappa), db = dz/sin(kappa)"
        "; run-out and uneven teeth: Kline and DeVor 1983"
    )
    also: ClassVar[tuple[str, ...]] = (
        "end_mill", "milling", "ballnose", "ball_nose", "ball", "bullnose", "bull_nose", "bull", "facemill",
        "face_mill", "milling.forces", "milling.runout", "runout", "run_out",
    )  # fmt: skip
    spellings: ClassVar[dict[str, str]] = {
        "teeth": "flutes", "z": "flutes", "N": "flutes", "D": "diameter", "fz": "feed_per_tooth",
        "ipt": "feed_per_tooth",
        "vf": "feed", "n": "spindle", "spindle_speed": "spindle", "rpm": "spindle", "kappa": "lead_angle",
        "entering_angle": "lead_angle", "approach_angle": "lead_angle", "kappa_r": "lead_angle", "beta": "helix",
        "helix_angle": "helix", "r": "corner_radius", "nose_radius": "corner_radius", "run_out": "runout",
        "eccentricity": "runout", "run_out_angle": "runout_angle", "phi_st": "entry", "phi_ex": "exit",
        "entry_angle": "entry", "exit_angle": "exit",
        "pitch_angles": "pitches", "helix_angles": "helices",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result("mean_Fx", "force", "on the tool along its feed, mean over a revolution"),
        Result("mean_Fy", "force", "to the left of the feed"),
        Result("mean_Fz", "force", "towards the holder"),
        Result("mean_torque", "torque", "of the spindle", ("torque",)),
        Result("mean_power", "power", "torque times speed", ("power", "cutting_power")),
        Result("mrr", "volume flow", "removal rate", ("MRR", "removal_rate", "Q")),
        Result("peak_Fx", "force", "greatest within a revolution"),
        Result("peak_Fy", "force"),
        Result("peak_Fz", "force"),
        Result("peak_F", "force", "greatest size of the force", ("peak_force",)),
        Result("peak_torque", "torque"),
        Result("mean_chip_thickness", "length", "over the angle of contact", ("hm", "h_m", "mean_chip")),
        Result("max_chip_thickness", "length", "the greatest", ("hmax", "h_max", "hex", "peak_chip_thickness")),
        Result("chip_per_tooth", "length", "greatest chip thickness of each tooth", ("h_max_per_tooth", "max_chips")),
        Result("entry", "angle", "where a tooth enters, clockwise from left of the feed", ("phi_st", "phi_entry")),
        Result("exit", "angle", "where it leaves", ("phi_ex", "phi_exit")),
        Result("feed", "speed", "feed per tooth times teeth times speed", ("vf", "table_feed")),
        Result("cutting_speed", "speed", "at the diameter", ("vc",)),
        Result("handbook_power", "power", "kc(h_m) ap ae v_f, an upper bound", ("power_handbook",)),
        Result("Fx_theta{}", "force", "at an angle of tooth 0"),
        Result("Fy_theta{}", "force"),
        Result("Fz_theta{}", "force"),
        Result("F_theta{}", "force", "size of the force"),
        Result("torque_theta{}", "torque"),
    )

    type: str = key(Choice(tuple(_KINDS), "the mill is one"), "kind of mill", default="flat")
    diameter: float = key(_LENGTH, "cutting diameter", example="10 mm")
    corner_radius: float | None = key(_NOT_NEGATIVE, "of a bull nose", default=None, example="1 mm")
    flutes: int = key("count", "number of teeth", default=2)
    helix: float = key("angle", "helix angle", default=0.0)
    lead_angle: float | None = key(
        "angle", "kappa, between edge and face; 90 deg is a cylinder (default: by the kind of mill)", default=None
    )
    mode: str = key(Choice((*MODES, *_MODES)), "how it cuts: up is conventional, down is climb", default="slot")
    ap: float = key(_NOT_NEGATIVE, "axial depth of cut", example="5 mm")
    ae: float | None = key(
        _NOT_NEGATIVE, "radial width of cut; a slot takes the diameter", default=None, example="3 mm"
    )
    entry: float | None = key("angle", "where teeth enter, in place of that of `mode`", default=None)
    exit: float | None = key("angle", "where they leave", default=None)
    feed_per_tooth: float | None = key(_NOT_NEGATIVE, "c; or give `feed`", default=None, example="0.05 mm")
    feed: float | None = key("speed", "of the table", default=None, example="800 mm/min")
    spindle: float | None = key("rotational speed", "for power and removal rate", default=None, example="4000 rpm")
    cutting_speed: float | None = key("speed", "in place of `spindle`", default=None, example="120 m/min")
    pitches: tuple[float, ...] = key(
        Vector(Quantity("angle", POSITIVE)), "from each tooth to the one ahead", default=(), rule="all alike",
        example="[85, 95, 85, 95 deg]",
    )  # fmt: skip
    helices: tuple[float, ...] = key(
        Vector(Quantity("angle")), "helix of each tooth", default=(), rule="that of `helix`",
        example="[35, 38, 35, 38 deg]",
    )  # fmt: skip
    up_cut: float | None = key(
        _LENGTH, "compression edges: height from which on the helix goes back", default=None, example="6 mm"
    )
    runout: float = key(_NOT_NEGATIVE, "distance of the edges' axis from that of the spindle", default=0.0)
    runout_angle: float = key("angle", "of that distance, ahead of tooth 0", default=0.0)
    theta: tuple[float, ...] = key(
        Vector(Quantity("angle")), "angles of tooth 0 for which forces are told", default=(), example="[100, 130 deg]"
    )

    @property
    def cutter(self) -> Cutter:
        """The mill, with edges as long as needed."""
        name = _KINDS[self.type]
        more: dict[str, Any] = {}
        if name == "bull_nose_end_mill":
            if self.corner_radius is None:
                raise CannotComputeError("a bull nose mill needs its `corner_radius`")
            more["corner_radius"] = self.corner_radius
        length = max(4.0 * self.diameter, 2.0 * self.ap, 40.0 * MM)
        made: Cutter = TOOLS[name](
            diameter=self.diameter, flutes=self.flutes, helix=self.helix, length=length, flute_length=length,
            pitches=self.pitches or None, helices=self.helices or None, up_cut=self.up_cut, **more,
        )  # fmt: skip
        for _, problem in made.problems():
            raise CannotComputeError(problem)
        return made

    @property
    def speed(self) -> float:
        """Of the spindle [rad/s]; 0 where the inputs do not say."""
        if self.spindle is not None:
            return self.spindle
        return 0.0 if self.cutting_speed is None else 2.0 * self.cutting_speed / self.diameter

    @property
    def chip(self) -> float:
        """Feed per tooth [m]."""
        if self.feed_per_tooth is not None:
            return self.feed_per_tooth
        if self.feed is None or not self.speed:
            raise CannotComputeError("how thick is a chip? give `feed_per_tooth`, or `feed` and `spindle`")
        return self.feed * 2.0 * pi / (self.flutes * self.speed)

    @property
    def cut(self) -> ConstantCut:
        """The size of the cut."""
        mode: Any = _MODES.get(self.mode, self.mode)
        ae = self.diameter if self.ae is None else self.ae
        if self.ae is None and mode != "slot" and (self.entry is None or self.exit is None):
            raise CannotComputeError(f"a cut `{self.mode}` needs its width `ae`")
        if ae > self.diameter * (1.0 + 1e-12):
            raise CannotComputeError(f"`ae` {ae / MM:g} mm is more than the diameter {self.diameter / MM:g} mm")
        return ConstantCut(
            mode=mode, ap=self.ap, ae=ae, feed_per_tooth=self.chip, spindle=self.speed, entry=self.entry, exit=self.exit
        )

    @property
    def kappa(self) -> float | None:
        """The lead angle of a straight edge that is no cylinder [rad], else None."""
        if self.lead_angle is None or _KINDS[self.type] != "flat_end_mill":
            return None
        if not 0.0 < self.lead_angle <= 0.5 * pi + 1e-9:
            raise CannotComputeError(f"`lead_angle` is {self.lead_angle / DEG:g} deg; it is above 0 and at most 90 deg")
        return None if abs(self.lead_angle - 0.5 * pi) < 1e-9 else self.lead_angle

    @property
    def eccentric(self) -> RunOut | None:
        """The run-out, None where there is none."""
        return RunOut(offset=self.runout, angle=self.runout_angle) if self.runout > 0.0 else None

    def compute(self) -> dict[str, Value]:
        cutter, law, cut, kappa, run_out = self.cutter, self.law, self.cut, self.kappa, self.eccentric
        mean = end_mill_forces(cutter, law, cut, lead_angle=kappa, run_out=run_out)
        chips = tooth_chips(cutter, cut, run_out, kappa)
        entry, leave = cut.limits(self.diameter)
        found: dict[str, Value] = {}
        for i, axis in enumerate("xyz"):
            found[f"mean_F{axis}"] = float(mean.force[i])
        for i, axis in enumerate("xyz"):
            found[f"peak_F{axis}"] = float(mean.peak_force[i])
        found |= {
            "peak_F": mean.peak, "mean_torque": mean.torque, "peak_torque": mean.peak_torque,
            "mean_chip_thickness": mean_chip_thickness(cutter, cut, kappa), "max_chip_thickness": float(chips.max()),
            "entry": entry, "exit": leave,
        }  # fmt: skip
        if run_out is not None or cutter.uneven:
            found["chip_per_tooth"] = chips.tolist()
        if self.speed:
            found |= {
                "mean_power": mean.power, "mrr": mean.mrr, "cutting_speed": 0.5 * self.diameter * self.speed,
                "feed": cut.feed_per_tooth * self.flutes * self.speed / (2.0 * pi),
            }  # fmt: skip
            if isinstance(law, Kienzle):
                found["handbook_power"] = handbook_power(law, cutter, cut, kappa)
        forces, torques = instantaneous_forces(cutter, law, cut, np.array(self.theta), kappa, run_out)
        for theta, force, size, torque in zip(self.theta, forces, norms(forces), torques, strict=True):
            at = f"{theta / DEG:.10g}"
            found |= {f"F{axis}_theta{at}": float(force[i]) for i, axis in enumerate("xyz")}
            found |= {f"F_theta{at}": float(size), f"torque_theta{at}": float(torque)}
        return found

    def turn(self) -> OneTurn:
        return revolution(self.cutter, self.law, self.cut, self.kappa, self.eccentric)
