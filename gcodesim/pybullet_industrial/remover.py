"""A tool that takes away what its rays meet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pybullet as p

from gcodesim.pybullet_industrial.raycaster import RayCaster, bodies_of
from gcodesim.pybullet_industrial.robot_base import RobotBase


class Remover(RayCaster):
    """Removes whole bodies, whatever they are."""

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        remover_properties: Mapping[str, Any],
        coupled_robot: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frame: str | None = None,
    ) -> None:
        super().__init__(
            urdf_model, start_position, start_orientation, remover_properties, coupled_robot, tcp_frame, connector_frame
        )

    def remove(self, tcp_frame: str | None = None) -> list[int]:
        """Remove each body that a ray meets; returns their numbers, each once."""
        bodies = bodies_of(self._act(tcp_frame))
        for body in bodies:
            p.removeBody(body)
        return bodies
