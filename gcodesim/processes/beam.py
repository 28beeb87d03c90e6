"""Beams: what lasers, torches, jets and blasting guns do to a stock from a distance.

A beam is on or off and gives something, energy or erosion, to where its rays strike first. How much of that takes how
much material is the affair of the process; where it strikes, the shade, the cosine of the incidence, kerf, taper and
cuts that go through come from the rays (`material.beam_kernels`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gcodesim.frozen import frozen
from gcodesim.processes.column import ENGAGED, FINDINGS, LINES, LOG, REMOVED, RESULTS, Column
from gcodesim.processes.protocol import Process
from gcodesim.processes.window import ProcessState, ProcessStep, Window, sums_by_step
from gcodesim.processes.zone import Zone
from gcodesim.units import MM, MM3

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.assembly import StockAssembly
    from gcodesim.material.beam import BeamForm, Struck, StruckParts
    from gcodesim.material.stock import Stock
    from gcodesim.processes.rows import Rows
    from gcodesim.tools.beam_tool import BeamTool

Array = NDArray[np.float64]

BEAM_ON = Column("beam", of="any", shown_in=LOG | LINES | RESULTS, says="the beam is on")
OUT_OF_FOCUS = Column(
    "out_of_focus", "m", "greatest", FINDINGS, "how far from where it is meant to strike, beyond the tolerance"
)
IN_FOCUS = Column("in_focus", of="any", shown_in=RESULTS, says="it strikes where it is meant to, within its tolerance")
IN_RAPID = Column("beam_in_rapid", of="any", shown_in=FINDINGS, says="the beam is on in a rapid")
WITHOUT_GAS = Column("beam_without_gas", of="any", shown_in=FINDINGS, says="the beam cuts while no gas flows")
TOO_MUCH = Column("beam_too_much", "W", "greatest", FINDINGS, "power beyond that of the tool")

GENERAL = (REMOVED, ENGAGED, BEAM_ON, IN_FOCUS, OUT_OF_FOCUS, IN_RAPID, WITHOUT_GAS, TOO_MUCH)
"""Columns of every beam."""


class DoseUnit(NamedTuple):
    """How a dose is told: for each area, and summed over it; with how much SI one of these is."""

    of_area: str
    per_area: float
    of_whole: str
    whole: float


DOSES: Final = {"fluence": DoseUnit("J/mm^2", 1e6, "J", 1.0), "wear": DoseUnit("mm", MM, "mm^3", MM3)}
"""What beams give: energy, or the depth by which a surface could be worn."""


class BeamSetting(NamedTuple):
    """How a beam is set in each of n steps: whether it is `on`; what it gives [W], or [m³/s] of erosion, and the
    volume [m³/s] that it could take; whether `gas` flows, and power asked for `beyond` that of the tool [W]."""

    on: NDArray[np.bool_]
    gives: Array
    takes: Array
    gas: NDArray[np.bool_]
    beyond: Array


@frozen(slots=False, eq=False)
class Beam(Process):
    """The base of processes that act along rays. Its zone is everywhere, so that a beam that strikes nothing is told.

    `dose` names what a place gets, in `stock.doses`; `given` and `landed` are columns: what the beam gave, and what of
    it met material.
    """

    takes: ClassVar[bool] = True
    together: ClassVar[bool] = True
    dose: ClassVar[str] = ""
    given: ClassVar[str] = ""
    landed: ClassVar[str] = ""

    tool: BeamTool

    def setting(self, window: Window) -> BeamSetting:
        """What the signals of a window make of the beam."""
        raise NotImplementedError

    @classmethod
    def is_on(cls, signals: Mapping[str, NDArray[Any]], tool: BeamTool) -> NDArray[np.bool_]:
        power = signals.get("power", np.full(len(signals["beam"]), np.nan))
        return np.where(np.isnan(signals["beam"]), power > 0.0, signals["beam"] > 0.0).astype(bool)

    @property
    def threshold(self) -> float:
        """Dose [per m²] that goes by before material is taken."""
        return 0.0

    def takes_within(self, depth: float) -> Zone:
        from gcodesim.material.beam import widest_within

        tool: Any = self.tool
        far = min(max(depth, 0.0), tool.reach)
        return Zone(radius=widest_within(self.form, far), below=far, above=tool.stand_off)

    @property
    def form(self) -> BeamForm:
        """The beam as kernels take it."""
        from gcodesim.material.beam import PROFILES, BeamForm

        tool: Any = self.tool
        return BeamForm(
            profile=PROFILES[tool.profile],
            radius=0.5 * tool.diameter,
            focus=tool.focus,
            rayleigh=tool.rayleigh,
            slope=tool.slope,
            mouth=-tool.stand_off,
            reach=tool.reach,
        )

    def run(self, stock: Stock | StockAssembly | None, window: Window, state: ProcessState) -> ProcessStep:
        """Let the beam act on `stock` (in place) along the pieces of `window`."""
        n = window.steps
        setting = self.setting(window)
        if stock is None or not setting.on.any():
            return ProcessStep.free(n)
        from gcodesim.material.assembly import StockAssembly
        from gcodesim.material.beam import BeamWay, strike_assembly, strike_stock

        tool: Any = self.tool
        lit = np.flatnonzero(setting.on[window.piece_step])
        step = window.piece_step[lit]
        share = np.ones(len(lit)) if window.piece_share is None else np.diff(window.piece_share[lit], axis=1)[:, 0]
        seconds = share * window.dt
        given = setting.gives[step] * seconds
        way = BeamWay(
            window.piece_start[lit], window.piece_end[lit], window.axis[step], setting.takes[step] * seconds, given
        )
        struck: Struck | StruckParts
        if isinstance(stock, StockAssembly):
            takes = [self.of(tool, material).setting(window).takes for material in stock.materials]
            volume = np.stack([own[step] * seconds for own in takes], axis=1)
            parts = strike_assembly(stock, self.form, way, volume, self.dose, self.threshold)
            struck, taken = parts, parts.taken.sum(axis=1)
            by_stock = {
                name: {"removed": sums_by_step(step, own, n)}
                for name, own in zip(stock.names, parts.taken.T, strict=True)
            }
        else:
            struck = strike_stock(stock, self.form, way, self.dose, self.threshold)
            taken, by_stock = struck.taken, {}
        removed = sums_by_step(step, taken, n)
        off, dose, sharp = np.zeros(n), np.zeros(n), np.zeros(n, dtype=bool)
        allowed = tool.tolerance * (1.0 + 1e-9)
        np.maximum.at(off, step, np.where(np.isfinite(struck.off) & (struck.off > allowed), struck.off, 0.0))
        sharp[step[struck.off <= allowed]] = True
        np.maximum.at(dose, step, struck.dose)
        landed = sums_by_step(step, struck.met, n)
        columns = {
            "removed": removed,
            "engaged": landed > 0.0,
            "beam": setting.on,
            "in_focus": sharp,
            "out_of_focus": off,
            "beam_in_rapid": setting.on & window.rapid & window.moving,
            "beam_without_gas": setting.on & ~setting.gas & (landed > 0.0),
            "beam_too_much": setting.beyond,
            self.given: sums_by_step(step, given, n),
            self.landed: landed,
            self.dose: dose,
        }
        return ProcessStep.free(n, columns, by_stock)

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS540 to GS546."""
        from gcodesim.processes.beam_misuse import beam_findings

        return beam_findings(rows, cls)


def switched(window: Window, known: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether the beam is on (n,) by the signal `beam`; where that was never given, where its power is `known`."""
    beam = window.signals["beam"]
    return np.where(np.isnan(beam), known, beam > 0.0).astype(bool)
