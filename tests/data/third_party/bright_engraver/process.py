"""What the beam does: it burns material near its focus, and gives each spot a dose."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bright_engraver.tool import BeamKeys, Engraver
from gcodesim.diagnostics import Diagnostic
from gcodesim.material.shape import cylinder
from gcodesim.processes.column import ENGAGED, FINDINGS, REMOVED, Column
from gcodesim.processes.protocol import Process
from gcodesim.processes.rows import Rows
from gcodesim.processes.signal import SPINDLE, Signal
from gcodesim.processes.window import ProcessState, ProcessStep, Window
from gcodesim.processes.zone import Zone

Array = NDArray[np.float64]

SQUARE_MM = 1e-6

LOWERED = Signal("lowered", "m")
MOST_LOWERED = 1e-3  # m


@dataclass(frozen=True, kw_only=True, eq=False)
class Engraving(Process):
    """Takes what is in the spot near the focus while S and M3 switch the beam on; a word may lower the focus."""

    kind: ClassVar[str] = "engraving"
    takes: ClassVar[bool] = True
    reads: ClassVar[tuple[Signal, ...]] = (SPINDLE, LOWERED)
    writes: ClassVar[tuple[Column, ...]] = (
        REMOVED,
        ENGAGED,
        Column("dose", "J/mm^2", of="greatest", says="energy for the area under the spot"),
        Column("burnt_energy", "J", says="energy that the material took"),
        Column("burnt_in_rapids", "m^3", shown_in=FINDINGS, says="what the beam took on its way"),
    )

    beam: BeamKeys

    @classmethod
    def of(cls, tool: Engraver, material: Any) -> Engraving:
        return cls(beam=tool.beam)

    @property
    def zone(self) -> Zone:
        return Zone(radius=0.5 * self.beam.spot, below=self.beam.focus + MOST_LOWERED)

    def begin(self) -> ProcessState:
        return ProcessState(values=np.zeros(1))

    def run(self, stock: Any, window: Window, state: ProcessState) -> ProcessStep:
        share = np.clip(window.signals[SPINDLE.name] / self.beam.full_speed, 0.0, 1.0)
        power = share * self.beam.power
        lit = power[window.piece_step] > 0.0
        step = window.piece_step[lit]
        lowered = np.clip(window.signals[LOWERED.name], 0.0, MOST_LOWERED)
        down = (self.beam.focus + lowered[step])[:, None] * window.axis[step]
        found = stock.remove(
            window.piece_start[lit] - down,
            window.piece_end[lit] - down,
            cylinder(self.beam.spot, 0.0, self.beam.depth),
        )
        removed = np.zeros(window.steps)
        np.add.at(removed, step, found.volume)
        energy = np.where(removed > 0.0, power * window.dt, 0.0)
        return ProcessStep.free(
            window.steps,
            {
                "removed": removed,
                "engaged": removed > 0.0,
                "dose": self._doses(energy, np.linalg.norm(window.velocity, axis=1) * window.dt, state),
                "burnt_energy": self.beam.absorbed * energy,
                "burnt_in_rapids": np.where(window.rapid, removed, 0.0),
            },
        )

    def _doses(self, energy: Array, way: Array, state: ProcessState) -> Array:
        """What the place under the spot has got [J/mm^2]: each bit of the way takes its share of the energy away.

        At a steady speed v this is power / (v · spot), however long the steps are.
        """
        passed = way / self.beam.spot
        kept = np.exp(-passed)
        fresh = np.where(passed > 0.0, -np.expm1(-passed) / np.where(passed > 0.0, passed, 1.0), 1.0) * energy
        doses = np.empty(len(energy))
        for k in range(len(energy)):
            state.values[0] = doses[k] = state.values[0] * kept[k] + fresh[k]
        return doses / (self.beam.spot**2 / SQUARE_MM)

    @classmethod
    def findings(cls, rows: Rows) -> Iterator[Diagnostic]:
        burnt = rows["burnt_in_rapids"]
        for event in rows.events(burnt > 0.0):
            first, taken = int(event[0]), float(burnt[event].sum()) / 1e-9
            yield Diagnostic(
                code="ENGRAVER-101",
                message=f"{rows.tool_name(first)} burns {taken:.2f} mm³ during a rapid move; 0 mm³ are wanted",
                span=rows.span(first),
                hint="switch the beam off with `M5` before the move",
                count=len(event),
                time=float(rows.time[first]),
                value=taken,
                limit=0.0,
                unit="mm^3",
            )
