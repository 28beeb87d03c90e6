"""The world of those who ask for places alone: joints are where they are commanded to be, and nothing else is told."""

from __future__ import annotations

import numpy as np

from gcodesim.frames import Array
from gcodesim.world.kinematic import KinematicWorld
from gcodesim.world.protocol import Couple, WorldSteps
from gcodesim.world.state import wrench_rows


class CommandedWorld(KinematicWorld):
    """Follows every command; speeds, efforts and reactions are zero."""

    tells_efforts = False

    def run(self, q_command: Array, couple: Couple | Array | None = None) -> WorldSteps:
        """Move through `q_command` (n, j); see `World.run`. `couple` is called once, with all rows."""
        q = self._commands(q_command)
        if couple is not None:
            wrench_rows(couple, 0, q)
        none = np.zeros(q.shape)
        return WorldSteps(
            q=q, qd=none, qdd=none, effort=none, saturated=np.zeros(q.shape, dtype=bool), reaction=np.zeros((len(q), 6))
        )
