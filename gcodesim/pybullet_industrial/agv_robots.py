"""Vehicles on the floor of the client, steered to a pose by a controller."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
import pybullet as p

from gcodesim.arithmetic.elementary import atan2
from gcodesim.frames import Array
from gcodesim.pybullet_industrial.bodies import UrdfBody

Controller = Callable[[float, float, float], Sequence[float]]
"""Distance [m], angle to the target and error of the final angle [rad] in; speed [m/s] and turning [rad/s] out."""

_PULL: Final = 1.0  # [1/s] of the distance
_STEER: Final = 0.8  # [1/s] of the angle to the target
_ALIGN: Final = 0.4  # [1/s] of the error of the final angle
_NEAR: Final = 0.05  # [m]
_ALIGNED: Final = 0.01  # [rad]


class AGVRobot(UrdfBody):
    """A vehicle from the file `urdf_model`; classes below say how it is driven.

    `position_controller` is used in place of the vehicle's own.
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        position_controller: Controller | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, fixed=False)
        self.position_controller: Controller = position_controller or self.standard_position_controller
        self.target_pose: Array = np.zeros(3)

    def standard_position_controller(self, distance: float, angle: float, target_angle_error: float) -> Sequence[float]:
        """The vehicle's own controller; NotImplementedError where a class has none."""
        raise NotImplementedError(f"{type(self).__name__} has no `standard_position_controller`; give a controller")

    def set_velocity(self, velocity_vector: Sequence[float]) -> None:
        """Drive with a speed [m/s] and turn with a rate [rad/s]; NotImplementedError where a class has no drive."""
        raise NotImplementedError(f"{type(self).__name__} has no `set_velocity`")

    def update_position_loop(self) -> None:
        """One turn of the control loop; to be called before each step."""
        self.set_velocity(self.position_controller(*self._calculate_position_error()))

    def set_target_pose(self, target_position: Any, target_orientation: Any) -> None:
        """Where to go: X and Y [m] of a position, the turn about Z of an orientation x y z w."""
        yaw = p.getEulerFromQuaternion(target_orientation)[2]
        self.target_pose = np.append(np.asarray(target_position, dtype=float)[:2], yaw)

    def set_world_state(self, start_position: Any, start_orientation: Any) -> None:
        """Put the vehicle to a position (3,) [m] and orientation x y z w at once."""
        p.resetBasePositionAndOrientation(self.urdf, start_position, start_orientation)

    def get_world_state(self) -> Any:
        """Position and orientation of the vehicle."""
        return p.getBasePositionAndOrientation(self.urdf)

    def _calculate_position_error(self) -> tuple[float, float, float]:
        """Distance [m] to the target, angle [rad] to it from ahead, and how far the vehicle is turned past its aim."""
        position, orientation = self.get_world_state()
        heading = p.getEulerFromQuaternion(orientation)[2]
        x, y = self.target_pose[:2] - np.array(position[:2])
        return (
            math.hypot(x, y),
            _half_turn(atan2(float(y), float(x)) - heading),
            _half_turn(heading - float(self.target_pose[2])),
        )


class DiffDriveAGV(AGVRobot):
    """Two driven wheels.

    `diff_drive_params`: `wheel_radius`, `track_width` [m], `max_linear_velocity` [m/s], `max_angular_velocity` [rad/s].
    ValueError when the model has no joint of a wheel's name, KeyError when a parameter is missing.
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        left_wheel_name: str,
        right_wheel_name: str,
        diff_drive_params: Mapping[str, float],
        position_controller: Controller | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, position_controller)
        missing = [name for name in (left_wheel_name, right_wheel_name) if name not in self._joint_name_to_index]
        if missing:
            raise ValueError(f"there is no joint `{missing[0]}`; there are {', '.join(self._joint_name_to_index)}")
        self.left_wheel_index = self._joint_name_to_index[left_wheel_name]
        self.right_wheel_index = self._joint_name_to_index[right_wheel_name]
        self.wheel_radius, self.track_width = diff_drive_params["wheel_radius"], diff_drive_params["track_width"]
        self.max_linear_velocity = diff_drive_params["max_linear_velocity"]
        self.max_angular_velocity = diff_drive_params["max_angular_velocity"]
        for index in (self.left_wheel_index, self.right_wheel_index):
            p.setJointMotorControl2(self.urdf, index, p.VELOCITY_CONTROL)

    def set_velocity(self, velocity_vector: Sequence[float]) -> None:
        """Drive with a speed [m/s] and turn with a rate [rad/s], as far as both are allowed."""
        within = [self._within(velocity_vector[0], "linear"), self._within(velocity_vector[1], "angular")]
        wheels = (self.left_wheel_index, self.right_wheel_index)
        for index, rate in zip(wheels, self._calculate_wheel_comands(within), strict=True):
            p.setJointMotorControl2(self.urdf, index, p.VELOCITY_CONTROL, targetVelocity=rate)

    def standard_position_controller(self, distance: float, angle: float, target_angle_error: float) -> list[float]:
        """Drive towards the target, slower the less it is ahead, and turn to it and to the final angle together.

        At the target, nearer than 0.05 m and 0.01 rad, both are 0.
        """
        if distance < _NEAR and abs(target_angle_error) < _ALIGNED:
            return [0.0, 0.0]
        ahead = float(np.clip(1.0 - 2.0 * abs(angle) / math.pi, -1.0, 1.0))
        turning = _STEER * angle + _ALIGN * target_angle_error
        return [self._within(_PULL * distance, "linear") * ahead, self._within(turning, "angular")]

    def _calculate_wheel_comands(self, velocity_vector: Sequence[float]) -> Array:
        """Rates (2,) [rad/s] of the left and the right wheel."""
        driving = velocity_vector[0] / self.wheel_radius
        turning = velocity_vector[1] * self.track_width / (2.0 * self.wheel_radius)
        return np.array([driving - turning, driving + turning])

    def _within(self, value: float, kind: str) -> float:
        most = getattr(self, f"max_{kind}_velocity")
        return float(np.clip(value, -most, most))


def _half_turn(angle: float) -> float:
    """The same direction between −π and π, of an angle within three half turns."""
    if angle > math.pi:
        return angle - 2.0 * math.pi
    return angle + 2.0 * math.pi if angle < -math.pi else angle
