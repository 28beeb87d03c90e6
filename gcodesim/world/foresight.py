"""Where a robot with ideal motors will end a step, and how it will give way, before the step is made.

A motor that can holds its joint on the command, whatever acts; one at its limit gives all it can, and its joint moves
as masses, gravity and process let it. Asking the process first and moving then, with what it felt one step ago, bounces
as soon as a cut resists its own speed more than a mass does in one step.
"""

from __future__ import annotations

import numpy as np

from gcodesim.arithmetic.matrices import multiplied
from gcodesim.frames import Array
from gcodesim.kinematics.chain import Chain
from gcodesim.kinematics.dynamics import bodies
from gcodesim.kinematics.dynamics_kernels import MovedBodies
from gcodesim.world.body import ToolBody
from gcodesim.world.drive_kernels import (
    PLACED,
    Aim,
    Drives,
    DriveState,
    LinkBodies,
    placed_speed,
    room_of,
    weigh,
)
from gcodesim.world.foresight_kernels import foresee
from gcodesim.world.model import LEAST_INERTIA, LEAST_MASS
from gcodesim.world.payload import payload_of


def links_of(chain: Chain, tool: ToolBody | None, gravity_B: Array) -> LinkBodies:
    """The links of a robot with `tool` on the flange, as the kernels take them; none is without mass."""
    moved = bodies(chain, payload_of(tool))
    light = LEAST_INERTIA * np.eye(3)
    X_FT = np.eye(4) if tool is None else tool.X_FT.matrix
    return LinkBodies(
        gravity=np.array(gravity_B, dtype=float),
        moved=MovedBodies(
            np.array([b.mass if b.mass > 0.0 else LEAST_MASS for b in moved], dtype=float),
            np.array([b.com for b in moved]),
            np.array([b.inertia if b.mass > 0.0 else light for b in moved]),
        ),
        tree=chain.tree,
        tip=np.ascontiguousarray(multiplied(chain.tree.flange_offset, X_FT)),
    )


class Foresight:
    """For one robot with one tool: steps of `dt` [s] with motors of `limit` (j,)."""

    def __init__(self, chain: Chain, tool: ToolBody | None, gravity_B: Array, limit: Array, dt: float) -> None:
        j = len(limit)
        zero = np.zeros(j)
        self._dt, self._body, self._room = dt, links_of(chain, tool, gravity_B), room_of(j, 1)
        self._drives = Drives(PLACED, zero, zero, zero, np.array(limit, dtype=float), zero, zero, zero, zero, False)

    def of(self, q: Array, qd: Array, before: Array, command: Array, wrench: Array) -> tuple[Array, Array, Array]:
        """For joints at `q`, `qd` (j,), commanded from `before` to `command`, with `wrench` (6,) in the step before.

        Returns where they end without a wrench (j,), how the tip moves under one (6, 6), and where motors that are late
        are to go (j,): they catch up so that they can brake.
        """
        zero = np.zeros(len(q))
        state, aim = DriveState(q, qd, q.copy(), qd.copy(), zero), Aim(before, command, zero, zero, zero)
        room, free = self._room, np.empty(len(q))
        weigh(self._body, state, room)
        room.wind[:] = 0.0
        foresee(self._dt, self._dt, self._drives, aim, state, wrench, room, free)
        speed = [
            placed_speed(i, self._drives, state, float(before[i]), float(command[i]), self._dt, room)
            for i in range(len(q))
        ]
        return free, room.response.copy(), q + self._dt * np.array(speed)
