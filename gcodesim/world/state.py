"""State that both worlds keep: the robot, the tool, the tools in their pockets, the step."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from gcodesim.arithmetic.matrices import applied
from gcodesim.frames import Array, Pose
from gcodesim.kinematics.machine import Machine
from gcodesim.world.body import RobotBody, ToolBody
from gcodesim.world.protocol import Couple


class WorldBase:
    """State that does not depend on how a world moves its robot."""

    tells_efforts = True

    def __init__(self, robot: RobotBody, step_ns: int, *, gravity: tuple[float, float, float]) -> None:
        self.robot = robot
        self.step_ns = step_ns
        self.dt = step_ns * 1e-9
        self.gravity = np.array(gravity, dtype=float)
        self.gravity_B = applied(robot.X_WB.R.T, self.gravity)
        self.machine = Machine(chain=robot.chain)
        self.joint_count = len(robot.chain.driven)
        self._tool: ToolBody | None = None
        self._parked: dict[str, tuple[ToolBody, Pose]] = {}

    @property
    def tool(self) -> ToolBody | None:
        """The tool on the flange."""
        return self._tool

    @property
    def parked(self) -> Mapping[str, tuple[ToolBody, Pose]]:
        """Tools that were taken off, by name, with the pose of their flange side (F) in W."""
        return MappingProxyType(self._parked)

    def _exchange(self, tool: ToolBody | None, pocket: Pose | None) -> None:
        """Record the change: the old tool goes into its pocket, the new one comes out of its own."""
        if self._tool is not None and pocket is not None:
            self._parked[self._tool.name] = (self._tool, pocket)
        if tool is not None:
            self._parked.pop(tool.name, None)
        self._tool = tool

    def _joint_vector(self, q: Array) -> Array:
        q = np.array(q, dtype=float)
        if q.shape != (self.joint_count,):
            raise ValueError(f"a joint vector of shape {q.shape} for {self.joint_count} joints")
        return q

    def _commands(self, q_command: Array) -> Array:
        q = np.ascontiguousarray(q_command, dtype=float)
        if q.ndim != 2 or q.shape[1] != self.joint_count:
            raise ValueError(f"commands of shape {q.shape} for {self.joint_count} joints")
        return q


def wrench_rows(couple: Couple | Array, first: int, q: Array) -> Array:
    """The wrench (m, 6) that `couple` gives for the rows from `first` on; ValueError when its shape is wrong."""
    wrench = couple(first, q) if callable(couple) else couple[first : first + len(q)]
    wrench = np.asarray(wrench, dtype=float)
    if wrench.shape != (len(q), 6):
        raise ValueError(f"the process gave a wrench of shape {wrench.shape} for {len(q)} steps")
    return wrench


def reaction_of(couple: Couple, k: int, q_before: Array, q_free: Array, response: Array) -> Array:
    """The wrench (6,) in step `k`: of a process that reacts as `Reacting` says, else at the joints `q_free`."""
    react = getattr(couple, "react", None)
    if react is None:
        row: Array = wrench_rows(couple, k, q_free[None])[0]
        return row
    wrench: Array = np.asarray(react(k, q_before, q_free, response), dtype=float)
    if wrench.shape != (6,):
        raise ValueError(f"the process gave a wrench of shape {wrench.shape} for one step")
    return wrench
