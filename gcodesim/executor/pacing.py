"""How long the steps of a run are: each a tick of the clock, or as far as the cut along the path stays the same.

Where a world follows its command and nothing in the cell answers the motion, a step may be a stretch of path that
neither the grid of the stock nor the law of force can tell apart. It still is a whole number of ticks, so that the
clock, the log and whoever waits for something agree on every time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.executor.tasks import Only
    from gcodesim.motion.trajectory import Trajectory
    from gcodesim.planning import Plan
    from gcodesim.shop import Shop

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

BEAT: Final = 125
"""Ticks after which processes that look at a stock for many steps at once look anew, where every tick is a step."""

MOST_STEPS: Final = 16 * BEAT
"""Steps of one window: enough to spread the cost of a window, few enough to stay small in memory."""

LONGEST_CHORD: Final = 0.25e-3
"""Greatest length [m] of a piece in a feed: on a radius of 2 mm it leaves the arc by 4 um."""

MOST_PARTS: Final = 64  # of one step

LONGEST_WAY: Final = MOST_PARTS * LONGEST_CHORD
"""The longest way [m] of a step at feed: a window divides it into chords that still follow an arc."""

CHORD_OVER_TABLE: Final = 2.0 * LONGEST_CHORD
"""The longest way [m] of a step over a table that moves, where a window does not divide steps."""


@frozen
class Pacing:
    """Steps are whole numbers of ticks, `dt_ns` each.

    `reach` [m] is the longest way of the tip in a step at feed; None: every tick is a step. `pace`: a step ends with
    every multiple of so many ticks; 0: none does so. `period`: the log looks within steps, with every multiple of so
    many ticks; 0: at the ends of steps alone. `at_one_rate`: all of a step has one acceleration, since a force is asked
    of it; else a step is as much of a row as `reach` allows.

    With every multiple of `beat` ticks, or the step that comes to it, processes look at stocks anew that do so for many
    steps at once, and windows end there: so no number depends on where they do.
    """

    dt_ns: int
    reach: float | None = None
    pace: int = 0
    period: int = 0
    at_one_rate: bool = True
    beat: int = BEAT

    def windows(
        self, plan: Plan, rapid: Flags, first: int, last: int, most: int, stops: Sequence[int] = ()
    ) -> Iterator[Ints]:
        """Ticks `first` to `last` in windows of about `most` ticks: (n + 1,) for n steps, which end with [1:].

        A window ends with the first step that comes to a multiple of `most`. `rapid` are the rows of the plan's path
        that are rapids. A window of single ticks ends with each of `stops`, too.
        """
        if self.reach is None:
            whole = min(most, MOST_STEPS)
            borders = sorted({first, *range((first // whole + 1) * whole, last, whole), *stops, last})
            for begin, end in pairwise(borders):
                yield np.arange(begin, end + 1, dtype=np.int64)
            return
        ticks = self._ticks(plan.trajectory, rapid, first, last)
        at, count = 0, len(ticks) - 1
        beats = np.flatnonzero(fresh_steps(ticks, self.beat))
        while at < count:
            wanted = (int(ticks[at]) // most + 1) * most
            end = min(int(np.searchsorted(ticks, wanted)), count)
            if end > at + MOST_STEPS:
                beat = int(beats[np.searchsorted(beats, at + MOST_STEPS, side="right") - 1])
                end = beat if beat > at else at + MOST_STEPS
            yield ticks[at : end + 1]
            at = end

    def _ticks(self, trajectory: Trajectory, rapid: Flags, first: int, last: int) -> Ints:
        """`first`, and the ticks up to `last` with which a step ends: with rows and stretches of one acceleration.

        What ends within a tick ends with the tick before, so that the last tick of a step has the speed and the
        acceleration of all of it.
        """
        assert self.reach is not None
        phases, path = trajectory.phases, trajectory.path
        begin = np.rint(phases.time * 1e9).astype(np.int64) // self.dt_ns
        end = np.rint((phases.time + phases.duration) * 1e9).astype(np.int64) // self.dt_ns
        own = (end >= first) & (begin <= last)
        begin, end = begin[own], end[own]
        speed, gain = phases.speed[own], phases.acceleration[own] * phases.duration[own]
        fastest = np.maximum(np.abs(speed), np.abs(speed + gain))
        whole = np.ones(len(begin), dtype=np.int64)  # ticks of a step
        if len(path) and len(whole):
            middle = phases.time[own] + 0.5 * phases.duration[own]
            row = np.clip(trajectory.rows_at(middle), 0, len(path) - 1)
            turns = (path.start[row, 3:] != path.end[row, 3:]).any(axis=1)
            way = self.reach / np.maximum(fastest * (self.dt_ns * 1e-9), 1e-12)
            most = float(max(last - first, 1))
            whole = np.clip(np.where(rapid[row], most, way), 1.0, most).astype(np.int64)
            pieces, piece = trajectory.pieces, phases.piece[own]
            # a rapid goes along any other than a line in one chord a step, and what runs by a clock tells no way
            by_ticks = turns | pieces.are_timed[piece] | (rapid[row] & ~pieces.are_lines[piece])
            whole[by_ticks] = 1
            whole[phases.event[own] >= 0] = int(most)
            if not self.at_one_rate:
                alike = (row, phases.event[own], by_ticks)
                anew = np.flatnonzero(np.append(True, np.any([np.diff(each) != 0 for each in alike], axis=0)))
                begin, end, whole = begin[anew], np.append(begin[anew[1:]], end[-1]), np.minimum.reduceat(whole, anew)
                gain = np.zeros(len(begin))
        count = np.maximum(-(-(end - begin) // whole), 0)
        place = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        within = np.repeat(begin, count) + place * np.repeat(whole, count)
        rows = trajectory.row_ns[0] // self.dt_ns if len(path) else np.zeros(0, dtype=np.int64)
        peaks = (gain[:-1] > 0.0) & (gain[1:] < 0.0)  # at full speed for a moment only: within the tick that follows
        wanted = [within, end, end[:-1][peaks] + 1, rows, np.array([first, last])]
        if self.pace:
            wanted.append(np.arange(first // self.pace, last // self.pace + 1, dtype=np.int64) * self.pace)
        ticks = distinct(np.concatenate(wanted))
        kept: Ints = ticks[(ticks >= first) & (ticks <= last)]
        return kept


def fresh_steps(ticks: Ints, beat: int) -> Flags:
    """Which of the steps between `ticks` (n + 1,) begin with a new beat of so many ticks (n,)."""
    beats = ticks[:-1] // beat
    fresh: Flags = np.append(True, beats[1:] != beats[:-1])
    return fresh


def may_follow_path(shop: Shop, only: Only | None = None) -> bool:
    """Whether nothing in the cell answers the motion or counts its ticks, so that steps may be stretches of path.

    That is a machine tool that does not yield, no parts that move, and tools whose processes say the same however
    their path is cut into steps. `only`: what the run is about, if not all.
    """
    from gcodesim.executor.targets import targets_of
    from gcodesim.processes import PROCESSES

    mover = shop.mover
    if not mover.joints_are_axes or mover.lathe or mover.stiffness is not None:
        return False
    if shop.moves_parts:
        return False
    if only == "motion":
        return True
    processes = (
        PROCESSES[kind].of(tool, target.material)
        for tool in shop.cell.tools.values()
        for kind in tool.acts_by
        for target in targets_of(shop, PROCESSES[kind].acts_on)
    )
    return all((process.shaping if only == "shape" else process).by_path for process in processes)


def cell_reach(shop: Shop, cells: int = 1) -> float:
    """The longest way [m] of a step: so many cells of the finest stock; one is as far as the engagement looks ahead.

    Over a table that moves a step is one chord.
    """
    stocks = shop.stocks.values()
    chord = [CHORD_OVER_TABLE for placed in stocks if shop.scene.moves(placed.frame)]
    return min([LONGEST_WAY, *chord, *(cells * placed.stock.cell for placed in stocks)])
