"""A tool that puts particles where its rays meet something."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gcodesim.pybullet_industrial.material import Particle, Plastic
from gcodesim.pybullet_industrial.raycaster import RayCaster
from gcodesim.pybullet_industrial.robot_base import RobotBase


class Extruder(RayCaster):
    """Puts down one particle a ray.

    Properties besides those of `RayCaster`: `material` (`Plastic`), a class below `Particle`, and `material properties`
    (`particle size` 0.03 m, `color` red), which are handed to it.
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        extruder_properties: Mapping[str, Any],
        coupled_robot: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frame: str | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, None, coupled_robot, tcp_frame, connector_frame)
        self.properties["material"] = Plastic
        self.properties["material properties"] = {"particle size": 0.03, "color": [1, 0, 0, 1]}
        self.change_properties(extruder_properties)

    def extrude(self, tcp_frame: str | None = None) -> list[Particle]:
        """One particle for each ray that meets something."""
        make, how = self.properties["material"], self.properties["material properties"]
        return [make(ray, how) for ray in self._act(tcp_frame)]
