"""How much filament leaves the nozzle: what goes forward beyond what was drawn back before.

A program moves filament along with the head and while it stands. What is drawn back has to come forward again before
any leaves the nozzle, whether it does so at rest or on the way. So what leaves is by how much the sum of all E words of
a tool goes beyond the greatest that it ever had.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.canon import Extrude, ToolChange
from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.motion.pieces import Pieces
    from gcodesim.motion.tool_path import ToolPath
    from gcodesim.motion.trajectory import Samples, TimedEvent

Ints = NDArray[np.int64]

ROUNDING: Final = 1e-11
"""[m] What is less is rounding of sums of E words."""


@frozen(eq=False)
class Filament:
    """What leaves the nozzles: along each of n rows, `rows` (n,) [m], and in each of e events, `stays` (e,) [m].

    The events begin at `begin` (e,) [s], before row `event_row` (e,), and take `duration` (e,) [s].
    """

    rows: Array
    stays: Array
    begin: Array
    duration: Array
    event_row: Ints

    @staticmethod
    def of(path: ToolPath, events: Sequence[TimedEvent]) -> Filament | None:
        """What leaves the nozzles on a path with its events in order of time; None where no E word moves any."""
        steps = np.array([each.event.length if isinstance(each.event, Extrude) else 0.0 for each in events])
        if not path.extrude.any() and not steps.any():
            return None
        event_row = np.array([each.row for each in events], dtype=np.int64)
        order = np.argsort(np.concatenate([2 * np.arange(len(path)) + 1, 2 * event_row]), kind="stable")
        tool = np.concatenate([tools_of_rows(path), tools_of_events(path, events)])[order]
        length, issued = np.concatenate([path.extrude, steps])[order], np.zeros(len(order))
        for number in distinct(tool).tolist():
            mine = tool == number
            issued[mine] = beyond_retraction(length[mine])
        found = np.empty(len(order))
        found[order] = issued
        return Filament(
            rows=found[: len(path)],
            stays=found[len(path) :],
            begin=np.array([each.time for each in events]),
            duration=np.array([each.duration for each in events]),
            event_row=event_row,
        )

    def between(self, samples: Samples, pieces: Pieces) -> Array:
        """How much (n - 1,) [m] leaves the nozzle between consecutive samples (n,).

        It goes along with the way of each row, and evenly with the time of an event. Corners that were rounded give
        what they have to the rest of their rows.
        """
        in_rows = np.concatenate([[0.0], np.cumsum(self.rows)])
        in_stays = np.concatenate([[0.0], np.cumsum(self.stays)])
        until = np.zeros(len(samples))
        moves, rests = np.flatnonzero(samples.event < 0), np.flatnonzero(samples.event >= 0)
        if len(moves) and len(pieces):
            piece = samples.piece[moves]
            joint, end = pieces.joint[piece], pieces.row_last[piece].astype(np.int64) + 1
            begin = np.where(joint, end - 1, pieces.row_first[piece])
            amount = np.where(joint, 0.0, in_rows[end] - in_rows[begin])
            stood = in_stays[np.searchsorted(self.event_row, begin, side="right")]
            until[moves] = in_rows[begin] + stood + amount * np.clip(samples.fraction[moves], 0.0, 1.0)
        if len(rests):
            event = samples.event[rests]
            passed = (samples.time[rests] - self.begin[event]) / np.maximum(self.duration[event], 1e-300)
            until[rests] = in_rows[self.event_row[event]] + in_stays[event]
            until[rests] += self.stays[event] * np.clip(passed, 0.0, 1.0)
        through: Array = np.diff(until)
        through[through < ROUNDING] = 0.0
        return through


def beyond_retraction(steps: Array) -> Array:
    """What leaves a nozzle (n,) [m] in steps (n,) of its filament, one after the other, drawn back where negative."""
    total = np.concatenate([[0.0], np.cumsum(steps)])
    drawn = np.maximum.accumulate(total)[:-1] - total[:-1]
    drawn[drawn < ROUNDING] = 0.0
    issued: Array = np.maximum(steps - drawn, 0.0)
    issued[issued < ROUNDING] = 0.0
    return issued


def tools_of_rows(path: ToolPath) -> Ints:
    """The tool in the spindle in each row (n,)."""
    tools: Ints = np.array([state.tool for state in path.states], dtype=np.int64)[path.state]
    return tools


def tools_of_events(path: ToolPath, events: Sequence[TimedEvent]) -> Ints:
    """The tool in the spindle at each event (e,): that of the row before, or what it was changed for since then."""
    rows = tools_of_rows(path)
    event_row = np.array([each.row for each in events], dtype=np.int64)
    first = rows[0] if len(rows) else path.states[0].tool
    tools: Ints = np.concatenate([[first], rows])[np.minimum(event_row, len(rows))]
    for k, each in enumerate(events):
        if isinstance(each.event, ToolChange):
            tools[k : np.searchsorted(event_row, each.row, side="right")] = each.event.tool
    return tools
