"""Stability: how deep a cut may be before it chatters."""

from __future__ import annotations

from math import inf, pi
from typing import Any, ClassVar

from gcodesim.calculator.law_keys import CutModel
from gcodesim.calculator.model import CannotComputeError, Model, Result, Value
from gcodesim.declarations.keys import key
from gcodesim.declarations.kind import POSITIVE, Range
from gcodesim.declarations.plain_kinds import Choice
from gcodesim.declarations.quantity import Quantity
from gcodesim.frozen import frozen
from gcodesim.processes.constant_cut import MODES, ConstantCut
from gcodesim.processes.laws import LinearEdge
from gcodesim.processes.stability import Lobes, Mode, least_width, lobes, turning_frequency

_STIFFNESS = Quantity("stiffness", POSITIVE)
_FREQUENCY = Quantity("frequency", POSITIVE)
_DAMPING = Quantity("ratio", Range(above=0.0, below=1.0))
_LOBES = 5

_SPELLINGS = {
    "natural_frequency": "frequency", "fn": "frequency", "f_n": "frequency", "k": "stiffness", "zeta": "damping",
    "damping_ratio": "damping", "Kt": "Ktc", "Ks": "pressure", "Kf": "pressure",
}  # fmt: skip


@frozen
class MillingLobes(CutModel):
    """One mode along the feed and one across it; they are alike unless the second is given."""

    kind: ClassVar[str] = "stability.milling"
    says: ClassVar[str] = "stability lobes of a mill: depth of cut without chatter"
    source: ClassVar[str] = "Altintas and Budak 1995, zero-order solution"
    also: ClassVar[tuple[str, ...]] = (
        "stability",
        "stability.lobes",
        "lobes",
        "stability_lobes",
        "chatter",
        "milling.stability",
    )
    spellings: ClassVar[dict[str, str]] = {
        **{name: to for name, to in _SPELLINGS.items() if to != "pressure"}, "teeth": "flutes", "N": "flutes",
        "z": "flutes",
        "D": "diameter", "n": "spindle", "rpm": "spindle", "spindle_speed": "spindle", "Kr": "radial_ratio",
        "phi_st": "entry", "phi_ex": "exit", "entry_angle": "entry", "exit_angle": "exit",
        "frequency_x": "frequency", "natural_frequency_x": "frequency", "natural_frequency_y": "frequency_y",
        "stiffness_x": "stiffness", "damping_x": "damping", "damping_ratio_x": "damping",
        "damping_ratio_y": "damping_y",
        "fx": "frequency", "fy": "frequency_y", "kx": "stiffness", "ky": "stiffness_y", "zeta_x": "damping",
        "zeta_y": "damping_y", "krc_ratio": "radial_ratio",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result(
            "limit_depth",
            "length",
            "stable at any speed",
            ("a_lim", "alim", "a_lim_min", "blim", "b_lim", "critical_depth", "min_stable_depth", "ap_lim"),
        ),
        Result("chatter_frequency", "frequency", "at that depth", ("fc", "f_c")),
        Result(
            "pocket_speeds",
            "rotational speed",
            "where the lobes leave most room: f / (teeth k), k from 1",
            ("best_speeds", "lobe_speeds"),
        ),
        Result("depth_at_speed", "length", "stable at `spindle`", ("a_lim_at_speed", "stable_depth")),
        Result("stable", "", "whether `ap` is stable at `spindle`, or at any speed without one"),
    )

    frequency: float = key(_FREQUENCY, "natural frequency of the tip along the feed", example="600 Hz")
    stiffness: float = key(_STIFFNESS, "of that mode", example="5 N/um")
    damping: float = key(_DAMPING, "its damping ratio", example="0.03")
    frequency_y: float | None = key(_FREQUENCY, "across the feed (default: as along it)", default=None)
    stiffness_y: float | None = key(_STIFFNESS, "across the feed", default=None)
    damping_y: float | None = key(_DAMPING, "across the feed", default=None)
    flutes: int = key("count", "number of teeth", default=2)
    diameter: float | None = key("length", "cutting diameter, for `ae`", default=None)
    mode: str = key(Choice(MODES), "how it cuts", default="slot")
    ae: float | None = key("length", "width of cut", default=None)
    entry: float | None = key("angle", "where teeth enter", default=None)
    exit: float | None = key("angle", "where they leave", default=None)
    radial_ratio: float | None = key("ratio", "radial over tangential force (default: of the law)", default=None)
    spindle: float | None = key("rotational speed", "for the depth at this speed", default=None)
    ap: float | None = key("length", "depth that is judged", default=None)

    @property
    def found_lobes(self) -> Lobes:
        """The limit."""
        law: Any = self.law
        ktc = law.ktc if isinstance(law, LinearEdge) else law.kc11
        ratio = (law.krc if isinstance(law, LinearEdge) else law.kn11) / ktc
        mode: Any = self.mode
        angles = self.entry is not None and self.exit is not None
        if mode != "slot" and not angles and (self.ae is None or self.diameter is None):
            raise CannotComputeError(f"a cut `{mode}` needs `ae` and `diameter`, or `entry` and `exit`")
        diameter = self.diameter or 1.0
        cut = ConstantCut(
            mode=mode, ap=0.0, ae=diameter if self.ae is None else self.ae, feed_per_tooth=0.0, entry=self.entry,
            exit=self.exit,
        )  # fmt: skip
        entry, leave = cut.limits(diameter)
        x = Mode(frequency=self.frequency, stiffness=self.stiffness, damping=self.damping)
        y = Mode(
            frequency=self.frequency_y or x.frequency,
            stiffness=self.stiffness_y or x.stiffness,
            damping=self.damping_y or x.damping,
        )
        ratio = ratio if self.radial_ratio is None else self.radial_ratio
        return lobes(x, y, ktc=ktc, ratio=ratio, teeth=self.flutes, entry=entry, exit=leave)

    def compute(self) -> dict[str, Value]:
        limit = self.found_lobes
        depth, frequency = limit.limit
        if depth == inf:
            raise CannotComputeError("no depth chatters with these modes and angles")
        pockets = [2.0 * pi * self.frequency / (self.flutes * k) for k in range(1, _LOBES + 1)]
        found: dict[str, Value] = {"limit_depth": depth, "chatter_frequency": frequency, "pocket_speeds": pockets}
        allowed = depth
        if self.spindle is not None:
            allowed = limit.depth_at(self.spindle)
            if allowed < inf:
                found["depth_at_speed"] = allowed
        if self.ap is not None:
            found["stable"] = self.ap <= allowed
        return found


@frozen
class TurningStability(Model):
    """Orthogonal cutting with one mode along the normal of the cut."""

    kind: ClassVar[str] = "stability.turning"
    says: ClassVar[str] = "width of cut without chatter in turning"
    source: ClassVar[str] = "Tlusty 1963: b = -1 / (2 K Re G_min) = 2 k zeta (1 + zeta) / K"
    also: ClassVar[tuple[str, ...]] = ("stability.orthogonal", "turning.stability", "chatter.turning", "stability.1dof")
    spellings: ClassVar[dict[str, str]] = {
        **{name: to for name, to in _SPELLINGS.items() if to != "Ktc"}, "kc": "pressure", "Kt": "pressure",
        "Ktc": "pressure",
    }  # fmt: skip
    gives: ClassVar[tuple[Result, ...]] = (
        Result(
            "limit_width",
            "length",
            "stable at any speed",
            ("b_lim", "blim", "b_lim_min", "a_lim", "limit_depth", "critical_depth"),
        ),
        Result("chatter_frequency", "frequency", "at that width", ("fc", "f_c")),
    )

    frequency: float = key(_FREQUENCY, "natural frequency", example="400 Hz")
    stiffness: float = key(_STIFFNESS, "of the mode", example="20 N/um")
    damping: float = key(_DAMPING, "damping ratio", example="0.03")
    pressure: float = key(Quantity("pressure", POSITIVE), "specific force along the normal", example="1500 N/mm^2")
    orientation: float = key(Quantity("ratio", POSITIVE), "directional factor", default=1.0)

    def compute(self) -> dict[str, Value]:
        mode = Mode(frequency=self.frequency, stiffness=self.stiffness, damping=self.damping)
        width = least_width(mode, self.pressure, self.orientation)
        return {"limit_width": width, "chatter_frequency": turning_frequency(mode)}
