"""The world without dynamics: joints are where they are commanded to be; efforts follow from Newton and Euler."""

from __future__ import annotations

import numpy as np

from gcodesim.frames import Array, Pose
from gcodesim.kinematics.dynamics import inverse_dynamics
from gcodesim.world.body import RobotBody, ToolBody
from gcodesim.world.payload import payload_of
from gcodesim.world.protocol import STANDARD_GRAVITY, Couple, WorldSteps
from gcodesim.world.reaction import tool_reaction
from gcodesim.world.state import WorldBase, wrench_rows


class KinematicWorld(WorldBase):
    """Follows every command exactly and says what effort that takes; see `gcodesim.world.protocol.World`."""

    may_lag = False
    keeps_to_command = True

    def __init__(
        self,
        robot: RobotBody,
        step_ns: int,
        *,
        gravity: tuple[float, float, float] = STANDARD_GRAVITY,
    ) -> None:
        super().__init__(robot, step_ns, gravity=gravity)
        self._limit = robot.effort_limit
        self._q = np.zeros(self.joint_count)
        self._qd = np.zeros(self.joint_count)

    def reset(self, q: Array) -> None:
        """Stand still at joint vector `q` (j,)."""
        self._q, self._qd = self._joint_vector(q), np.zeros(self.joint_count)

    def go_on(self, q: Array, qd: Array) -> None:
        """Be at joint vector `q` (j,) with speeds `qd` (j,) at the end of the last step."""
        self._q, self._qd = self._joint_vector(q), self._joint_vector(qd)

    def attach(self, tool: ToolBody | None, pocket: Pose | None = None) -> None:
        """Change the tool; see `World.attach`."""
        self._exchange(tool, pocket)

    def run(self, q_command: Array, couple: Couple | Array | None = None) -> WorldSteps:
        """Move through `q_command` (n, j); see `World.run`. `couple` is called once, with all rows."""
        q = self._commands(q_command).copy()
        n = len(q)
        path = np.vstack([self._q, q])
        speed = np.vstack([self._qd, np.diff(path, axis=0) / self.dt])
        qd, qdd = speed[1:], np.diff(speed, axis=0) / self.dt
        wrench = np.zeros((n, 6)) if couple is None else wrench_rows(couple, 0, q)
        effort = inverse_dynamics(
            self.robot.chain,
            q,
            qd,
            qdd,
            payload_of(self.tool),
            wrench,
            p_FT=np.zeros(3) if self.tool is None else self.tool.X_FT.p,
            gravity=self.gravity_B,
        )
        reaction = tool_reaction(self.machine, self.tool, path, speed, wrench, self.gravity_B, self.dt)
        if n:
            self._q, self._qd = q[-1].copy(), qd[-1].copy()
        return WorldSteps(q=q, qd=qd, qdd=qdd, effort=effort, saturated=np.abs(effort) > self._limit, reaction=reaction)

    def keeps_up(self, q_command: Array, wrench: Array) -> bool:
        """Always true: this world follows every command."""
        return True

    def close(self) -> None:
        """Does nothing; there is nothing to free."""
