"""The moments at which the log looks at steps of several ticks: as often as it wants, without ending a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.distinct import distinct
from gcodesim.frames import Array
from gcodesim.frozen import frozen

if TYPE_CHECKING:
    from gcodesim.motion.trajectory import Samples
    from gcodesim.planning import Plan

Ints = NDArray[np.int64]


@frozen(eq=False)
class Looks:
    """m moments in a window: `ticks` (m,) of the clock, each in step `step` (m,), of which `share` (m,) is over then.

    `samples` of the trajectory, commanded joints `q` (m, j) and commanded tips `tip` (m, 4, 4), X_BT, at these moments;
    `q_before` and `tip_before` one tick before, `dt` [s] long.
    """

    ticks: Ints
    step: Ints
    share: Array
    samples: Samples
    q: Array
    tip: Array
    q_before: Array
    tip_before: Array
    dt: float

    @property
    def at_ends(self) -> NDArray[np.bool_]:
        """Which of them (m,) are at the end of a step."""
        ends: NDArray[np.bool_] = self.share == 1.0
        return ends


def looks_of(plan: Plan, ticks: Ints, row: Ints, period: int, dt_ns: int) -> Looks:
    """The looks, at multiples of `period` ticks, at steps between `ticks` (n + 1,) of `dt_ns` in rows `row` (n,)."""
    looked = np.arange(ticks[0] // period + 1, ticks[-1] // period + 1, dtype=np.int64) * period
    step = np.searchsorted(ticks, looked) - 1
    share = (looked - ticks[step]) / (ticks[step + 1] - ticks[step])
    asked = distinct(np.concatenate([looked - 1, looked]))
    samples = plan.trajectory.sample((asked * dt_ns).astype(float) * 1e-9)
    q = plan.joints(samples)
    now, before = np.searchsorted(asked, looked), np.searchsorted(asked, looked - 1)
    return Looks(
        ticks=looked,
        step=step,
        share=share,
        samples=samples.at(now),
        q=q[now],
        tip=plan.tip(q[now], row[step]),
        q_before=q[before],
        tip_before=plan.tip(q[before], row[step]),
        dt=dt_ns * 1e-9,
    )
