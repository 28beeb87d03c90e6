"""A tool in the client of the script: held where it is, or by a robot."""

from __future__ import annotations

from typing import Any

import numpy as np
import pybullet as p

from gcodesim.frames import Array
from gcodesim.pybullet_industrial.bodies import UrdfBody
from gcodesim.pybullet_industrial.robot_base import RobotBase

_ORIGIN = (0.0, 0.0, 0.0)


class EndeffectorTool(UrdfBody):
    """A tool from the file `urdf_model` at a position [m] and orientation x y z w.

    `tcp_frame` names the link of its working point; without it, it is the link whose name comes last in the alphabet.
    `connector_frame` names the link by which a robot holds it, else its base.
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        coupled_robot: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frame: str | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, fixed=False)
        self._tcp_id = self._link(tcp_frame)
        self._connector_id = -1 if connector_frame is None else self._convert_link_to_id(connector_frame)
        held = self._base() if connector_frame is None else self.link_pose(self._connector_id)
        self._tcp_translation, self._tcp_rotation = p.multiplyTransforms(
            *p.invertTransform(*held), *self.link_pose(self._tcp_id)
        )
        self._coupled_robot: RobotBase | None = None
        self._coupling_link: str | None = None
        self._coupling_constraint = self._fixed_in_space(-1, start_position, start_orientation)
        if coupled_robot is not None:
            self.couple(coupled_robot)

    def couple(self, robot: RobotBase, endeffector_name: str | None = None) -> None:
        """Fasten the tool to a link of `robot`.

        ValueError when a robot holds the tool already or has no such link, TypeError when `robot` is none.
        """
        if self._coupled_robot is not None:
            raise ValueError("a robot holds this tool already; call `decouple` first")
        if not isinstance(robot, RobotBase):
            raise TypeError(f"a tool is coupled with a RobotBase, not with a {type(robot).__name__}")
        link = robot._endeffector(endeffector_name)
        self._coupled_robot, self._coupling_link = robot, endeffector_name
        p.removeConstraint(self._coupling_constraint)
        self._coupling_constraint = p.createConstraint(
            robot.urdf, link, self.urdf, self._connector_id, p.JOINT_FIXED, _ORIGIN, _ORIGIN, _ORIGIN
        )

    def is_coupled(self) -> bool:
        """Whether a robot holds the tool."""
        return self._coupled_robot is not None

    def decouple(self) -> None:
        """Let go of the robot; the tool stays in space where it is."""
        self._coupled_robot = self._coupling_link = None
        p.removeConstraint(self._coupling_constraint)
        self._coupling_constraint = self._fixed_in_space(-1, *self._base())

    def get_tool_pose(self, tcp_frame: str | None = None) -> tuple[Array, Array]:
        """Position (3,) [m] and orientation x y z w of the working point, or of another link, in the world."""
        return self.link_pose(self._tcp_id if tcp_frame is None else self._convert_link_to_id(tcp_frame))

    def set_tool_pose(self, target_position: Any, target_orientation: Any = None) -> None:
        """Bring the working point to a pose: by the motors of the robot that holds the tool, else at once.

        Without orientation, the tool keeps the one that it has.
        """
        if self._coupled_robot is None:
            orientation = self._base()[1] if target_orientation is None else target_orientation
            p.removeConstraint(self._coupling_constraint)
            self._coupling_constraint = self._fixed_in_space(self._tcp_id, target_position, orientation)
            return
        orientation = self.get_tool_pose()[1] if target_orientation is None else target_orientation
        held = p.invertTransform(self._tcp_translation, self._tcp_rotation)
        position, turned = p.multiplyTransforms(target_position, orientation, *held)
        self._coupled_robot.set_endeffector_pose(position, turned, endeffector_name=self._coupling_link)

    def apply_tcp_force(self, force: Any, world_coordinates: bool = True) -> None:
        """Push the working point in the next step with a force (3,) [N], in world axes or in those of its link."""
        if world_coordinates:
            p.applyExternalForce(self.urdf, self._tcp_id, force, self.get_tool_pose()[0], p.WORLD_FRAME)
        else:
            p.applyExternalForce(self.urdf, self._tcp_id, force, _ORIGIN, p.LINK_FRAME)

    def apply_tcp_torque(self, torque: Any) -> None:
        """Twist the working point in the next step with a torque (3,) [N·m] in axes of its link."""
        p.applyExternalTorque(self.urdf, self._tcp_id, torque, p.LINK_FRAME)

    def _link(self, name: str | None) -> int:
        return self.last_link if name is None else self._convert_link_to_id(name)

    def _convert_link_to_id(self, tcp: str) -> int:
        return self.link_index(tcp)

    def _base(self) -> tuple[Array, Array]:
        position, orientation = p.getBasePositionAndOrientation(self.urdf)
        return np.array(position), np.array(orientation)

    def _fixed_in_space(self, link: int, position: Any, orientation: Any) -> int:
        constraint: int = p.createConstraint(
            self.urdf, link, -1, -1, p.JOINT_FIXED, _ORIGIN, _ORIGIN, position, None, orientation
        )
        return constraint
