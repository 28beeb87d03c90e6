"""A tool that looks along rays: the common part of `Extruder` and `Remover`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import applied
from gcodesim.frames import Array
from gcodesim.pybullet_industrial.bodies import with_changes
from gcodesim.pybullet_industrial.endeffector_tool import EndeffectorTool
from gcodesim.pybullet_industrial.robot_base import RobotBase
from gcodesim.pybullet_industrial.turns import matrix_of


class RayCaster(EndeffectorTool):
    """Casts rays against −Z of the working point.

    Properties: `opening angle` of their cone (0) [rad], `number of rays` (1), `maximum distance` (1) [m].
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        raycast_properties: Mapping[str, Any] | None,
        coupled_robot: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frame: str | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, coupled_robot, tcp_frame, connector_frame)
        self.properties: dict[str, Any] = {"opening angle": 0, "number of rays": 1, "maximum distance": 1}
        self.change_properties(raycast_properties or {})

    def change_properties(self, new_properties: Mapping[str, Any]) -> None:
        """Change some of the properties; KeyError for a name that is none of them."""
        with_changes(self.properties, new_properties)

    def cast_rays(self, position: Any, orientation: Any) -> Any:
        """What rays from `position` hit: for each one pybullet's five values, the first -1 where nothing is hit.

        Directions come from numpy's common generator, around first, then the tilt; `numpy.random.seed` repeats them.
        """
        count, half = self.properties["number of rays"], 0.5 * self.properties["opening angle"]
        around = np.random.uniform(-np.pi, np.pi, count)
        tilt = np.random.uniform(-half, half, count)
        directions = np.stack([sin(tilt) * cos(around), sin(tilt) * sin(around), cos(tilt)], axis=1)
        start = np.asarray(position, dtype=float)
        ends = start - self.properties["maximum distance"] * applied(matrix_of(orientation), directions)
        return p.rayTestBatch([start] * count, list(ends))

    def calculate_process_force(self, ray_cast_results: Any, tcp_frame: str | None = None) -> Array:
        """The force (3,) [N] on the working point in its own axes: none, unless a class below says otherwise."""
        return np.zeros(3)

    def _act(self, tcp_frame: str | None) -> list[Any]:
        """Cast rays, push back, and return the rays that hit something."""
        rays = self.cast_rays(*self.get_tool_pose(tcp_frame))
        self.apply_tcp_force(self.calculate_process_force(rays, tcp_frame), world_coordinates=False)
        return [ray for ray in rays if ray[0] != -1]


def bodies_of(rays: list[Any]) -> list[int]:
    """Each body that was hit once, in the order of the rays."""
    return list(dict.fromkeys(ray[0] for ray in rays))
