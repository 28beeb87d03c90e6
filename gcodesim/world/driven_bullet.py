"""A robot with a controller in PyBullet: Bullet moves the links, under the torques that the gears hand on to them."""

from __future__ import annotations

from typing import Any

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.frames import Array, Pose
from gcodesim.world.body import RobotBody, ToolBody
from gcodesim.world.bullet import BulletWorld, import_pybullet
from gcodesim.world.driven import DrivenWorld
from gcodesim.world.protocol import STANDARD_GRAVITY


class DrivenBulletWorld(DrivenWorld):
    """See `DrivenWorld`. Bullet takes one of its steps for each part of a step, unless steps are swung at once."""

    require = staticmethod(import_pybullet)

    def __init__(
        self, robot: RobotBody, step_ns: int, *, gravity: tuple[float, float, float] = STANDARD_GRAVITY
    ) -> None:
        self._links = BulletWorld(robot, step_ns, gravity=gravity)
        super().__init__(robot, step_ns, gravity=gravity)
        self._links.take_torques(self.dt / self._parts)

    def attach(self, tool: ToolBody | None, pocket: Pose | None = None) -> None:
        """Change the tool; see `DrivenWorld.attach`."""
        self._links.attach(tool, pocket)
        self._links.take_torques(self.dt / self._parts)
        super().attach(tool, pocket)

    def _placed(self) -> None:
        self._links.put(self._state.q, self._state.qd)

    def _run_known(self, commands: Array, wrench: Array, outcome: Any) -> None:
        from gcodesim.world.drive_kernels import feed_forward, weigh
        from gcodesim.world.foresight_kernels import next_aim, note_outcome

        effort = np.empty(self.joint_count)
        for k in range(len(commands)):
            next_aim(commands[k], self.dt, self._aim, self._mean)
            weigh(self._body, self._state, self._room)
            feed_forward(self.dt, self._drives, self._aim, self._state, self._room)
            self._go(wrench[k], effort)
            note_outcome(k, self._state, self._room, effort, outcome)

    def _go(self, wrench: Array, effort: Array) -> None:
        """Motors and gears as foreseen for each part; their torques and the process act on Bullet's links."""
        from gcodesim.world.drive_kernels import part_step

        state, room, h = self._state, self._room, self.dt / self._parts
        push = applied(np.ascontiguousarray(room.jacobian.T), wrench)
        rigid = self._drives.gear == 0.0
        effort[:] = 0.0
        for part in range(self._parts):
            part_step(part, h, self.dt, self._drives, self._aim, state, wrench, room, False)
            effort += room.motor / self._parts
            state.q[:], state.qd[:] = self._links.under_torques(room.shaft + push)
            state.theta[rigid], state.thetad[rigid] = state.q[rigid], state.qd[rigid]

    def close(self) -> None:
        """Disconnect from Bullet."""
        self._links.close()
