"""Particles: what an extruder puts down and a mill takes away."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pybullet as p

from gcodesim.arithmetic.elementary import cos, sin
from gcodesim.arithmetic.matrices import applied
from gcodesim.frames import Array
from gcodesim.pybullet_industrial.bodies import with_changes
from gcodesim.pybullet_industrial.turns import matrix_of

_SPOTS = 3  # points of the line that a drop of paint is drawn as
_LINE_WIDTH = 500  # of a drop of paint, by its size


class Particle:
    """One piece of a material. `ray_cast_result` are pybullet's five values of the ray that put it there.

    A class of one's own fills `properties`, and has `get_position` and `remove`.
    """

    def __init__(self, ray_cast_result: Sequence[Any], material_properties: Mapping[str, Any]) -> None:
        self.properties: dict[str, Any] = {}

    def get_position(self) -> Any:
        """Where the particle is in the world (3,) [m]."""

    def remove(self) -> None:
        """Take the particle out of the client; nothing else does, not even forgetting the object."""

    def set_material_properties(self, new_properties: Mapping[str, Any]) -> None:
        """Change some of the properties; KeyError for a name that is none of them."""
        with_changes(self.properties, new_properties)


class _Coloured(Particle):
    """With `particle size` (0.3) [m] and `color` (red)."""

    def __init__(self, ray_cast_result: Sequence[Any], material_properties: Mapping[str, Any]) -> None:
        super().__init__(ray_cast_result, material_properties)
        self.properties |= {"particle size": 0.3, "color": [1, 0, 0, 1]}
        self.set_material_properties(material_properties)


class _Solid(_Coloured):
    """A body that stays where it was put."""

    def __init__(self, ray_cast_result: Sequence[Any], material_properties: Mapping[str, Any]) -> None:
        super().__init__(ray_cast_result, material_properties)
        shape = self._shape(self.properties["particle size"])
        self.particle_id: int = p.createMultiBody(
            baseMass=0,
            baseCollisionShapeIndex=p.createCollisionShape(**shape),
            baseVisualShapeIndex=p.createVisualShape(**shape, rgbaColor=self.properties["color"]),
            basePosition=ray_cast_result[3],
        )

    def _shape(self, size: float) -> dict[str, Any]:
        raise NotImplementedError

    def get_position(self) -> Any:
        """Where the middle is in the world (3,) [m]."""
        return p.getBasePositionAndOrientation(self.particle_id)[0]

    def remove(self) -> None:
        """Take the body out of the client."""
        p.removeBody(self.particle_id)


class Plastic(_Solid):
    """A ball; `particle size` is its radius."""

    def _shape(self, size: float) -> dict[str, Any]:
        return {"shapeType": p.GEOM_SPHERE, "radius": size}


class MetalVoxel(_Solid):
    """A cube; `particle size` is its edge."""

    def _shape(self, size: float) -> dict[str, Any]:
        return {"shapeType": p.GEOM_BOX, "halfExtents": [0.5 * size] * 3}


class Paint(_Coloured):
    """A drop that is drawn on the body that the ray met, and moves with it; it weighs nothing and is never hit."""

    def __init__(self, ray_cast_result: Sequence[Any], material_properties: Mapping[str, Any]) -> None:
        super().__init__(ray_cast_result, material_properties)
        self.target_id, self.target_link_id = ray_cast_result[0], ray_cast_result[1]
        self.particle_ids: list[int] = []
        self._at: Array = np.array(ray_cast_result[3], dtype=float)
        if self.target_id == -1:
            return
        position, orientation = self.get_target_pose(self.target_id, self.target_link_id)
        self._at = applied(matrix_of(orientation).T.copy(), self._at - position)
        self._draw(self.properties["particle size"])

    def _draw(self, size: float) -> None:
        tilt, around = np.linspace(-np.pi, 0.0, _SPOTS), np.linspace(0.0, 10.0 * np.pi, _SPOTS)
        sphere = np.stack([sin(tilt) * cos(around), sin(tilt) * sin(around), cos(tilt)], axis=1)
        points = self._at + size * sphere
        for before, after in pairwise(points):
            line = p.addUserDebugLine(
                after,
                before,
                lineColorRGB=self.properties["color"][:3],
                lineWidth=size * _LINE_WIDTH,
                lifeTime=0,
                parentObjectUniqueId=self.target_id,
                parentLinkIndex=self.target_link_id,
            )
            self.particle_ids.append(line)

    @staticmethod
    def get_target_pose(target_id: int, target_link_id: int) -> tuple[Array, Array]:
        """Position (3,) and orientation x y z w of a link in the world; link -1 is the base."""
        if target_link_id == -1:
            position, orientation = p.getBasePositionAndOrientation(target_id)
        else:
            position, orientation = p.getLinkState(target_id, target_link_id)[:2]
        return np.array(position), np.array(orientation)

    def get_position(self) -> Array:
        """Where the drop is in the world (3,) [m], with the body as it stands now."""
        if self.target_id == -1:
            return self._at
        position, orientation = self.get_target_pose(self.target_id, self.target_link_id)
        moved: Array = position + applied(matrix_of(orientation), self._at)
        return moved

    def remove(self) -> None:
        """Wipe the drop away."""
        for line in self.particle_ids:
            p.removeUserDebugItem(line)


def spawn_material_block(
    base_position: Sequence[float],
    dimensions: Sequence[float],
    material: Callable[[Sequence[Any], Mapping[str, Any]], Particle],
    material_properties: Mapping[str, Any],
) -> list[Particle]:
    """A block of particles of the size in `material_properties`, from its lowest corner on; Z runs fastest.

    `dimensions` (3,) [m] are filled as far as whole particles fit. KeyError without `particle size`.
    """
    if "particle size" not in material_properties:
        raise KeyError("`material_properties` has to have a `particle size`")
    size = material_properties["particle size"]
    counts = [int(length / size) for length in dimensions]
    low = np.asarray(base_position, dtype=float) + 0.5 * size
    return [
        material([0, 0, 0, (low + size * np.array(at)).tolist()], material_properties) for at in np.ndindex(*counts)
    ]
