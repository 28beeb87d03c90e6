"""Milling without force: what a cutter takes, and where shank and holder touch, for runs about the shape alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from gcodesim.frozen import frozen
from gcodesim.processes.milling import Milling
from gcodesim.processes.signal import SPINDLE

if TYPE_CHECKING:
    from gcodesim.material.stock import Stock
    from gcodesim.processes.milling_kernels import Motion
    from gcodesim.processes.turns import Turns
    from gcodesim.processes.window import ProcessState, ProcessStep, Window


@frozen(slots=False, eq=False)
class MillingShape(Milling):
    """The cutting process of one cutter that is rigid and feels nothing: how fast it goes does not matter."""

    pushes: ClassVar[bool] = False

    @property
    def by_path(self) -> bool:
        return True

    def run(self, stock: Stock | None, window: Window, state: ProcessState) -> ProcessStep:
        done = super().run(stock, window, state)
        if stock is None:
            return done
        removed, spindle = done["removed"], window.signals[SPINDLE.name]
        fed = np.where(window.rapid, 0.0, removed)
        own = {"stopped_cut": np.where(spindle == 0.0, fed, 0.0), "reversed_cut": np.where(spindle < 0.0, fed, 0.0)}
        return replace(done, columns={**done.columns, **own})

    def _motion_of(self, window: Window, turns: Turns, cell: float) -> Motion:
        """In rapids no tool feels anything, so that the kernel does not look for it."""
        motion = super()._motion_of(window, turns, cell)
        return motion._replace(rapid=np.ones(len(motion.rapid), dtype=np.bool_), compliance=np.zeros((0, 3, 6)))
