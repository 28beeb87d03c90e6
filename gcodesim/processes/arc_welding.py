"""Arc welding: a wire melts, and lies on the work as a bead with the section of a parabola."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.processes.column import ADDED, ENGAGED, FINDINGS, LINES, LOG, RESULTS, Column, Shown
from gcodesim.processes.protocol import Process
from gcodesim.processes.signal import ACTIVE, FEED, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window, sums_by_step
from gcodesim.tools.welding_torch import WeldingTorch

if TYPE_CHECKING:
    from gcodesim.diagnostics import Diagnostic
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material
    from gcodesim.processes.rows import Rows

Array = NDArray[np.float64]

WIRE_SPEED = Signal("wire_speed", "m/s", default=np.nan, least=0.0)
"""Speed of the wire; not a number where no word gives it, and it is the tool's own."""

MOST = 50.0
"""Sections of the wire that a bead may have: a torch that hardly moves makes a wide drop."""

STEADY = 0.9
"""Share of the programmed feed from which on the size of the bead is told: not while the torch starts or stops."""


@frozen(slots=False, eq=False)
class ArcWelding(Process):
    """What one torch adds: section = yield wire area wire speed / travel speed; heat for each length = eta U I / v.

    It exerts no force. The bead lies on what is highest within the arc's `reach` of the tip, on slopes and in grooves
    too; it does not flow, and nothing is melted of the work itself.
    """

    kind: ClassVar[str] = "arc_welding"
    lays: ClassVar[bool] = True
    together: ClassVar[bool] = True
    told_by_words: ClassVar[tuple[str, ...]] = ("GS542",)
    reads: ClassVar[tuple[Signal, ...]] = (ACTIVE, WIRE_SPEED, FEED)
    writes: ClassVar[tuple[Column, ...]] = (
        ADDED,
        ENGAGED,
        Column("arc", of="any", shown_in=LOG | LINES | RESULTS, says="the arc burns"),
        Column("wire", "m^3", "sum", RESULTS, "volume of wire that was melted"),
        Column("spatter", "m^3", "sum", RESULTS, "of that, what does not stay in the bead"),
        Column("arc_heat", "J", "sum", RESULTS, "heat that gets into the work"),
        Column("heat_per_length", "J/m", "greatest", LOG | LINES | RESULTS, "heat for each length of the bead"),
        Column("weld_height", "m", "greatest", LOG | LINES | RESULTS, "height of the bead"),
        Column("weld_width", "m", "greatest", LOG | LINES | RESULTS, "width of the bead"),
        Column("too_steep", "m", "greatest", FINDINGS, "height of a bead that is higher than wide"),
        Column("arc_on_nothing", "m^3", "sum", RESULTS, "melted where no work is in reach of the arc"),
        Column("arc_in_rapid", of="any", shown_in=FINDINGS, says="the arc burns in a rapid"),
        Column("weld_nominal", "m^3", "sum", Shown.NOWHERE, "volume that it meant to add"),
    )

    torch: WeldingTorch

    @classmethod
    def of(cls, tool: WeldingTorch, material: Material | None) -> ArcWelding:
        """The process of a torch; the wire has no cutting constants."""
        return cls(torch=tool)

    @property
    def swept(self) -> Array | None:
        half = 0.5 * float(self.torch.widths_of(np.array([self.torch.wire_area]))[0])
        return np.array([[-half, -self.torch.reach], [half, -self.torch.reach], [half, 0.0], [-half, 0.0]])

    @classmethod
    def is_on(cls, signals: Mapping[str, NDArray[Any]], tool: WeldingTorch) -> NDArray[np.bool_]:
        return (signals[ACTIVE.name] > 0.0) & ~(signals[WIRE_SPEED.name] <= 0.0)

    @classmethod
    def needs(cls, tool: WeldingTorch) -> tuple[Signal, ...]:
        return (WIRE_SPEED,)

    def begin(self) -> ProcessState:
        return ProcessState()

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        """Lay what melts on `stock` (in place) along the pieces of `window`."""
        n, torch = window.steps, self.torch
        asked = window.signals[WIRE_SPEED.name]
        wire = np.where(np.isnan(asked), torch.wire_speed, asked) * torch.wire_area
        on = (window.signals[ACTIVE.name] > 0.0) & (wire > 0.0)
        if stock is None or not on.any():
            return ProcessStep.free(n)
        from gcodesim.material.crown import Crown, melt_onto

        lit = np.flatnonzero(on[window.piece_step])
        step = window.piece_step[lit]
        share = np.ones(len(lit)) if window.piece_share is None else np.diff(window.piece_share[lit], axis=1)[:, 0]
        melted = wire[step] * share * window.dt
        start, end = window.piece_start[lit], window.piece_end[lit]
        length = norms(end - start)
        volume = torch.yield_ * melted
        section = np.minimum(volume / np.maximum(length, 1e-9), MOST * torch.wire_area)
        width = torch.widths_of(section)
        molten = melt_onto(stock, Crown(np.hstack([start, end]), volume, width, torch.reach))
        speed = norms(window.velocity)
        steady = speed > STEADY * window.signals[FEED.name]
        high = np.where(steady[step], 1.5 * section / width, 0.0)
        height, wide, steep = np.zeros((3, n))
        for greatest, values in (
            (height, high),
            (wide, np.where(steady[step], width, 0.0)),
            (steep, np.where(high > width, high, 0.0)),
        ):
            np.maximum.at(greatest, step, values)
        power = torch.efficiency * (torch.voltage or 0.0) * (torch.current or 0.0)
        columns = {
            "added": sums_by_step(step, molten.volume, n),
            "engaged": on,
            "arc": on,
            "wire": sums_by_step(step, melted, n),
            "spatter": sums_by_step(step, melted - volume, n),
            "arc_heat": np.where(on, power * window.dt, 0.0),
            "heat_per_length": np.where(on & steady, power / np.where(steady, speed, 1.0), 0.0),
            "weld_height": height,
            "weld_width": wide,
            "too_steep": steep,
            "arc_on_nothing": sums_by_step(step, molten.lost, n),
            "arc_in_rapid": on & window.rapid & window.moving,
            "weld_nominal": sums_by_step(step, volume, n),
        }
        return ProcessStep.free(n, columns)

    @classmethod
    def findings(cls, rows: Rows) -> Iterable[Diagnostic]:
        """GS525 to GS527: the arc burns in a rapid or on nothing, or its bead is higher than wide."""
        from gcodesim.processes.arc_misuse import arc_findings

        return arc_findings(rows)
