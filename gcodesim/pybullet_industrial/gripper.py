"""Grippers: fingers with motors, and cups that hold what they touch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.pybullet_industrial.endeffector_tool import EndeffectorTool
from gcodesim.pybullet_industrial.robot_base import RobotBase

_GEAR_FORCE = 5000  # [N] that keeps the fingers together
_GEAR_ERP = 0.1


class Gripper(EndeffectorTool):
    """Fingers that move against each other: every joint after the first follows it by a gear of ratio −1."""

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        coupled_robots: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frames: str | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, coupled_robots, tcp_frame, connector_frames)
        self._actuated_joints = sorted(self._joint_name_to_index.values())
        count = p.getNumJoints(self.urdf)
        self.max_joint_force = np.full(count, 20.0)
        for index in range(count):
            p.resetJointState(self.urdf, index, targetValue=0)
        self._gripper_constraints = [self._geared(index) for index in self._actuated_joints[1:]]
        for index in self._actuated_joints:
            force = self.max_joint_force[index]
            p.setJointMotorControl2(self.urdf, index, p.VELOCITY_CONTROL, targetVelocity=0, force=force)

    def actuate(self, target: float) -> None:
        """Drive all joints to a share of their travel: 0 is the lower limit of each, 1 the upper one."""
        for index in self._actuated_joints:
            lower, upper = self._lower_joint_limit[index], self._upper_joint_limit[index]
            p.setJointMotorControl2(
                self.urdf,
                index,
                p.POSITION_CONTROL,
                force=self.max_joint_force[index],
                targetPosition=lower + (upper - lower) * target,
            )

    def _geared(self, index: int) -> int:
        first, zero = self._actuated_joints[0], [0, 0, 0]
        gear: int = p.createConstraint(
            self.urdf,
            first,
            self.urdf,
            index,
            jointType=p.JOINT_GEAR,
            jointAxis=[1, 0, 0],
            parentFramePosition=zero,
            childFramePosition=zero,
        )
        p.changeConstraint(gear, gearRatio=-1, erp=_GEAR_ERP, maxForce=_GEAR_FORCE)
        return gear


class SuctionGripper(EndeffectorTool):
    """Holds the bodies that it touches; `suction_links` names the links that do, else all of them."""

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        coupled_robots: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frames: str | None = None,
        suction_links: Sequence[str] | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, coupled_robots, tcp_frame, connector_frames)
        self.suction_constraints: list[int] = []
        self._suction_links_ids = None if suction_links is None else [self.link_index(name) for name in suction_links]

    def activate(self, tolerance: float = 0.0001) -> list[int]:
        """Hold every body nearer than `tolerance` [m] to a suction link; returns their numbers.

        The robot that carries the gripper is never held.
        """
        own = {self.urdf, -1 if self._coupled_robot is None else self._coupled_robot.urdf}
        cups = self._suction_links_ids
        touched = [
            point[2]
            for point in p.getContactPoints(self.urdf) or ()
            if point[2] not in own and point[8] <= tolerance and (cups is None or point[3] in cups)
        ]
        bodies = list(dict.fromkeys(touched))
        self.suction_constraints += [self._held(body) for body in bodies]
        return bodies

    def deactivate(self) -> None:
        """Let go of everything."""
        while self.suction_constraints:
            p.removeConstraint(self.suction_constraints.pop())

    def _held(self, body: int) -> int:
        seen = p.invertTransform(*self.get_tool_pose())
        position, orientation = p.multiplyTransforms(*seen, *p.getBasePositionAndOrientation(body))
        constraint: int = p.createConstraint(
            self.urdf,
            self._tcp_id,
            body,
            -1,
            p.JOINT_FIXED,
            [0, 0, 0],
            parentFramePosition=position,
            childFramePosition=[0, 0, 0],
            parentFrameOrientation=orientation,
            childFrameOrientation=None,
        )
        return constraint
