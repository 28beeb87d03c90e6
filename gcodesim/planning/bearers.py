"""Where work is that stands on what the program of another channel moves, by the common clock of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gcodesim.arithmetic.matrices import inverse_pose, multiplied
from gcodesim.frames import Array, Pose
from gcodesim.frozen import frozen
from gcodesim.planning.borne_work import BorneWork

if TYPE_CHECKING:
    from gcodesim.planning.plan import Plan
    from gcodesim.scene import Scene


@frozen(eq=False)
class Bearers:
    """The links that bear the work systems of a program, `links` by system, and the plans of those who move them.

    `zero` is X_WC of each link with the axes under it at zero. A link whose mover has no plan in `plans` (by the
    names of movers) stays at home.
    """

    scene: Scene
    links: Mapping[int, str]
    zero: Mapping[str, Pose]
    plans: Mapping[str, Plan]

    def moved(self, system: int, time: Array) -> Array:
        """The motion (n, 4, 4) in W by which a system has gone at times (n,) [s] from where it is with axes at zero."""
        link = self.links[system]
        plan = self.plans.get(link.partition("/")[0])
        if plan is None:
            X_WC = np.tile(self.scene.at_rest(link).matrix, (len(time), 1, 1))
        else:
            X_WC = self.scene.track(link, {link.partition("/")[0]: plan.joints(plan.trajectory.sample(time))})
        X: Array = multiplied(X_WC, self.zero[link].inverse().matrix)
        return X

    def carried(self, X_WP: Array, systems: NDArray[np.int64], time: Array) -> Array:
        """Poses (n, 4, 4) in W, given for axes at zero, as these systems (n,) are moved at times (n,) [s]."""
        X = X_WP.copy()
        for system in self.links:
            here = systems == system
            if here.any():
                X[here] = multiplied(self.moved(system, time[here]), X_WP[here])
        return X

    def after_waits(self, ends: Sequence[float], X_WB: Pose) -> BorneWork:
        """The work as an arm with its base at `X_WB` finds it at the start and when each of its waits `ends` [s]."""
        time = np.array([0.0, *ends])
        return BorneWork(moved={system: self._in_base(system, time, X_WB) for system in self.links})

    def _in_base(self, system: int, time: Array, X_WB: Pose) -> Array:
        """The motion (n, 4, 4) of a system in B; what has not moved is so exactly."""
        order = np.argsort(time, kind="stable")
        X_W = np.empty((len(time), 4, 4))
        X_W[order] = self.moved(system, time[order])
        X: Array = multiplied(inverse_pose(X_WB.matrix[None]), X_W, X_WB.matrix)
        X[np.abs(X_W - np.eye(4)).max(axis=(1, 2)) < 1e-12] = np.eye(4)
        return X
