"""Sensors that a robot carries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pybullet as p
from numpy.typing import NDArray

from gcodesim.pybullet_industrial.bodies import with_changes
from gcodesim.pybullet_industrial.endeffector_tool import EndeffectorTool
from gcodesim.pybullet_industrial.robot_base import RobotBase
from gcodesim.pybullet_industrial.turns import matrix_of

_AHEAD = 0.1  # [m] from the lens to the point that it looks at


class Camera(EndeffectorTool):
    """Looks along Z of its frame, with Y up.

    Parameters: `width` (480) and `height` (240) [pixels], `fov` (60) [°] of the height, `aspect ratio` (1), `near plane
    distance` (0.01) and `far plane distance` (100) [m].
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        camera_parameters: Mapping[str, Any],
        coupled_robot: RobotBase | None = None,
        camera_frame: str | None = None,
        connector_frame: str | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, coupled_robot, camera_frame, connector_frame)
        self.camera_parameters: dict[str, Any] = {
            "width": 480,
            "height": 240,
            "fov": 60,
            "aspect ratio": 1,
            "near plane distance": 0.01,
            "far plane distance": 100,
        }
        self.set_camera_parameters(camera_parameters)

    def set_camera_parameters(self, camera_parameters: Mapping[str, Any]) -> None:
        """Change some of the parameters; KeyError for a name that is none of them."""
        with_changes(self.camera_parameters, camera_parameters)
        lens = ("fov", "aspect ratio", "near plane distance", "far plane distance")
        self.projection_matrix = p.computeProjectionMatrixFOV(*(self.camera_parameters[name] for name in lens))

    def get_image(self) -> NDArray[Any]:
        """What the camera sees: (height, width, 4), red, green, blue and opacity from 0 to 255."""
        state = p.getLinkState(self.urdf, self._tcp_id, computeForwardKinematics=True)
        R, at = matrix_of(state[1]), np.array(state[0])
        view = p.computeViewMatrix(at, at + _AHEAD * R[:, 2], R[:, 1])
        width, height = self.camera_parameters["width"], self.camera_parameters["height"]
        pixels = p.getCameraImage(width, height, view, self.projection_matrix)[2]
        return np.reshape(pixels, (height, width, 4))
