"""A mill of rays: every tooth is a fan of them, whatever they meet is removed and pushes back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.arithmetic.elementary import cos, power, sin
from gcodesim.arithmetic.matrices import applied, dot, norm
from gcodesim.frames import Array
from gcodesim.pybullet_industrial.bodies import with_changes
from gcodesim.pybullet_industrial.endeffector_tool import EndeffectorTool
from gcodesim.pybullet_industrial.raycaster import bodies_of
from gcodesim.pybullet_industrial.robot_base import RobotBase
from gcodesim.pybullet_industrial.turns import matrix_of


class MillingTool(EndeffectorTool):
    """A mill whose teeth stand at `current_angle` [rad] and on, evenly.

    Properties: `diameter` (0.05) [m], which is the length of the rays, `height` (0.1) [m], `number of rays` (10) of a
    tooth, `number of teeth` (5), `rotation speed` (1) [rad a call], `material_specific_force` (2500) and
    `chip_thickness_exponent` (0.26), both in the units of the script.
    """

    def __init__(
        self,
        urdf_model: str,
        start_position: Any,
        start_orientation: Any,
        milling_properties: Mapping[str, Any] | None,
        coupled_robot: RobotBase | None = None,
        tcp_frame: str | None = None,
        connector_frame: str | None = None,
    ) -> None:
        super().__init__(urdf_model, start_position, start_orientation, coupled_robot, tcp_frame, connector_frame)
        self.properties: dict[str, Any] = {
            "diameter": 0.05,
            "rotation speed": 1,
            "number of teeth": 5,
            "height": 0.1,
            "number of rays": 10,
            "material_specific_force": 2500,
            "chip_thickness_exponent": 0.26,
        }
        self.current_angle = 0.0
        self.change_properties(milling_properties or {})

    def get_cutting_state(self, ray_cast_result: Sequence[Any], tcp_frame: str | None = None) -> tuple[float, Array]:
        """Speed [of the angular velocity of the link, rad/s] and the depth (teeth,) [m] to which each tooth is in."""
        link = self._tcp_id if tcp_frame is None else self._convert_link_to_id(tcp_frame)
        velocity = p.getLinkState(self.urdf, link, computeLinkVelocity=1)[7]
        rays = self.properties["number of rays"]
        hits = np.array([ray[0] != -1 for ray in ray_cast_result]).reshape(self.properties["number of teeth"], rays)
        return norm(np.array(velocity)), hits.sum(axis=1) * self.properties["height"] / rays

    def cast_rays(self, position: Any, orientation: Any, debug: bool = False) -> Any:
        """What the rays of all teeth meet, tooth by tooth from its lower end; with `debug` they are drawn for 1 s."""
        R, rays = matrix_of(orientation), self.properties["number of rays"]
        heights = np.arange(rays)[:, None] * (self.properties["height"] / rays) * np.array([0.0, 0.0, 1.0])
        starts, ends = [], []
        for angle in self._teeth().tolist():
            out = self.properties["diameter"] * np.array([sin(angle), cos(angle), 0.0])
            starts += list(np.asarray(position) + applied(R, heights))
            ends += list(np.asarray(position) + applied(R, heights + out))
        for start, end in zip(starts, ends, strict=True) if debug else ():
            p.addUserDebugLine(start, end, [1, 0, 0], 1, lifeTime=1)
        return p.rayTestBatch(starts, ends)

    def calculate_process_force(self, ray_cast_results: Sequence[Any], tcp_frame: str | None = None) -> Array:
        """The force (3,) on the working point, in its own axes."""
        speed, depth = self.get_cutting_state(ray_cast_results, tcp_frame)
        return self.force_model(speed, depth, self._teeth())

    def mill(self, tcp_frame: str | None = None, debug: bool = False) -> list[int]:
        """Push back, remove each body that a tooth meets, and turn on; returns the bodies, each once."""
        rays = self.cast_rays(*self.get_tool_pose(tcp_frame), debug)
        self.apply_tcp_force(self.calculate_process_force(rays, tcp_frame), world_coordinates=False)
        self.current_angle += self.properties["rotation speed"]
        bodies = bodies_of([ray for ray in rays if ray[0] != -1])
        for body in bodies:
            p.removeBody(body)
        return bodies

    def force_model(self, cutting_speed: float, cutting_depth: Sequence[float] | Array, teeth_angles: Any) -> Array:
        """The force (3,) on all teeth (Kienzle 1952): none where nothing is cut or the tool does not move."""
        chip = cutting_speed / (self.properties["rotation speed"] * self.properties["number of teeth"])
        depth = np.asarray(cutting_depth, dtype=float)
        if chip <= 0.0 or not depth.any():
            return np.zeros(3)
        size = self.properties["material_specific_force"] * power(
            chip, 1.0 - self.properties["chip_thickness_exponent"]
        )
        angles = np.asarray(teeth_angles, dtype=float)
        force: Array = -size * np.array([dot(depth, sin(angles)), dot(depth, cos(angles)), 0.0])
        return force

    def change_properties(self, new_properties: Mapping[str, Any]) -> None:
        """Change some of the properties; KeyError for a name that is none of them."""
        with_changes(self.properties, new_properties)

    def _teeth(self) -> Array:
        count = self.properties["number of teeth"]
        angles: Array = self.current_angle + np.arange(count) * (2.0 * np.pi / count)
        return angles
