"""Windows of several channels whose tools come near each other: cut together, in the order of their steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.executor.weave_kernels import spells_of

if TYPE_CHECKING:
    from gcodesim.executor.ahead import WindowCut

Boxes = NDArray[np.float64]


class Weave:
    """One window of each channel, each of one stretch; nothing is cut before `cut`.

    Where tools are near each other, all that counts is the order of steps: first the first step of every channel, then
    the second. A tool may go on alone as long as it acts nowhere where another one has acted, or has yet to act,
    before it.
    """

    def __init__(self, cuts: Sequence[WindowCut]) -> None:
        self.cuts = cuts
        self._stretches = [cut.stretches[0] for cut in cuts]
        self._undo: list[Callable[[], None]] = []

    @staticmethod
    def fits(cuts: Sequence[WindowCut]) -> bool:
        """Whether these windows can be cut together: their steps may be run in parts, and no tool changes in them.

        What the machine itself comes to is looked at once for the whole window, so nothing may grow meanwhile.
        """
        if any(len(cut.stretches) != 1 or not cut.stretches[0].divisible for cut in cuts):
            return False
        watched = any(cut.stretches[0].watch is not None for cut in cuts)
        return not (watched and any(stint.task.process.lays for cut in cuts for stint in cut.stints))

    @property
    def is_cut(self) -> bool:
        """Whether all has been cut; if not after `cut`, because a body of a machine would be in a stock."""
        return all(cut.wrenches for cut in self.cuts)

    def cut(self, *, undoable: bool) -> None:
        """Cut all windows, unless a body of a machine meets a stock in them: that goes by smaller steps."""
        sightings = [stretch.look() for stretch in self._stretches]
        if any(seen is not None and seen.meets for seen in sightings):
            return
        if undoable:
            self._undo = [stretch.save() for stretch in self._stretches]
        at = [0] * len(self.cuts)
        for channel, end in self._spells().tolist():
            self._stretches[channel].advance(at[channel], end)
            at[channel] = end
        for cut, stretch in zip(self.cuts, self._stretches, strict=True):
            cut.wrenches.append(stretch.felt)
            stretch.settle()

    def take_back(self) -> None:
        """Undo all of it."""
        while self._undo:
            self._undo.pop()()
        for cut, stretch in zip(self.cuts, self._stretches, strict=True):
            cut.wrenches.clear()
            cut.work = None
            if stretch.watch is not None:
                stretch.watch.forget()

    def _spells(self) -> NDArray[np.int64]:
        """Who cuts next (m,), and up to which of its steps."""
        low, high = self._boxes()
        channels, _, steps = low.shape[:3]
        spells = np.empty((channels * steps, 2), dtype=np.int64)
        return spells[: spells_of(low, high, np.zeros(channels, dtype=np.int64), spells)]

    def _boxes(self) -> tuple[Boxes, Boxes]:
        """Corners (channels, stocks, steps, 3) of boxes that contain all on which a channel may act in a step."""
        stints = [[stint for stint in cut.stints if stint.holds] for cut in self.cuts]
        names = list(dict.fromkeys(name for own in stints for stint in own for name in stint.holds))
        shape = len(self.cuts), len(names), len(self._stretches[0]), 3
        low, high = np.full(shape, np.inf), np.full(shape, -np.inf)
        for channel, own in enumerate(stints):
            for stint in own:
                least, most = stint.bounds_by_step
                for name, X in stint.holds.items():
                    at = channel, names.index(name)
                    lowest, highest = X.inverse().box(least, most)
                    low[at], high[at] = np.minimum(low[at], lowest), np.maximum(high[at], highest)
        return low, high
