"""The windows of all channels in the order in which they are cut."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from itertools import combinations

import numpy as np

from gcodesim.executor.ahead import WindowCut
from gcodesim.executor.stint import Stint
from gcodesim.executor.track import Track
from gcodesim.executor.weave import Weave
from gcodesim.executor.window import Ints
from gcodesim.processes.gripping import GRIP


class Windows:
    """The windows of all tracks from tick `first` of a leg on, in the order of cutting; `steps` are the ticks of each.

    Where tools come near each other in one target, the windows of these steps are cut together, or are divided, so that
    cuts go by steps: otherwise it does not matter who cuts first.
    """

    def __init__(self, tracks: Sequence[Track], first: int, steps: Iterable[Ints]) -> None:
        self._tracks, self._steps = tracks, iter(steps)
        self._carries = [track.carry(first) for track in tracks]
        self._divided: list[Ints] = []
        self._now: list[tuple[Track, WindowCut]] = []
        self._ticks: Ints = np.zeros(0, dtype=np.int64)
        self._restore: Callable[[], None] = _do_nothing

    def __iter__(self) -> Iterator[tuple[Track, WindowCut]]:
        return self

    def __next__(self) -> tuple[Track, WindowCut]:
        while not self._now:
            self._ticks = self._divided.pop() if self._divided else next(self._steps)
            cuts = self._cuts()
            if not self._come_near(cuts):
                pass
            elif Weave.fits(cuts) and all(track.world.keeps_to_command for track in self._tracks):
                weave = Weave(cuts)
                for cut in cuts:
                    cut.weave = weave
            else:
                self.divide()
                continue
            self._now = list(zip(self._tracks, cuts, strict=True))
        return self._now.pop(0)

    def divide(self) -> None:
        """Go on with the first half of the steps that came last, then with the second; none of them has been run."""
        ticks, half = self._ticks, len(self._ticks) // 2
        self._restore()
        self._now.clear()
        self._divided += [ticks[half:], ticks[: half + 1]]

    def _cuts(self) -> list[WindowCut]:
        tracks, carries, last = self._tracks, self._carries, len(self._tracks) - 1
        if last:
            self._restore = self._saved()
        windows = [track.window(self._ticks, carry) for track, carry in zip(tracks, carries, strict=True)]
        for track, window in zip(tracks, windows, strict=True):
            for other, theirs in zip(tracks, windows, strict=True):
                if other is not track:
                    window.others[other.shop.name], window.others_begin[other.shop.name] = theirs.q, theirs.q_begin
        both = zip(tracks, windows, strict=True)
        return [track.cut(window, looks=number == last) for number, (track, window) in enumerate(both)]

    def _come_near(self, cuts: Sequence[WindowCut]) -> bool:
        return len(self._ticks) > 2 and any(_near(one, other) for one, other in combinations(cuts, 2))

    def _saved(self) -> Callable[[], None]:
        """Remember how far the windows are; calling the result restores it."""
        kept, tracks = [copy(carry) for carry in self._carries], [track.save() for track in self._tracks]

        def restore() -> None:
            self._carries = kept
            for track in tracks:
                track()

        return restore


def _do_nothing() -> None:
    """Nobody divides the windows of a single track."""


def _grips(stint: Stint) -> bool:
    """Whether a gripper closes or opens in these steps."""
    return bool(np.ptp(stint.window.signals[GRIP.name]))


def _near(one: WindowCut, other: WindowCut) -> bool:
    """Whether processes of two channels may act at one place of a target in these windows."""
    return any(_meet(a, b) for a in one.stints for b in other.stints)


def _meet(a: Stint, b: Stint) -> bool:
    if a.parts is not None and b.parts is not None:  # who takes or lets go may meet the other one
        return any(_grips(own) for own in (a, b))
    if (a.parts is not None and b.anew is not None and _grips(a)) or (
        b.parts is not None and a.anew is not None and _grips(b)
    ):  # what the one acts on may go away with the other
        return True
    both = a.holds.keys() & b.holds.keys()
    if not both:
        return False
    if a.anew is not None or a.task.process.zone.everywhere or b.task.process.zone.everywhere:
        return True
    name = min(both)
    (low, high), (least, most) = (own.holds[name].inverse().box(*own.bounds) for own in (a, b))
    return bool((low < most).all() and (high > least).all())
