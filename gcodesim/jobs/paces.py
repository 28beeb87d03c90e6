"""How fast the rows of a path really run: the least speed, and for how long the programmed feed is reached."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.motion.trajectory import Trajectory

REACHED: Final = 0.99
"""Share of the programmed feed from which on it counts as reached."""


@frozen(eq=False)
class RowPaces:
    """Of each path row (n,): `least` speed [m/s] while it moves, and time `at_feed` [s] at the programmed feed."""

    least: Array
    at_feed: Array


def row_paces(trajectory: Trajectory) -> RowPaces:
    """Exact, from the time law: between the borders of phases and rows the speed is linear in time."""
    phases, feed = trajectory.phases, trajectory.path.feed
    count = len(trajectory.row_start)
    least, at_feed = np.full(count, np.inf), np.zeros(count)
    if not len(phases.time) or not count:
        return RowPaces(least=np.zeros(count), at_feed=at_feed)
    knots = distinct(np.concatenate([phases.time, [trajectory.duration], trajectory.row_start, trajectory.row_end]))
    begin, end = knots[:-1], knots[1:]
    middle = 0.5 * (begin + end)
    phase = np.clip(np.searchsorted(phases.time, middle, side="right") - 1, 0, len(phases.time) - 1)
    event = phases.event[phase]
    row = trajectory.rows_at(middle)
    moves = (event < 0) & (end - begin > 1e-12)
    begin, end, phase, row = begin[moves], end[moves], phase[moves], row[moves]
    speed, change, jerk = phases.speed[phase], phases.acceleration[phase], phases.jerk[phase]
    first, last = (
        speed + change * t + 0.5 * jerk * t * t for t in (begin - phases.time[phase], end - phases.time[phase])
    )
    low, high = np.minimum(first, last), np.maximum(first, last)
    np.minimum.at(least, row, np.maximum(low, 0.0))
    wanted = REACHED * feed[row]
    rise = high - low
    above = np.where(low >= wanted, 1.0, np.divide(high - wanted, rise, out=np.zeros(len(row)), where=rise > 0.0))
    np.add.at(at_feed, row, np.clip(above, 0.0, 1.0) * (end - begin))
    return RowPaces(least=np.where(np.isfinite(least), least, 0.0), at_feed=at_feed)
