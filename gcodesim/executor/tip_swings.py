"""Where the tip of a machine swings on its gears while it cuts, so far that it goes back against its command."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots
from gcodesim.frames import Array

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord

STRETCH: Final = 0.2
"""[s] of cutting that are judged together: gears of arms swing some times in it."""

SHARE: Final = 0.1
"""Of the steps of a stretch, from which on a tip that goes back in them chatters."""


@dataclass(slots=True, eq=False)
class TipSwings:
    """Stretches of cutting, in the order of time; one with fewer steps is at the end of the cutting of a tool.

    `back` are the steps in which the tip went against its command, of `steps`; `widest` [m] how far it was from there;
    `row` the path row of its first step, `time` [s] when that began.
    """

    dt: float
    back: list[int] = field(default_factory=list)
    steps: list[int] = field(default_factory=list)
    widest: list[float] = field(default_factory=list)
    row: list[int] = field(default_factory=list)
    time: list[float] = field(default_factory=list)
    _tool: int = -1
    _last: Array = field(default_factory=lambda: np.zeros((2, 3)))

    def add(self, record: StepRecord, tips: Array) -> None:
        """Add the steps of a record; `tips` (n, 3) [m] is where they really end, base axes."""
        window = record.window
        told = window.tip[:, :3, 3]
        way, went = np.diff(told, axis=0, prepend=self._last[:1]), np.diff(tips, axis=0, prepend=self._last[1:])
        self._last = np.stack([told[-1], tips[-1]])
        changed = np.diff(window.tool, prepend=self._tool) != 0
        self._tool = int(window.tool[-1])
        cuts = record["engaged"] & record.feeds & (dots(way, way) > 0.0) & ~changed
        if not cuts.any():
            return
        at = np.flatnonzero(cuts)
        off = tips[at] - told[at]
        self._note(window.row[at], window.samples.time[at], dots(way[at], went[at]) < 0.0, np.sqrt(dots(off, off)))

    def _note(self, row: NDArray[np.int64], time: Array, back: NDArray[np.bool_], off: Array) -> None:
        whole, begin = max(round(STRETCH / self.dt), 1), 0
        while begin < len(row):
            if not self.steps or self.steps[-1] >= whole or time[begin] - self.time[-1] > 2.0 * STRETCH:
                self.back.append(0)
                self.steps.append(0)
                self.widest.append(0.0)
                self.row.append(int(row[begin]))
                self.time.append(float(time[begin]))
            end = min(begin + whole - self.steps[-1], len(row))
            self.steps[-1] += end - begin
            self.back[-1] += int(back[begin:end].sum())
            self.widest[-1] = max(self.widest[-1], float(off[begin:end].max()))
            begin = end

    def chatter(self) -> list[slice]:
        """Stretches that follow each other in which the tip chatters; at least two, else it was thrown once."""
        wild = np.array(self.back, dtype=float) > SHARE * np.array(self.steps, dtype=float)
        if not wild.any():
            return []
        edges = np.flatnonzero(np.diff(np.concatenate([[False], wild, [False]])))
        runs = zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
        return [slice(begin, end) for begin, end in runs if end - begin > 1]
