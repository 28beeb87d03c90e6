"""Extrusion: a nozzle lays a bead along its path while it is switched on.

The bead is a rectangle with round ends; its volume is section times length, whatever the pump could deliver. Where
material is already in the way the bead loses that part, so less than the nominal volume may be added. No force.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import norms
from gcodesim.frozen import frozen
from gcodesim.processes.column import ADDED, ENGAGED, Column, Shown
from gcodesim.processes.protocol import Process
from gcodesim.processes.signal import ACTIVE, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.tools.extruder import Extruder

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.materials import Material

Array = NDArray[np.float64]


@frozen(slots=False, eq=False)
class Extrusion(Process):
    """The printing process of one extruder: adds its bead to the stock on feed moves while active.

    It lays its bead wherever it is switched on, so its zone is everywhere. It exerts no force, so the machine does not
    yield and a whole window can be laid at once.
    """

    kind: ClassVar[str] = "extrusion"
    reads: ClassVar[tuple[Signal, ...]] = (ACTIVE,)
    writes: ClassVar[tuple[Column, ...]] = (
        ADDED,
        ENGAGED,
        Column("nominal", "m^3", "sum", Shown.NOWHERE, "volume that it meant to add"),
    )

    extruder: Extruder

    @classmethod
    def of(cls, tool: Extruder, material: Material | None) -> Extrusion:
        """The process of an extruder; the material it lays has no cutting constants."""
        return cls(extruder=tool)

    @property
    def laid_section(self) -> float:
        return self.extruder.bead_width * self.extruder.bead_height

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        """Add to `stock` (in place) along the active pieces of `window`."""
        n = window.steps
        laid = window.signals[ACTIVE.name][window.piece_step] > 0.0
        lengths = norms(window.piece_end - window.piece_start) * laid
        nominal = _sums(window.piece_step, self.extruder.bead_area * lengths, n)
        added = np.zeros(n)
        if stock is not None and laid.any():
            found = stock.add_bead(
                window.piece_start[laid],
                window.piece_end[laid],
                self.extruder.bead_width,
                self.extruder.bead_height,
            )
            added = _sums(window.piece_step[laid], found.volume, n)
        return ProcessStep.free(n, {"added": added, "nominal": nominal, "engaged": nominal > 0.0})


def _sums(step: NDArray[np.int64], value: Array, steps: int) -> Array:
    """Sums (steps,) of `value` (c,) over the pieces of each step."""
    totals = np.zeros(steps)
    np.add.at(totals, step, value)
    return totals
