"""How far the tip was off its path while it fed: accuracy of the path in the words of ISO 9283."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.executor.accuracy_kernels import to_chords
from gcodesim.frames import Array

if TYPE_CHECKING:
    from gcodesim.executor.record import StepRecord

BEHIND: Final = 64
"""Steps by which a tip may be behind its command and still be compared with the place that it was told then."""


@dataclass(slots=True, eq=False)
class PathAccuracy:
    """Distances of the tip from the commanded path, over the steps in which a tool feeds.

    ISO 9283:1998, 8.2: AT is the greatest distance between the commanded path and the mean of the attained ones; equal
    runs are equal here, so that one is their mean and the repeatability RT is zero. A tip that is late
    on its path is not off it. `greatest` [m], in path row `row` at `time` [s]; `cutting` is the greatest distance
    while a process was engaged.
    """

    greatest: float = 0.0
    row: int = -1
    time: float = 0.0
    cutting: float = 0.0
    sum_of_squares: float = 0.0
    count: int = 0
    _before: Array = field(default_factory=lambda: np.zeros((0, 3)))
    _tool: int = -1

    @property
    def mean(self) -> float:
        """Root of the mean square distance [m]."""
        return float(np.sqrt(self.sum_of_squares / self.count)) if self.count else 0.0

    def add(self, record: StepRecord, tips: Array) -> None:
        """Add the steps of a record; `tips` (n, 3) [m] is where they really end, base axes."""
        window = record.window
        told = window.tip[:, :3, 3]
        changes = np.flatnonzero(np.diff(window.tool, prepend=self._tool) != 0)
        for begin, end in zip([0, *changes], [*changes, len(record)], strict=True):
            if begin == end:
                continue
            if begin in changes:
                self._before, self._tool = np.zeros((0, 3)), int(window.tool[begin])
            way = np.concatenate([self._before, told[begin:end]])
            off = distances(tips[begin:end], way, len(self._before))
            self._before = way[-BEHIND:].copy()
            self._note(record, begin, off)

    def _note(self, record: StepRecord, begin: int, off: Array) -> None:
        here = slice(begin, begin + len(off))
        rows = record.window.row[here]
        feeds = record.feeds[here]
        if not feeds.any():
            return
        off = np.where(feeds, off, 0.0)
        self.sum_of_squares += float((off * off).sum())
        self.count += int(feeds.sum())
        self.cutting = max(self.cutting, float(np.where(record["engaged"][here], off, 0.0).max()))
        worst = int(off.argmax())
        if off[worst] > self.greatest:
            self.greatest, self.row = float(off[worst]), int(rows[worst])
            self.time = float(record.window.samples.time[begin + worst])


def distances(points: Array, way: Array, first: int) -> Array:
    """Distance (n,) [m] of each point (n, 3) from the last `BEHIND` chords of a way (first + n, 3) before its end."""
    nearest = np.empty(len(points))
    to_chords(np.ascontiguousarray(points), np.ascontiguousarray(way), first, BEHIND, nearest)
    return nearest
