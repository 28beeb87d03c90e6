"""Cuts that may part their stock: what comes loose falls out of it with the very step that frees it.

A window of steps is cut at once. If something has come loose in it, the cut is undone and halved until the step is
known; then the piece is taken out of the stock, and the rest of the window goes on without it.
"""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import dots, norms
from gcodesim.executor.targets import AssemblyTarget, StockTarget
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.processes.column import ADDED
from gcodesim.processes.window import ProcessStep, Window

if TYPE_CHECKING:
    from gcodesim.executor.targets import Bounds
    from gcodesim.executor.tasks import Task
    from gcodesim.material.kernels import BodyWays
    from gcodesim.material.loose import Kept, PartedPiece, Parting

YIELDS: Final = 1e-3
"""How far [m] a cut may be beside the way that was commanded: more than any arm yields."""


@frozen(kw_only=False, eq=False)
class Freed:
    """A piece of the stock `name` that the path row `row` has cut loose, in a step of a window.

    What cut it acts within `radius` [m] of its axis.
    """

    name: str
    step: int
    row: int
    piece: PartedPiece
    radius: float = 0.0


class Freeing:
    """What one task frees during the steps of a window; `row` (c,) is the path row of each of its pieces."""

    def __init__(self, task: Task, window: Window, row: NDArray[np.int64]) -> None:
        self._task, self._window, self._row = task, window, row
        self._partings = _partings_of(task)
        self._kept: list[Kept] | None = None
        self.freed: list[Freed] = []

    def run(self, begin: int, end: int) -> ProcessStep:
        """Let the process act in steps `begin` to `end`, which come in order.

        What it frees on its way is in `freed` and no longer in the stock.
        """
        if not self._may_part():
            answer = self._act(begin, end)
            if self._task.process.lays and answer[ADDED.name].any():
                for _, _, parting in self._partings:
                    parting.off = True  # prints lie in several pieces
            return answer
        done: list[ProcessStep] = []
        at = begin
        while at < end:
            at = self._act_until_parted(at, end, done)
        return ProcessStep.joined(done)

    def begin(self) -> None:
        """Call before the first step where the steps are run one by one; nothing is undone then."""
        if self._may_part():
            self._kept = self._keep(0, self._window.steps)

    def end(self) -> None:
        """Call after the last of these steps: what came loose is ascribed to the last one that passed by."""
        if self._kept is not None:
            self._take_out(self._kept, None)
            self._kept = None

    def _may_part(self) -> bool:
        if not (self._partings and self._task.process.takes):
            return False
        lowest, from_above = self._reach
        may = [
            own.may_part(lowest - X.p[2], from_above=from_above and bool(X.R[2, 2] == 1.0))
            for _, X, own in self._partings
        ]  # each is told
        return any(may)

    def _keep(self, begin: int, end: int) -> list[Kept]:
        """What every stock may lose in steps `begin` to `end`."""
        return [own.keep(self._ways(begin, end, X.inverse())) for _, X, own in self._partings]

    @cached_property
    def _reach(self) -> tuple[float, bool]:
        """How low [m] the tip may come in this window, and whether it takes all that stood above."""
        window, process = self._window, self._task.process
        lowest = float(np.minimum(window.piece_start, window.piece_end)[:, 2].min(initial=np.inf))
        if window.compliance is not None or not process.by_path:  # the tip may come deeper than it was told to
            lowest -= YIELDS
        return lowest, process.from_above(window)

    def _act(self, begin: int, end: int) -> ProcessStep:
        task, window = self._task, self._window
        part = window if (begin, end) == (0, window.steps) else window.part(begin, end)
        if task.process.lays and isinstance(task.target, AssemblyTarget):
            return task.target.given.laid(partial(task.process.run, window=part, state=task.state))
        return task.process.run(task.target.given, part, task.state)

    def _act_until_parted(self, at: int, end: int, done: list[ProcessStep]) -> int:
        """Go on from step `at` to `end`, or to the step in which something comes loose; the first step after that."""
        state = self._task.state.values
        low, high = at, end
        parts = False  # whether it is known that something comes loose before `high`
        while True:
            middle = high if not parts or high - low == 1 else (low + high) // 2
            kept, before = self._keep(low, middle), state.copy()
            answer = self._act(low, middle)
            owners = list(zip(self._partings, kept, strict=True))
            if all(parting.parted(own) is None for (_, _, parting), own in owners):
                done.append(answer)
                low = middle
                if low == high:
                    return high
            elif middle - low == 1:
                done.append(answer)
                self._take_out(kept, low)
                return middle
            else:
                for (_, _, parting), own in owners:
                    parting.put_back(own)
                state[:] = before
                parts, high = True, middle

    def _take_out(self, kept: list[Kept], step: int | None) -> None:
        radius = float(self._task.process.zone.radius)
        for (name, X, parting), own in zip(self._partings, kept, strict=True):
            parted = parting.parted(own)
            for piece in [] if parted is None else parting.take_out(parted):
                at, row = self._passing(*X.box(piece.low, piece.high), step)
                self.freed.append(Freed(name, at, row, piece, radius))

    def _passing(self, low: Array, high: Array, step: int | None) -> tuple[int, int]:
        """The step (if it is not known) and the path row of the last way that came nearest to a piece in a box."""
        window = self._window
        own = np.arange(len(self._row)) if step is None else np.flatnonzero(window.piece_step == step)
        if not len(own):
            return step or 0, int(self._row[-1]) if len(self._row) else 0
        middle = np.clip(0.5 * (window.piece_start[own] + window.piece_end[own]), low, high)
        way, start = window.piece_end[own] - window.piece_start[own], window.piece_start[own]
        length = np.maximum(dots(way, way), 1e-30)
        share = np.clip(dots(middle - start, way) / length, 0.0, 1.0)
        gap = norms(start + share[:, None] * way - middle)
        last = int(own[np.flatnonzero(gap <= gap.min() + 1e-9)[-1]])
        return int(window.piece_step[last]), int(self._row[last])

    def _ways(self, begin: int, end: int, X: Pose) -> BodyWays:
        """Where the process may take material in steps `begin` to `end`, seen from a stock from which S is at `X`."""
        from gcodesim.material.kernels import BodyWays

        window = self._window
        first, last = np.searchsorted(window.piece_step, [begin, end])
        starts, ends = window.piece_start[first:last], window.piece_end[first:last]
        step = window.piece_step[first:last]
        axis = window.axis[step]
        before = axis if window.axis_before is None else window.axis_before[step]
        zone = self._task.process.takes_within(_depth_below(starts, ends, axis, self._task.target.room))
        ways = [X.rotate(way)[:, :2] for way in (axis, before)]
        along = np.stack([height * way for height in (zone.above, -zone.below) for way in ways])
        turn = axis - before
        bulge = max(zone.above, zone.below) * dots(turn, turn)  # a turning axis comes farther out than its chord
        across = (zone.radius + YIELDS + bulge)[:, None]
        return BodyWays(
            np.ascontiguousarray(X.apply(starts), dtype=float),
            np.ascontiguousarray(X.apply(ends), dtype=float),
            np.minimum(along.min(axis=0), 0.0) - across,
            np.maximum(along.max(axis=0), 0.0) + across,
        )


def _partings_of(task: Task) -> tuple[tuple[str, Pose, Parting], ...]:
    if not (task.process.takes or task.process.lays) or not isinstance(task.target, StockTarget):
        return ()
    return task.target.partings


def _depth_below(starts: Array, ends: Array, axis: Array, room: Bounds | None) -> float:
    """How far beyond a tip, along its axis (c, 3), the farthest corner of a box lies [m]."""
    if room is None or not len(starts):
        return np.inf
    low, high = (np.where(np.isfinite(corner), corner, 0.0) for corner in room)
    corner = np.where(axis > 0.0, low, high)
    return float(max(dots(starts - corner, axis).max(), dots(ends - corner, axis).max()))
