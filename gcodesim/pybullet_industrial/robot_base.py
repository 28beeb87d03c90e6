"""A robot in the client of the script, held by its base and moved by motors in its joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.frames import Array
from gcodesim.pybullet_industrial.bodies import UrdfBody


class RobotBase(UrdfBody):
    """An arm from the file `urdf_model`, its base at a position [m] and orientation x y z w.

    `default_endeffector` names the link that poses are about; without it, it is the link whose name comes last in the
    alphabet. `max_joint_force` (joints,) [N·m, N] limits the motors. Angles are in rad, rails in m.
    """

    def __init__(
        self, urdf_model: str, start_position: Any, start_orientation: Any, default_endeffector: str | None = None
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, fixed=True)
        self.number_of_joints: int = p.getNumJoints(self.urdf)
        self._kinematic_solver_map = np.array(sorted(self._joint_name_to_index.values()), dtype=int)
        self._joint_state_shape = self.get_joint_state()
        self._default_endeffector_id = (
            self.last_link if default_endeffector is None else self._convert_endeffector(default_endeffector)
        )
        self.max_joint_force = np.full(self.number_of_joints, 1000.0)
        for index in range(self.number_of_joints):
            p.resetJointState(self.urdf, index, targetValue=0)

    # ---- joints

    def get_joint_limits(self) -> tuple[dict[str, float], dict[str, float]]:
        """Least and greatest value of each moving joint by its name; without limits they are infinite."""
        names = self._joint_name_to_index.items()
        lower = {name: float(self._lower_joint_limit[index]) for name, index in names}
        return lower, {name: float(self._upper_joint_limit[index]) for name, index in names}

    def get_moveable_joints(self) -> tuple[list[str], list[int]]:
        """Names and numbers of the joints that move, from the base on."""
        ordered = sorted(self._joint_name_to_index.items(), key=lambda item: item[1])
        return [name for name, _ in ordered], [index for _, index in ordered]

    def get_joint_state(self) -> dict[str, dict[str, Any]]:
        """Of each moving joint `position`, `velocity`, `reaction force` (6,) and `torque` of the motor."""
        found = {}
        for name, index in self._joint_name_to_index.items():
            position, velocity, reaction, torque = p.getJointState(self.urdf, index)
            found[name] = {"position": position, "velocity": velocity, "reaction force": reaction, "torque": torque}
        return found

    def get_joint_position(self) -> dict[str, float]:
        """Where each moving joint is."""
        return {
            name: p.getJointState(self.urdf, index)[0] for name, index in zip(*self.get_moveable_joints(), strict=True)
        }

    def set_joint_position(self, target: Mapping[str, float], ignore_limits: bool = False) -> None:
        """Let the motors drive joints to `target`, by names. KeyError for a name, ValueError for a limit."""
        for name, value in self._checked(target, ignore_limits):
            self._drive(self._joint_name_to_index[name], value)

    def reset_joint_position(self, target: Mapping[str, float], ignore_limits: bool = False) -> None:
        """Put joints to `target` at once, by names. KeyError for a name, ValueError for a limit."""
        for name, value in self._checked(target, ignore_limits):
            p.resetJointState(self.urdf, self._joint_name_to_index[name], targetValue=value)

    # ---- poses

    def get_endeffector_pose(self, endeffector_name: str | None = None) -> tuple[Array, Array]:
        """Position (3,) [m] and orientation x y z w of a link in the world."""
        return self.link_pose(self._endeffector(endeffector_name))

    def set_endeffector_pose(
        self, target_position: Any, target_orientation: Any = None, endeffector_name: str | None = None
    ) -> None:
        """Let the motors drive a link to a pose in the world; without orientation only its position counts."""
        joints = self._inverse(target_position, target_orientation, endeffector_name)
        for index, value in zip(self._kinematic_solver_map, joints, strict=False):
            self._drive(int(index), value)

    def reset_endeffector_pose(
        self, target_position: Any, target_orientation: Any = None, endeffector_name: str | None = None
    ) -> None:
        """Put a link to a pose in the world at once, as near as the inverse kinematics comes in one call."""
        joints = self._inverse(target_position, target_orientation, endeffector_name)
        for index, value in zip(self._kinematic_solver_map, joints, strict=False):
            p.resetJointState(self.urdf, int(index), targetValue=value)

    # ---- base

    def reset_robot(
        self, start_position: Any, start_orientation: Any, joint_values: Sequence[float] | None = None
    ) -> None:
        """Put the base to a pose and all joints, fixed ones counted too, to `joint_values`; to 0 without."""
        self.set_world_state(start_position, start_orientation)
        for index in range(self.number_of_joints):
            p.resetJointState(self.urdf, index, targetValue=0.0 if joint_values is None else joint_values[index])

    def set_world_state(self, start_position: Any, start_orientation: Any) -> None:
        """Put the base to a position (3,) [m] and orientation x y z w at once."""
        p.resetBasePositionAndOrientation(self.urdf, start_position, start_orientation)

    def get_world_state(self) -> Any:
        """Position and orientation of the base."""
        return p.getBasePositionAndOrientation(self.urdf)

    # ---- inside

    def _checked(self, target: Mapping[str, float], ignore_limits: bool) -> list[tuple[str, float]]:
        unknown = [name for name in target if name not in self._joint_name_to_index]
        if unknown:
            raise KeyError(f"the robot has no joint `{unknown[0]}`; it has {', '.join(self._joint_name_to_index)}")
        for name, value in target.items():
            index = self._joint_name_to_index[name]
            lower, upper = self._lower_joint_limit[index], self._upper_joint_limit[index]
            if not (ignore_limits or lower <= value <= upper):
                raise ValueError(f"{value} is out of the limits of joint `{name}`, which are {lower} and {upper}")
        return list(target.items())

    def _drive(self, index: int, value: float) -> None:
        p.setJointMotorControl2(
            self.urdf, index, p.POSITION_CONTROL, force=self.max_joint_force[index], targetPosition=value
        )

    def _inverse(self, position: Any, orientation: Any, name: str | None) -> Any:
        limits = {"lowerLimits": self._lower_joint_limit, "upperLimits": self._upper_joint_limit}
        if orientation is not None:
            limits["targetOrientation"] = orientation
        return p.calculateInverseKinematics(self.urdf, self._endeffector(name), position, **limits)

    def _endeffector(self, name: str | None) -> int:
        return self._default_endeffector_id if name is None else self._convert_endeffector(name)

    def _convert_endeffector(self, endeffector: str) -> int:
        return self.link_index(endeffector)
