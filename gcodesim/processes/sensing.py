"""Sensing: a probe near a stock. It takes nothing and feels nothing; by a move that does not probe it must not touch.

Where a probing move trips is found before it is run (`checks.contact`); the executor does not ask about such moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.diagnostics import Diagnostic
from gcodesim.frozen import frozen
from gcodesim.processes.column import FINDINGS, Column
from gcodesim.processes.protocol import Process
from gcodesim.processes.rows import Rows
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import Zone
from gcodesim.tools.probe import Probe
from gcodesim.units import MM, UM

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material

Array = NDArray[np.float64]

LEAST: Final = 1.0 * UM
"""Depth [m] from which on a probe counts as run into the stock."""


@frozen(slots=False, eq=False)
class Sensing(Process):
    """What a probe does besides probing: it may run into a stock."""

    kind: ClassVar[str] = "sensing"
    touches: ClassVar[bool] = True
    writes: ClassVar[tuple[Column, ...]] = (
        Column("probe_depth", "m", "greatest", FINDINGS, "depth of the probe in stock, by a move that does not probe"),
    )

    probe: Probe

    @classmethod
    def of(cls, tool: Probe, material: Material | None) -> Sensing:
        """Any material is too hard for a stylus."""
        return cls(probe=tool)

    @property
    def zone(self) -> Zone:
        return Zone(radius=0.5 * self.probe.diameter, above=self.probe.length)

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        """How deep ball and stem go into `stock`, which stays as it is; the probe counts as upright."""
        from gcodesim.material.shape import ball, cylinder

        depth = np.zeros(window.steps)
        if stock is not None:
            probe = self.probe
            shapes = (
                ball(probe.diameter, probe.diameter),
                cylinder(probe.stem_diameter, probe.diameter, probe.length),
            )
            high = np.minimum(window.piece_start[:, 2], window.piece_end[:, 2]) > stock.top
            near = np.flatnonzero(~high)
            found = np.zeros(len(near))
            for shape in shapes:
                found = np.maximum(found, stock.touch(window.piece_start[near], window.piece_end[near], shape)[1])
            np.maximum.at(depth, window.piece_step[near], np.where(found > LEAST, found, 0.0))
        return ProcessStep.free(window.steps, {"probe_depth": depth})

    @classmethod
    def findings(cls, rows: Rows) -> Iterator[Diagnostic]:
        """GS408, one for each time that a probe runs into stock."""
        depth = rows["probe_depth"]
        for event in rows.events(depth > 0.0):
            first, worst = int(event[0]), float(depth[event].max()) / MM
            yield Diagnostic(
                code="GS408",
                message=f"{rows.tool_name(first)} runs into stock, {worst:.3f} mm deep, by a move that does not probe",
                span=rows.span(first),
                hint="go there with G38.3, which stops where it touches, or keep more distance",
                count=len(event),
                time=float(rows.time[first]),
                value=worst,
                limit=0.0,
                unit="mm",
            )
